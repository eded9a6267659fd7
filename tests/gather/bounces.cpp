// bounced_light: what surfaces pass on, on the device alone; first passes of the caller's; suns.

#include "support/brute_force.hpp"
#include "support/devices.hpp"
#include "support/form_factors.hpp"
#include "support/gathered.hpp"

#include <scenes/cornell.hpp>
#include <scenes/samples.hpp>

#include <cstring>
#include <gtest/gtest.h>

using namespace skybark;
using gather::bounce_options;
using gather::bounced_light;
using glm::dvec3;
using glm::vec3;
using glm::vec4;
using support::pi;
using support::sample_at;

namespace {

class bounces : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(backends, bounces, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& of) { return std::string(of.param); });

template <class B>
std::vector<vec4> radiance_of(bounced_light<B>& light, std::uint32_t patches) {
    std::vector<vec4> found(patches);
    const auto done = light.read_radiance(found);
    EXPECT_TRUE(done) << done.error().message;
    return found;
}

template <class B>
bounced_light<B> make_light(B& device, const gather::gather_scene<B>& scene,
                            const bounce_options& options) {
    auto made = bounced_light<B>::create(device, scene, options);
    EXPECT_TRUE(made) << made.error().message;
    return std::move(*made);
}

} // namespace

/// Along the same axes, by every ray against every triangle in double precision: two bounces of a
/// lamp, the sky and the sun, at every patch.
TEST_P(bounces, are_those_of_every_ray_against_every_triangle) {
    const scenes::surface_list box = scenes::cornell();
    bounce_options options;
    options.axes = 12;
    options.gather.seed = 7;
    const vec3 sky(0.3f, 0.5f, 0.9f);
    options.gather.sky = gather::even_sky(sky);
    const vec3 sun = glm::normalize(vec3(-0.2f, 0.4f, 1));
    const vec3 beam(3, 2, 1);

    // The patches are the triangles; those of the floor have their middles inside of the boxes, and
    // stay black.
    const auto samples = support::middles_of(box);
    const double lift = static_cast<double>(gather::default_lift(gather::bounds_of(box.triangles)));
    std::vector<dvec3> radiance;
    for (const gather_triangle& t : box.triangles) {
        radiance.push_back(dvec3(box.materials[t.material].emission));
    }
    for (std::uint64_t bounce = 0; bounce < 2; ++bounce) {
        const gather::bundle_axes all(7 + bounce);
        std::vector<dvec3> axes;
        for (std::uint64_t k = 0; k < options.axes; ++k) {
            axes.push_back(all[k]);
        }
        auto next = radiance;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            dvec3 irradiance = support::traced_irradiance(
                box.triangles, samples[i], lift, axes, [&](const support::traced_hit& hit, dvec3) {
                    return hit.missed() ? dvec3(sky) : hit.back ? dvec3(0) : radiance[hit.triangle];
                });
            const dvec3 normal(samples[i].normal);
            const double cosine = dot(normal, dvec3(sun));
            if (cosine > 0 && support::trace(box.triangles,
                                             dvec3(samples[i].position) + lift * normal, dvec3(sun))
                                  .missed()) {
                irradiance += cosine * dvec3(beam);
            }
            const gather_material& m = box.materials[box.triangles[i].material];
            next[i] = dvec3(m.emission) + dvec3(m.diffuse) * irradiance / pi;
        }
        radiance = next;
    }

    support::with_device(GetParam(), [&](auto& device) {
        const auto scene = support::make_scene(device, support::describe(box));
        auto light = make_light(device, scene, options);
        light.light_from(sun, beam);
        ASSERT_TRUE(light.bounce(2));
        EXPECT_EQ(light.bounces(), 2u);
        const auto found = radiance_of(light, scene.patch_count());
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_LE(length(dvec3(found[i]) - radiance[i]), 1e-5 * length(radiance[i])) << i;
        }
    });
}

