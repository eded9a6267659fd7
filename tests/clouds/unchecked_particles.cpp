// Particles that only the device knows, and that no cloud has: they add nothing to any light, and
// nothing overflows (the address and undefined-behaviour sanitizers run this as well).

#include "support/cloud_sums.hpp"
#include "support/devices.hpp"

#include <skybark/clouds/cloud_billboards.hpp>
#include <skybark/clouds/harris.hpp>
#include <skybark/clouds/torn_billboards.hpp>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>

#include <cmath>
#include <limits>

namespace {

using namespace skybark;
using namespace skybark::clouds;
using namespace skybark::support;

constexpr glm::uvec3 voxels(24);
constexpr glm::vec3 slanting{0.4f, 0.7f, -0.3f};
constexpr std::uint32_t side = 32; ///< pixels

std::vector<cloud_particle> good_ones() { return ball(40, 0.1f, 0.3f, 0.5f, 11); }

/// Each with a position or a radius that is no number, or beyond any box.
std::vector<cloud_particle> senseless_ones() {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float inf = std::numeric_limits<float>::infinity();
    std::vector<cloud_particle> found;
    for (const float number : {nan, inf, -inf, 3e38f, -3e38f, 1e15f, -1e15f, 1e9f}) {
        for (int member = 0; member < 4; ++member) {
            cloud_particle p;
            p.radius = 0.2f;
            p.optical_depth = 1;
            if (member < 3) {
                p.position[member] = number;
            } else {
                p.radius = number;
            }
            found.push_back(p);
        }
    }
    return found;
}

std::vector<cloud_particle> all_of_them() {
    std::vector<cloud_particle> all = senseless_ones();
    const auto good = good_ones();
    all.insert(all.begin() + 10, good.begin(), good.end());
    return all;
}

std::vector<attenuation_options> ways() {
    std::vector<attenuation_options> found;
    for (const auto profile : {attenuation_profile::step, attenuation_profile::erf}) {
        found.push_back(with(attenuation_method::impulse_scan, profile));
        found.push_back(with(attenuation_method::shadow_polygons, profile));
        found.back().policy = padding::degenerate;
        found.push_back(with(attenuation_method::shadow_polygons, profile));
        found.back().policy = padding::compact;
        found.push_back(with(attenuation_method::shadow_polygons, profile));
        found.back().polygons = polygon_source::stage;
    }
    return found;
}

template <class B>
std::vector<float> lit(B& device, const std::vector<cloud_particle>& particles,
                       const light_box& box, const attenuation_options& way) {
    std::vector<float> values(std::size_t{voxels.x} * voxels.y * voxels.z);
    const auto buffer = make_buffer<B, cloud_particle>(device, std::span(particles));
    auto volume = attenuation_volume<B>::create(device, voxels, way);
    EXPECT_TRUE(buffer && volume);
    EXPECT_TRUE(run(device, [&](auto& to) {
        volume->relight(to, view<B>(*buffer), static_cast<std::uint32_t>(particles.size()), box);
    }));
    EXPECT_TRUE(device.download(volume->volume(), std::as_writable_bytes(std::span(values))));
    return values;
}

class unchecked_particles : public testing::TestWithParam<const char*> {};

TEST_P(unchecked_particles, add_nothing_to_the_volume) {
    with_device(GetParam(), [](auto& device) {
        for (const glm::vec3 to_sun : {slanting, glm::vec3(0, 1, 0)}) {
            const auto box = fit_light_box(good_ones(), to_sun, voxels).value();
            for (const attenuation_options& way : ways()) {
                const auto expected = lit(device, good_ones(), box, way);
                EXPECT_GT(*std::max_element(expected.begin(), expected.end()), 1.0f);
                EXPECT_EQ(lit(device, all_of_them(), box, way), expected);
            }
        }
    });
}

/// What Harris's pass finds at each particle.
template <class B>
std::vector<float> by_harris(B& device, const std::vector<cloud_particle>& particles) {
    const auto box = fit_light_box(good_ones(), slanting, voxels).value();
    const auto count = static_cast<std::uint32_t>(particles.size());
    auto harris = harris_light<B>::create(device, voxels.x, voxels.z, count, {3.0f, 0.05f}).value();
    const auto sent = make_buffer<B, cloud_particle>(device, std::span(particles)).value();
    EXPECT_TRUE(harris.relight(view<B>(sent), count, box));
    return {harris.lights().begin(), harris.lights().end()};
}

TEST_P(unchecked_particles, take_no_light_from_others_in_harris_pass) {
    with_device(GetParam(), [](auto& device) {
        const auto expected = by_harris(device, good_ones());
        const auto found = by_harris(device, all_of_them());
        for (std::size_t i = 0; i < expected.size(); ++i) {
            EXPECT_EQ(found[i + 10], expected[i]) << i;
        }
        for (const float light : found) {
            EXPECT_TRUE(light >= 0 && light <= 1) << light;
        }
    });
}

/// The ball from 8 m away, as both ways of drawing have it.
template <class B>
std::vector<glm::vec4> drawn(B& device, const std::vector<cloud_particle>& particles, bool torn) {
    const auto count = static_cast<std::uint32_t>(particles.size());
    const auto box = fit_light_box(good_ones(), slanting, voxels).value();
    kernels::scene_record scene{};
    const glm::vec3 eye(0, 0, 8);
    scene.to_clip = glm::perspectiveRH_ZO(0.4f, 1.0f, 0.1f, 1e3f) *
                    glm::lookAtRH(eye, glm::vec3(0), glm::vec3(0, 1, 0));
    scene.from_clip = glm::inverse(scene.to_clip);
    scene.camera = glm::vec4(eye, 0);
    scene.sky.to_sun = glm::vec4(glm::normalize(slanting), 0);
    scene.sky.sunlight = glm::vec4(4, 3, 2, 0);
    scene.sky.zenith = glm::vec4(0.1f, 0.3f, 0.3f, 0);
    auto sun = attenuation_volume<B>::create(device, voxels).value();
    const auto sent = make_buffer<B, cloud_particle>(device, std::span(particles)).value();
    const auto on_device =
        make_buffer<B, kernels::scene_record>(device, std::span(&scene, 1)).value();
    auto color = device.create_image({side, side, image_format::rgba32f}).value();
    auto by_fragment = cloud_billboards<B>::create(device, count).value();
    auto by_particle = torn_billboards<B>::create(device, count).value();
    EXPECT_TRUE(run(device, [&](auto& to) {
        sun.relight(to, view<B>(sent), count, box);
        cloud_light_sources<B> light;
        light.lighting = single_scattering({}, box, phase_function::isotropic());
        light.sun = &sun.volume();
        const draw_target<B> target{&color, nullptr, glm::vec4(0), {}};
        if (torn) {
            by_particle.record(to, {view<B>(sent), view<B>(sent), count}, eye, view<B>(on_device),
                               light, kernels::torn_puff{1, 1, 0}, target);
        } else {
            by_fragment.record(to, view<B>(sent), count, eye, view<B>(on_device), light, target);
        }
    }));
    std::vector<glm::vec4> pixels(side * side);
    EXPECT_TRUE(device.download(color, std::as_writable_bytes(std::span(pixels))));
    return pixels;
}

TEST_P(unchecked_particles, without_a_place_or_a_radius_are_not_seen) {
    with_device(GetParam(), [](auto& device) {
        for (const bool torn : {false, true}) {
            const auto expected = drawn(device, good_ones(), torn);
            auto all = all_of_them();
            // One whose radius is huge is all around the eye, and may be seen.
            std::erase_if(all, [](const cloud_particle& p) {
                return std::isfinite(p.radius) && p.radius > 1e6f;
            });
            const auto found = drawn(device, all, torn);
            float most = 0;
            for (std::size_t i = 0; i < expected.size(); ++i) {
                EXPECT_EQ(found[i], expected[i]) << (torn ? "torn " : "lit ") << i;
                most = std::max(most, expected[i].w);
            }
            EXPECT_GT(most, 0.5f);
        }
    });
}

/// The ball with the albedos of some of it changed: an albedo and what it counts as.
std::vector<cloud_particle> with_albedos(std::span<const float> albedos) {
    auto particles = good_ones();
    for (std::size_t i = 0; i < particles.size(); i += 2) {
        particles[i].albedo = albedos[i / 2 % albedos.size()];
    }
    return particles;
}

TEST_P(unchecked_particles, albedos_count_as_those_that_there_are) {
    with_device(GetParam(), [](auto& device) {
        constexpr float wrong[] = {5, -2, 1e30f, -0.1f, 1.01f, -3e38f};
        constexpr float right[] = {1, 0, 1, 0, 1, 0};
        const auto unchecked = with_albedos(wrong);
        const auto checked = with_albedos(right);
        EXPECT_EQ(by_harris(device, unchecked), by_harris(device, checked));
        EXPECT_NE(by_harris(device, good_ones()), by_harris(device, checked));
        for (const bool torn : {false, true}) {
            const auto expected = drawn(device, checked, torn);
            EXPECT_EQ(drawn(device, unchecked, torn), expected) << (torn ? "torn" : "lit");
            EXPECT_NE(drawn(device, good_ones(), torn), expected);
        }
    });
}

// One that is no number is none of them for the light, as relight has it; nothing of such a
// particle is drawn.
TEST_P(unchecked_particles, albedos_that_are_no_numbers_scatter_nothing) {
    with_device(GetParam(), [](auto& device) {
        constexpr float wrong[] = {std::numeric_limits<float>::quiet_NaN()};
        constexpr float right[] = {0};
        const auto unchecked = with_albedos(wrong);
        EXPECT_EQ(by_harris(device, unchecked), by_harris(device, with_albedos(right)));
        for (const bool torn : {false, true}) {
            for (const glm::vec4& pixel : drawn(device, unchecked, torn)) {
                const float sum = pixel.x + pixel.y + pixel.z + pixel.w;
                EXPECT_TRUE(std::isfinite(sum)) << (torn ? "torn" : "lit");
            }
        }
    });
}

INSTANTIATE_TEST_SUITE_P(on, unchecked_particles, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& which) { return std::string(which.param); });

} // namespace
