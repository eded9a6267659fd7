// The meadow's sky: how much of it is covered, that it drifts with the wind, and what a frame
// costs.
#include "support/allocations.hpp"
#include "support/devices.hpp"

#include <meadow/sky.hpp>
#include <skybark/conformance/null_backend.hpp>
#include <skybark/core/validated.hpp>

#include <cstring>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>

namespace {

using namespace skybark;
using meadow::description;
using meadow::sky_field;
using meadow::weather;

/// Small pictures and volumes; the clouds are those of the real thing.
description small() {
    description what;
    what.width = 96;
    what.height = 54;
    what.cloud_voxels = 32;
    return what;
}
/// A few coarse clouds, for what does not depend on how many there are.
meadow::sky_field_options coarse() {
    meadow::sky_field_options few;
    few.models = 4;
    few.particles_largest = 150;
    few.most_cover = 0.6f;
    return few;
}
/// The real clouds, up to a usual cover.
meadow::sky_field_options usual() {
    meadow::sky_field_options half;
    half.most_cover = 0.42f;
    return half;
}
weather covered(float cloud) {
    weather now;
    now.cloud = cloud;
    return now;
}
const sky_field& field() {
    static const sky_field made = meadow::make_sky_field({});
    return made;
}

template <class B>
std::vector<float> volume_of(B& device, const typename B::volume& volume) {
    std::vector<float> values(volume.description().size_bytes() / sizeof(float));
    EXPECT_TRUE(device.download(volume, std::as_writable_bytes(std::span(values))));
    return values;
}

TEST(sky_field, covers_what_is_asked_for) {
    // An oracle of its own: vertical lines at random through Gaussians of radius / 3, over the
    // square and across its border.
    constexpr int lines = 600;
    const float side = field().box.side;
    for (const float asked : {0.1f, 0.4f, 0.8f}) {
        const std::uint32_t count = field().count_for(asked);
        clouds::detail::cumulus_random random(99);
        double covered = 0;
        for (int i = 0; i < lines; ++i) {
            const auto x = static_cast<float>(random.between(-0.5, 0.5)) * side;
            const auto z = static_cast<float>(random.between(-0.5, 0.5)) * side;
            double depth = 0;
            for (std::uint32_t k = 0; k < count; ++k) {
                const cloud_particle& p = field().particles[k];
                float dx = std::abs(p.position.x - x);
                float dz = std::abs(p.position.z - z);
                dx = std::min(dx, std::abs(side - dx));
                dz = std::min(dz, std::abs(side - dz));
                const float d2 = dx * dx + dz * dz;
                if (d2 < p.radius * p.radius) {
                    depth += double{p.optical_depth} *
                             std::exp(-4.5 * double{d2} / double{p.radius * p.radius});
                }
            }
            covered += 1 - std::exp(-depth);
        }
        // Of 600 lines: 3 · sqrt(p (1 − p) / 600), at most 0.061.
        EXPECT_NEAR(covered / lines, double{asked}, 0.061);
        EXPECT_NEAR(double{field().cover_of(count)}, double{asked}, 0.001);
    }
}

TEST(sky_field, begins_with_a_field_of_less_cover) {
    EXPECT_EQ(field().count_for(0), 0u);
    EXPECT_EQ(field().count_for(-1), 0u);
    EXPECT_EQ(field().count_for(1), field().particles.size());
    EXPECT_EQ(field().cover_of(0), 0.0f);
    std::uint32_t last = 0;
    for (float cover = 0.02f; cover < 0.8f; cover += 0.02f) {
        const std::uint32_t count = field().count_for(cover);
        EXPECT_GT(count, last);
        last = count;
    }
    const std::uint32_t usual = field().count_for(weather{}.cloud);
    EXPECT_GT(usual, 15000u);
    EXPECT_LE(usual, 30000u);
    // Cloud after cloud, each inside of the square with its middle, and of the largest's width.
    ASSERT_EQ(field().middles.size(), field().particles.size());
    for (std::size_t i = 0; i < field().particles.size(); ++i) {
        const cloud_particle& p = field().particles[i];
        const glm::vec4& m = field().middles[i];
        ASSERT_LE(std::max(std::abs(m.x), std::abs(m.z)), 0.5f * field().box.side);
        ASSERT_LT(glm::distance(glm::vec2(p.position.x, p.position.z), glm::vec2(m.x, m.z)),
                  1.2f * 850);
        ASSERT_GE(p.position.y, 1050.0f);
    }
}

TEST(sky, without_clouds_is_clear) {
    cpu::device device;
    auto made = meadow::sky<cpu::device>::create(device, small(), covered(0), coarse());
    ASSERT_TRUE(made);
    ASSERT_TRUE(run(device, [&](auto& to) { made->record(to, covered(0.5f), 3); }));
    EXPECT_GT(made->count(), 0u);
    ASSERT_TRUE(run(device, [&](auto& to) { made->record(to, covered(0), 3); }));
    EXPECT_EQ(made->count(), 0u);
    EXPECT_EQ(made->cover(), 0.0f);
    for (const float attenuation : volume_of(device, made->sun_volume())) {
        ASSERT_EQ(attenuation, 0.0f); // transmittance e^0 = 1
    }
}

TEST(sky, leaves_the_origin_in_the_sun_at_first) {
    cpu::device device;
    for (const std::uint64_t seed : {1u, 2u}) {
        description what = small();
        what.seed = seed;
        auto made = meadow::sky<cpu::device>::create(device, what, weather{}, usual());
        ASSERT_TRUE(made);
        // The oracle: how much of the particles lies on the line to the sun.
        const double azimuth = weather{}.sun_azimuth * std::numbers::pi / 180;
        const double elevation = weather{}.sun_elevation * std::numbers::pi / 180;
        const glm::dvec3 to(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                            -std::cos(azimuth) * std::cos(elevation));
        double depth = 0;
        for (std::uint32_t i = 0; i < made->count(); ++i) {
            const cloud_particle& p = made->field().particles[i];
            const double aside = glm::length(glm::cross(glm::dvec3(p.position), to));
            if (aside < double{p.radius}) {
                depth += double{p.optical_depth} *
                         std::exp(-4.5 * aside * aside / double{p.radius * p.radius});
            }
        }
        EXPECT_LT(depth, 0.05) << "seed " << seed;
    }
}

/// The sun's light on a level plane at 0, where (x, z) is the ground: a plain trilinear look-up.
class shadow_map {
  public:
    shadow_map(std::vector<float> values, const light_grid& grid, int side)
        : values_(std::move(values)), grid_(grid), side_(side) {}

