// Clouds deeper than numbers of 16 bits reach: a float16 volume holds the largest one there, on
// every backend, so that whoever looks between two voxels finds a number, and it is dark behind.

#include "support/cloud_sums.hpp"
#include "support/devices.hpp"

#include <skybark/clouds/light_at_points.hpp>

namespace {

using namespace skybark;
using namespace skybark::clouds;
using namespace skybark::support;

constexpr glm::uvec3 voxels(24);
constexpr glm::vec3 slanting{0.4f, 0.7f, -0.3f};
constexpr double largest_half = 65504; ///< IEEE 754: (2 − 2^-10) 2^15
constexpr double most_depth = 500'000;
const phase_function even = phase_function::isotropic();

/// One particle that is far deeper, and others that are not.
std::vector<cloud_particle> deep_cloud() {
    std::vector<cloud_particle> particles = ball(30, 0.2f, 0.4f, 2.0f, 3);
    particles.push_back({glm::vec3(0.1f, 0, 0), 0.9f, float(most_depth), 1, {0, 0}});
    return particles;
}

/// A grid of one density, as deep.
density_box deep_box() {
    density_box where;
    where.low = glm::vec3(-1);
    where.high = glm::vec3(1);
    where.extinction = float(most_depth);
    return where;
}

struct found_light {
    std::vector<double> attenuation;
    std::vector<std::uint16_t> halves; ///< where the volume has them
    std::vector<float> fluence;
    std::vector<glm::vec4> at_places; ///< middle, 2 m behind it, 2 m before it
};

/// Relights by `relight(volume, recorder)`, scatters, and looks at what came of it.
template <class B, class Relight>
found_light light_of_deep(B& device, attenuation_options options, volume_format format, bool grids,
                          const Relight& relight) {
    options.format = format;
    auto sun = attenuation_volume<B>::create(device, voxels, options).value();
    if (grids) {
        EXPECT_TRUE(sun.prepare_for_grids(device));
    }
    auto diffuse = multiple_scattering<B>::create(device, voxels, {medium_of(even, 0.99f)}).value();
    const glm::vec3 aside = 2.0f * glm::normalize(slanting);
    std::vector<glm::vec4> places{glm::vec4(0), glm::vec4(-aside, 0), glm::vec4(aside, 0)};
    const auto at = make_buffer<B, glm::vec4>(device, places).value();
    const auto looked = device.create_buffer(places.size() * sizeof(glm::vec4)).value();
    EXPECT_TRUE(run(device, [&](auto& to) {
        relight(sun, to);
        diffuse.solve(to, sun);
        EXPECT_TRUE(
            record_light_at(to, device.limits(), sun, &diffuse, view<B>(at), 3, view<B>(looked)));
    }));
    found_light found;
    const std::size_t count = std::size_t{voxels.x} * voxels.y * voxels.z;
    if (format == volume_format::float16) {
        found.halves.resize(count);
        EXPECT_TRUE(device.download(sun.volume(), std::as_writable_bytes(std::span(found.halves))));
    } else {
        std::vector<float> whole(count);
        EXPECT_TRUE(device.download(sun.volume(), std::as_writable_bytes(std::span(whole))));
        found.attenuation.assign(whole.begin(), whole.end());
    }
    const volume_description what = diffuse.fluence().description();
    found.fluence.resize(what.size_bytes() / sizeof(float));
    EXPECT_TRUE(
        device.download(diffuse.fluence(), std::as_writable_bytes(std::span(found.fluence))));
    found.at_places = places;
    EXPECT_TRUE((read_back<B, glm::vec4>(device, looked, std::span(found.at_places))));
    return found;
}

/// What a half stands for, by its definition; those here are positive.
double half_value(std::uint16_t bits) {
    const int exponent = bits >> 10;
    const double mantissa = bits & 0x3ff;
    return exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(mantissa + 1024, exponent - 25);
}

/// Halves are the floats' nearest, and of those beyond their reach the largest.
void expect_held(const found_light& held, const found_light& whole) {
    std::size_t beyond = 0;
    for (std::size_t i = 0; i < whole.attenuation.size(); ++i) {
        const double exact = whole.attenuation[i];
        beyond += exact > 65520 ? 1 : 0;
        ASSERT_LE(held.halves[i], 0x7bff) << i; // finite, and not below 0
        // Half a unit in the last place of 11 bits, or of the smallest that there are.
        ASSERT_NEAR(half_value(held.halves[i]), std::min(exact, largest_half),
                    std::max(exact * 0x1p-11, 0x1p-25))
            << i;
    }
    EXPECT_GT(beyond, 100u);
    EXPECT_LT(beyond, whole.attenuation.size() / 2);
}

/// Numbers everywhere: light before the cloud, nothing in it and behind.
void expect_lit(const found_light& found) {
    for (const float fluence : found.fluence) {
        ASSERT_TRUE(fluence >= 0 && std::isfinite(fluence)) << fluence;
    }
    for (const glm::vec4& place : found.at_places) {
        EXPECT_TRUE(std::isfinite(place.x) && place.y >= 0 && place.z >= 0) << place.y;
    }
    EXPECT_NEAR(found.at_places[0].x, largest_half, 64); // weights' rounding, times eight of them
    EXPECT_LT(found.at_places[0].y, 1e-3f);
    EXPECT_EQ(found.at_places[1].y, found.at_places[1].z); // nothing of the beam
    EXPECT_GT(found.at_places[2].y, 1.0f);
}

/// What the cpu holds, and so the same light. Sums of numbers as large as these may differ in a
/// float's last bit, where a compiler rounds an exponential otherwise, and then in a half's.
void expect_same(const found_light& found, const found_light& on_cpu) {
    for (std::size_t i = 0; i < on_cpu.halves.size(); ++i) {
        ASSERT_LE(std::abs(found.halves[i] - on_cpu.halves[i]), 1) << i;
    }
    for (std::size_t i = 0; i < on_cpu.fluence.size(); ++i) {
        ASSERT_NEAR(found.fluence[i], on_cpu.fluence[i], 1e-3f * (1 + on_cpu.fluence[i])) << i;
    }
}

template <class B>
found_light of_particles(B& device, const attenuation_options& options, volume_format format) {
    const auto cloud = deep_cloud();
    const auto box = fit_light_box(cloud, slanting, voxels).value();
    const auto sent = make_buffer<B, cloud_particle>(device, std::span(cloud)).value();
    return light_of_deep(device, options, format, false, [&](auto& sun, auto& to) {
        sun.relight(to, view<B>(sent), static_cast<std::uint32_t>(cloud.size()), box);
    });
}

template <class B>
found_light of_grid(B& device, volume_format format) {
    const std::vector<float> density(8 * 8 * 8, 1.0f);
    const auto water = device.create_volume({8, 8, 8, volume_format::float32}).value();
    EXPECT_TRUE(device.upload(water, std::as_bytes(std::span(density))));
    const auto box = fit_light_box(deep_box(), slanting, voxels).value();
    return light_of_deep(device, light_of(even), format, true,
                         [&](auto& sun, auto& to) { sun.relight(to, water, deep_box(), box); });
}

class deep_halves : public testing::TestWithParam<const char*> {};

TEST_P(deep_halves, hold_the_largest_of_particles) {
    with_device(GetParam(), [](auto& device) {
        for (const auto method :
             {attenuation_method::impulse_scan, attenuation_method::shadow_polygons}) {
            attenuation_options how = light_of(even);
            how.method = method;
            const auto held = of_particles(device, how, volume_format::float16);
            expect_held(held, of_particles(device, how, volume_format::float32));
            expect_lit(held);
            cpu::device host;
            expect_same(held, of_particles(host, how, volume_format::float16));
        }
    });
}

TEST_P(deep_halves, hold_the_largest_of_a_grid) {
    with_device(GetParam(), [](auto& device) {
        const auto held = of_grid(device, volume_format::float16);
        expect_held(held, of_grid(device, volume_format::float32));
        expect_lit(held);
        cpu::device host;
        expect_same(held, of_grid(host, volume_format::float16));
    });
}

INSTANTIATE_TEST_SUITE_P(on, deep_halves, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& which) { return std::string(which.param); });

} // namespace