/// Patches, samples and light stay on the device: up go commands and parameters, down nothing.
TEST_P(bounces, keep_all_on_the_device) {
    const scenes::surface_list box = scenes::cornell();
    support::with_device(GetParam(), [&](auto& device) {
        const auto scene = support::make_scene(device, support::describe(box, 0.1f));
        ASSERT_GT(scene.patch_count(), 20000u);
        bounce_options options;
        options.axes = 4;
        auto light = make_light(device, scene, options);
        ASSERT_TRUE(light.bounce());
        const device_traffic before = device.traffic();
        ASSERT_TRUE(light.bounce(2));
        const device_traffic after = device.traffic();
        EXPECT_EQ(after.down, before.down);
        EXPECT_LE(after.up - before.up, 2u * 4 * 4096); // far below 16 bytes a patch
    });
}

/// Recorded into the caller's stream, the same as one that is submitted here.
TEST_P(bounces, can_be_recorded) {
    const scenes::surface_list box = scenes::cornell();
    support::with_device(GetParam(), [&](auto& device) {
        const auto scene = support::make_scene(device, support::describe(box));
        bounce_options options;
        options.axes = 9;
        auto light = make_light(device, scene, options);
        ASSERT_TRUE(light.bounce(2));
        const auto expected = radiance_of(light, scene.patch_count());
        ASSERT_TRUE(light.restart());
        EXPECT_EQ(light.bounces(), 0u);
        const auto done = run(device, [&](auto& recorder) {
            light.record(recorder);
            light.record(recorder);
        });
        ASSERT_TRUE(done) << done.error().message;
        const auto found = radiance_of(light, scene.patch_count());
        EXPECT_EQ(std::memcmp(found.data(), expected.data(), found.size() * sizeof(vec4)), 0);
    });
}

TEST_P(bounces, begin_with_what_is_emitted_and_can_do_so_again) {
    const scenes::surface_list box = scenes::cornell();
    support::with_device(GetParam(), [&](auto& device) {
        const auto scene = support::make_scene(device, support::describe(box));
        auto light = make_light(device, scene, {});
        const auto expect_emission = [&] {
            const auto found = radiance_of(light, scene.patch_count());
            for (std::size_t i = 0; i < found.size(); ++i) {
                EXPECT_EQ(vec3(found[i]), box.materials[box.triangles[i].material].emission);
            }
        };
        expect_emission();
        ASSERT_TRUE(light.bounce());
        ASSERT_TRUE(light.restart());
        expect_emission();
    });
}

/// A first pass from elsewhere, as radiance and as irradiance: the lower of two facing squares is
/// given light, and the upper one gets the share of it that it should.
TEST_P(bounces, go_on_from_light_of_the_callers) {
    scenes::surface_list squares;
    const std::uint32_t paint = scenes::add_paint(squares, vec3(0.5f, 0.25f, 1));
    scenes::add_quad(squares, paint, vec3(0, 0, 0), vec3(0, 0, 1), vec3(1, 0, 1), vec3(1, 0, 0));
    const std::vector<gather_sample> samples{sample_at(vec3(0.5f, 1, 0.5f), vec3(0, -1, 0))};
    const double share = support::share_of_parallel_square(0.5, 0.5);
    support::with_device(GetParam(), [&](auto& device) {
        const auto scene = support::make_scene(device, support::describe(squares, 0.3f));
        auto light = make_light(device, scene, {});
        const std::vector<vec4> given(scene.patch_count(), vec4(2, 4, 1, 0));
        ASSERT_TRUE(light.set_radiance(given));
        const auto by_radiance = support::gathered(device, scene, samples, 1024);
        ASSERT_TRUE(light.set_irradiance(given)); // π times less, times what is reflected
        const auto by_irradiance = support::gathered(device, scene, samples, 1024);
        const vec3 radiance(2, 4, 1);
        const vec3 reflected = radiance * vec3(0.5f, 0.25f, 1) / static_cast<float>(pi);
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(by_radiance[0][c] / (pi * radiance[c]), share, 0.015);
            EXPECT_NEAR(by_irradiance[0][c] / by_radiance[0][c], reflected[c] / radiance[c], 1e-5);
        }
    });
}