    [[nodiscard]] double light(glm::dvec2 at) const {
        const glm::dvec3 d = glm::dvec3(at.x, 0, at.y) - glm::dvec3(glm::vec3(grid_.anchor));
        const auto cell = [&d](const glm::vec4& row) {
            return glm::dot(glm::dvec3(glm::vec3(row)), d) + double{row.w} - 0.5;
        };
        const glm::dvec3 c(cell(grid_.row_x), cell(grid_.row_y), cell(grid_.row_z));
        double sum = 0;
        for (int k = 0; k < 8; ++k) {
            double weight = 1;
            std::size_t index = 0;
            std::size_t step = 1;
            for (int a = 0; a < 3; ++a) {
                const double low = std::floor(c[a]);
                const bool upper = (k >> a & 1) != 0;
                weight *= upper ? c[a] - low : 1 - (c[a] - low);
                const int i = std::clamp(static_cast<int>(low) + (upper ? 1 : 0), 0, side_ - 1);
                index += static_cast<std::size_t>(i) * step;
                step *= static_cast<std::size_t>(side_);
            }
            sum += weight * double{values_[index]};
        }
        return std::exp(-sum);
    }

  private:
    std::vector<float> values_;
    light_grid grid_;
    int side_;
};

TEST(sky, casts_shadows_that_move_with_the_wind_aloft) {
    cpu::device device;
    description what = small();
    what.cloud_voxels = 96;
    weather now;
    now.wind = 7.5f;
    now.wind_from = 250;
    auto made = meadow::sky<cpu::device>::create(device, what, now, usual());
    ASSERT_TRUE(made);
    const auto shadow_at = [&](double seconds) {
        EXPECT_TRUE(run(device, [&](auto& to) { made->record(to, now, seconds); }));
        return shadow_map(volume_of(device, made->sun_volume()), made->sun_grid(), 96);
    };
    const shadow_map before = shadow_at(20);
    const shadow_map after = shadow_at(65);
    // From 270 degrees, so due east, at 12 m/s, for 45 s.
    const glm::dvec2 way(540, 0);
    const auto apart = [&](glm::dvec2 moved) {
        double sum = 0;
        for (double z = -2000; z <= 2000; z += 80) {
            for (double x = -2500; x <= 2500; x += 80) {
                const double d = before.light({x, z}) - after.light(glm::dvec2(x, z) + moved);
                sum += d * d;
            }
        }
        return sum;
    };
    // Volumes of 150 m do not lie on the clouds the same way twice: something is left.
    const double least = apart(way);
    EXPECT_LT(least, 0.1 * apart({0, 0}));
    for (const glm::dvec2 other :
         {glm::dvec2(150, 0), glm::dvec2(-150, 0), glm::dvec2(0, 150), glm::dvec2(0, -150)}) {
        EXPECT_LT(least, 0.5 * apart(way + other));
    }
}

TEST(sky, is_a_function_of_the_time) {
    cpu::device device;
    std::vector<float> found[2];
    for (int i = 0; i < 2; ++i) {
        auto made = meadow::sky<cpu::device>::create(device, small(), weather{}, coarse());
        ASSERT_TRUE(made);
        if (i == 1) { // a past of its own
            weather other = covered(0.7f);
            other.sun_azimuth = 100;
            ASSERT_TRUE(run(device, [&](auto& to) { made->record(to, other, 1234); }));
        }
        ASSERT_TRUE(run(device, [&](auto& to) { made->record(to, weather{}, 77.7); }));
        found[i] = volume_of(device, made->sun_volume());
    }
    EXPECT_EQ(std::memcmp(found[0].data(), found[1].data(), found[0].size() * sizeof(float)), 0);
}

// ---- Drawing -----------------------------------------------------------------------------------

kernels::scene_record looking_up(const weather& now) {
    kernels::scene_record scene{};
    const glm::vec3 eye(22, 3.4f, 62);
    const glm::mat4 lens = glm::perspectiveRH_ZO(0.9f, 16.0f / 9, 1.0f, 1e5f);
    scene.to_clip = lens * glm::lookAtRH(eye, glm::vec3(0, 30, 0), glm::vec3(0, 1, 0));
    scene.from_clip = glm::inverse(scene.to_clip);
    scene.camera = glm::vec4(eye, 0);
    scene.sky = picture::daylight(picture::direction_to_sun(now.sun_azimuth, now.sun_elevation),
                                  now.turbidity);
    picture::set_ambient(scene, glm::vec3(0.1f));
    return scene;
}

/// A sky drawn into an image of 192 × 108, of which the left half is near already.
template <class B>
std::vector<glm::vec4> drawn(B& device, const weather& now) {
    constexpr std::uint32_t width = 192;
    constexpr std::uint32_t height = 108;
    std::vector<glm::vec4> pixels(std::size_t{width} * height);
    auto made = meadow::sky<B>::create(device, small(), now, coarse());
    auto color = device.create_image({width, height, image_format::rgba32f});
    auto depth = device.create_image({width, height, image_format::depth32f});
    const kernels::scene_record scene = looking_up(now);
    auto on_device = make_buffer<B, kernels::scene_record>(device, std::span(&scene, 1));
    if (!made || !color || !depth || !on_device) {
        ADD_FAILURE();
        return pixels;
    }
    std::vector<float> depths(pixels.size());
    for (std::size_t i = 0; i < depths.size(); ++i) {
        depths[i] = i % width < width / 2 ? 0.5f : 1.0f;
        pixels[i] = glm::vec4(1, 2, 3, 1);
    }
    EXPECT_TRUE(device.upload(*color, std::as_bytes(std::span(pixels))));
    EXPECT_TRUE(device.upload(*depth, std::as_bytes(std::span(depths))));
    EXPECT_TRUE(run(device, [&](auto& to) {
        made->record(to, now, 30);
        made->draw_clouds(to, view<B>(*on_device), glm::vec3(scene.camera),
                          draw_target<B>{&*color, &*depth, {}, {}});
    }));
    EXPECT_TRUE(device.download(*color, std::as_writable_bytes(std::span(pixels))));
    return pixels;
}

TEST(sky, is_drawn_where_nothing_is_before_it) {
    cpu::device device;
    const auto pixels = drawn(device, covered(0.6f));
    std::size_t clouded = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const bool as_it_was = pixels[i] == glm::vec4(1, 2, 3, 1);
        if (i % 192 < 96) {
            ASSERT_TRUE(as_it_was);
        } else {
            clouded += as_it_was ? 0 : 1;
            ASSERT_TRUE(glm::all(glm::greaterThanEqual(pixels[i], glm::vec4(0))));
            ASSERT_LE(pixels[i].x, 60.0f); // nothing is brighter than white in the sun, 40 kcd/m²
        }
    }
    EXPECT_GT(clouded, pixels.size() / 8); // of a half, looking up at 0.6
    EXPECT_LT(clouded, pixels.size() / 2);
    for (const glm::vec4& pixel : drawn(device, covered(0))) {
        ASSERT_EQ(pixel, glm::vec4(1, 2, 3, 1));
    }
}

TEST(sky, is_the_same_on_every_backend) {
    cpu::device cpu;
    const auto expected = drawn(cpu, covered(0.4f));
    for (const char* name : {"opengl", "vulkan"}) {
        support::with_device(name, [&](auto& device) {
            const auto found = drawn(device, covered(0.4f));
            double sum = 0;
            for (std::size_t i = 0; i < found.size(); ++i) {
                sum += double{glm::length(glm::vec3(found[i]) - glm::vec3(expected[i]))};
            }
            // Of radiances around 10 kcd/m²: 1/255 of white on average.
            EXPECT_LT(sum / double(found.size()), 0.04) << name;
        });
    }
}

// ---- Frame after frame -------------------------------------------------------------------------

TEST(sky, allocates_nothing_on_the_host_in_a_frame) {
    if (!SKYBARK_TEST_COUNTS_ALLOCATIONS) {
        GTEST_SKIP() << "Allocations are the sanitizer's here.";
    }
    cpu::device device;
    using B = cpu::device;
    auto made = meadow::sky<B>::create(device, small(), covered(0.4f), coarse());
    auto color = device.create_image({96, 54, image_format::rgba32f});
    auto depth = device.create_image({96, 54, image_format::depth32f});
    const kernels::scene_record scene = looking_up(weather{});
    auto on_device = make_buffer<B, kernels::scene_record>(device, std::span(&scene, 1));
    ASSERT_TRUE(made && color && depth && on_device);
    std::uint64_t counts[4];
    double seconds = 0;
    for (std::uint64_t& count : counts) {
        auto recorder = device.begin();
        ASSERT_TRUE(recorder);
        const std::uint64_t before = support::allocations;
        made->record(*recorder, covered(0.4f), seconds += 0.5);
        made->draw_clouds(*recorder, view<B>(*on_device), glm::vec3(scene.camera),
                          draw_target<B>{&*color, &*depth, {}, 1.0f});
        count = support::allocations - before;
        ASSERT_TRUE(device.submit(*recorder));
    }
    EXPECT_EQ(counts[3], 0u);
}

TEST(sky, sends_parameters_alone_in_a_frame) {
    for (const char* name : {"cpu", "opengl", "vulkan"}) {
        support::with_device(name, [name](auto& device) {
            using B = std::remove_reference_t<decltype(device)>;
            auto made = meadow::sky<B>::create(device, small(), covered(0.4f), coarse());
            ASSERT_TRUE(made);
            device_traffic before{};
            for (int frame = 0; frame < 2; ++frame) {
                before = device.traffic();
                ASSERT_TRUE(run(device, [&](auto& to) { made->record(to, covered(0.4f), frame); }));
            }
            // Kernels' parameters; the particles would be 100,000 bytes and more.
            EXPECT_LT(device.traffic().up - before.up, 20000u) << name;
            EXPECT_EQ(device.traffic().down, before.down) << name;
        });
    }
}

TEST(sky, keeps_to_the_contract) {
    cpu::device inner;
    using B = validated<cpu::device>;
    std::string misuse;
    B device(inner, [&](std::string_view sentence) { misuse = sentence; });
    (void)drawn(device, covered(0.1f));
    (void)drawn(device, covered(0));
    EXPECT_EQ(misuse, "");
}

} // namespace