/// Colour bleeds: beside the red wall the floor is redder than beside the green one.
TEST(bounced_light, carries_colour) {
    const scenes::surface_list box = scenes::cornell();
    const std::vector<gather_sample> samples{sample_at(vec3(-2.6f, 0, 0.5f), vec3(0, 1, 0)),
                                             sample_at(vec3(2.6f, 0, 0.5f), vec3(0, 1, 0))};
    cpu::device device;
    const auto scene = support::make_scene(device, support::describe(box, 0.4f));
    auto light = make_light(device, scene, {});
    const auto direct = support::gathered(device, scene, samples, 512);
    ASSERT_TRUE(light.bounce(3));
    const auto all = support::gathered(device, scene, samples, 512);
    const auto red_over_green = [&](std::size_t i) {
        const vec4 indirect = all[i] - direct[i];
        return indirect.x / indirect.y;
    };
    EXPECT_GT(red_over_green(0), 1.3f * red_over_green(1));
}

TEST_P(bounces, say_what_they_take) {
    const scenes::surface_list box = scenes::cornell();
    support::with_device(GetParam(), [&](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const auto scene = support::make_scene(device, support::describe(box));
        bounce_options options;
        options.gather.most_bytes = 1000;
        const auto refused = bounced_light<B>::create(device, scene, options);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, error_code::out_of_memory);
        EXPECT_GE(bounced_light<B>::required_bytes(device, scene.patch_count(),
                                                   scene.triangle_count(), options),
                  36u * (16 + 16 + 16 + 16 + 128));
    });
}

/// Triangles that the device moves between bounces: a screen slides away from before a lamp, with
/// nothing built anew.
TEST_P(bounces, follow_triangles_that_move) {
    scenes::surface_list stage;
    const std::uint32_t lamp = support::add_light(stage, vec3(1));
    const std::uint32_t dark = scenes::add_paint(stage, vec3(0));
    scenes::add_quad(stage, lamp, vec3(0, 2, 0), vec3(1, 2, 0), vec3(1, 2, 1), vec3(0, 2, 1));
    scenes::add_quad(stage, dark, vec3(-4, 1, -4), vec3(5, 1, -4), vec3(5, 1, 5), vec3(-4, 1, 5));
    const std::vector<gather_sample> samples{sample_at(vec3(0.5f, 1.5f, 0.5f), vec3(0, 1, 0)),
                                             sample_at(vec3(0.5f, 0.5f, 0.5f), vec3(0, 1, 0))};
    support::with_device(GetParam(), [&](auto& device) {
        auto scene = support::make_scene(device, support::describe(stage));
        auto gather = support::make_gather(device, scene, std::span(samples), {});
        ASSERT_TRUE(gather.add(64));
        const auto before = support::read(gather);
        EXPECT_GT(before[0].x, 1);
        EXPECT_EQ(before[1].x, 0);
        std::vector<gather_triangle> moved = stage.triangles;
        for (std::size_t i = 2; i < 4; ++i) { // down to the floor
            moved[i].a.y = moved[i].b.y = moved[i].c.y = 0;
        }
        const auto all = scene.triangles();
        ASSERT_TRUE(device.upload(*all.buffer, all.offset,
                                  std::as_bytes(std::span<const gather_triangle>(moved))));
        scene.move_within(gather::bounds_of(moved));
        ASSERT_TRUE(gather.restart(1));
        ASSERT_TRUE(gather.add(64));
        const auto after = support::read(gather);
        EXPECT_NEAR(after[0].x, before[0].x, 1e-6);
        EXPECT_GT(after[1].x, 0.1);
    });
}
