// Leaves: two sides, holes, and light that passes through; on every backend against every ray by
// every triangle, in double precision, along the same axes.

#include "support/brute_force.hpp"
#include "support/devices.hpp"
#include "support/form_factors.hpp"
#include "support/gathered.hpp"

#include <scenes/random.hpp>

#include <bit>
#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec2;
using glm::dvec3;
using glm::vec3;
using glm::vec4;
using support::pi;
using support::sample_at;

namespace {

class foliage : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(backends, foliage, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& of) { return std::string(of.param); });

constexpr int map_side = 5;

/// 40 leaves, two triangles each, over a ground; every third leaf has holes. Materials: 0 the
/// ground, 1 leaves of one side, 2 leaves of two.
struct clump {
    scenes::surface_list scene;
    std::vector<std::uint32_t> alpha;
    std::vector<float> texels;
    std::vector<gather_sample> samples;

    explicit clump(const gather_material& one_sided, const gather_material& two_sided) {
        scenes::random_numbers random(11);
        const std::uint32_t soil = scenes::add_paint(scene, vec3(0.3f, 0.2f, 0.1f));
        scene.materials.insert(scene.materials.end(), {one_sided, two_sided});
        scenes::add_ground(scene, soil, 3, 3);
        for (int i = 0; i < map_side * map_side; ++i) {
            texels.push_back(random.between(0, 1));
        }
        std::uint32_t with_holes = 0;
        for (std::uint32_t leaf = 0; leaf < 40; ++leaf) {
            const vec3 middle = vec3(0, 1.5f, 0) + random.in_ball();
            const vec3 along = 0.35f * random.direction();
            const vec3 across = 0.35f * glm::normalize(glm::cross(along, random.direction()));
            scenes::add_quad(scene, 1 + leaf % 2, middle - along - across, middle + along - across,
                             middle + along + across, middle - along + across);
            if (leaf % 3 == 0) {
                const std::size_t last = scene.triangles.size() - 1;
                scene.triangles[last - 1].alpha = ++with_holes;
                scene.triangles[last].alpha = ++with_holes;
            }
        }
        make_alpha(with_holes);
        for (int i = 0; i < 60; ++i) {
            samples.push_back(
                sample_at(vec3(0, 1.2f, 0) + 1.3f * random.in_ball(), random.direction()));
            samples.push_back(
                sample_at(vec3(random.between(-2, 2), 0, random.between(-2, 2)), vec3(0, 1, 0)));
        }
    }

    [[nodiscard]] gather::scene_description description() const {
        auto what = support::describe(scene);
        what.alpha = alpha;
        return what;
    }

    /// Where the corners of triangle i lie in the map, twice over and beyond its edges.
    [[nodiscard]] static std::array<dvec2, 3> places(std::uint32_t number) {
        if (number % 2 == 1) {
            return {dvec2(-0.5, 0), dvec2(1.5, 0), dvec2(1.5, 2)};
        }
        return {dvec2(-0.5, 0), dvec2(1.5, 2), dvec2(-0.5, 2)};
    }

    [[nodiscard]] bool hole(std::size_t triangle, double u, double v) const {
        const std::uint32_t number = scene.triangles[triangle].alpha;
        if (number == 0) {
            return false;
        }
        const auto corner = places(number);
        const dvec2 at = (1 - u - v) * corner[0] + u * corner[1] + v * corner[2];
        const auto texel = [](double place) {
            return static_cast<std::size_t>((place - std::floor(place)) * map_side);
        };
        return texels[texel(at.y) * map_side + texel(at.x)] < 0.5f;
    }

    [[nodiscard]] double lift() const {
        return static_cast<double>(gather::default_lift(gather::bounds_of(scene.triangles)));
    }

  private:
    void make_alpha(std::uint32_t count) {
        for (std::uint32_t number = 1; number <= count; ++number) {
            const auto corner = places(number);
            for (const dvec2 c : corner) {
                alpha.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(c.x)));
                alpha.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(c.y)));
            }
            alpha.push_back(12 * count);
            alpha.push_back(map_side + 65536 * map_side);
            alpha.push_back(std::bit_cast<std::uint32_t>(0.5f));
            alpha.insert(alpha.end(), 3, 0);
        }
        for (const float t : texels) {
            alpha.push_back(std::bit_cast<std::uint32_t>(t));
        }
    }
};

gather_material leaf_paint() {
    gather_material m;
    m.diffuse = vec3(0.1f, 0.4f, 0.05f);
    m.emission = vec3(0.5f, 1, 0.25f);
    return m;
}

gather_material leaf_of_two_sides() {
    gather_material m = leaf_paint();
    m.two_sided = 1;
    m.transmission = vec3(0.2f, 0.5f, 0.1f);
    m.emission = vec3(1, 0.5f, 2);
    return m;
}

std::vector<dvec3> axes_of(std::uint64_t seed, std::uint64_t count) {
    const gather::bundle_axes all(seed);
    std::vector<dvec3> axes;
    for (std::uint64_t k = 0; k < count; ++k) {
        axes.push_back(all[k]);
    }
    return axes;
}

const dvec3 sky(0.6, 0.8, 1.5);

gather::final_gather_options lit_options(std::uint64_t seed) {
    gather::final_gather_options options;
    options.seed = seed;
    options.sky = gather::even_sky(vec3(sky));
    return options;
}

/// Radiance that leaves the front and the back of each triangle.
struct sides {
    std::vector<dvec3> front;
    std::vector<dvec3> back;
};

sides emitted(const clump& leaves) {
    sides all;
    for (const gather_triangle& t : leaves.scene.triangles) {
        const gather_material& m = leaves.scene.materials[t.material];
        all.front.push_back(dvec3(m.emission));
        all.back.push_back(m.two_sided != 0 ? dvec3(m.emission) : dvec3(0));
    }
    return all;
}

dvec3 traced(const clump& leaves, const sides& radiance, const gather_sample& at,
             std::span<const dvec3> axes) {
    return support::traced_irradiance(
        leaves.scene.triangles, at, leaves.lift(), axes,
        [&](const support::traced_hit& hit, dvec3) {
            return hit.missed() ? sky
                   : hit.back   ? radiance.back[hit.triangle]
                                : radiance.front[hit.triangle];
        },
        [&](std::size_t i, double u, double v) { return leaves.hole(i, u, v); });
}

void expect_near(const vec4& found, const dvec3& expected, std::size_t i) {
    EXPECT_LE(length(dvec3(found) - expected), 1e-5 * length(expected)) << i;
}

} // namespace

/// Leaves of one side are black from behind, those of two shine to both; those with holes are seen
/// through.
TEST_P(foliage, has_sides_and_holes) {
    const clump leaves(leaf_paint(), leaf_of_two_sides());
    const auto axes = axes_of(3, 40);
    const sides radiance = emitted(leaves);
    support::with_device(GetParam(), [&](auto& device) {
        const auto scene = support::make_scene(device, leaves.description());
        const auto found =
            support::gathered(device, scene, leaves.samples, axes.size(), lit_options(3));
        for (std::size_t i = 0; i < found.size(); ++i) {
            expect_near(found[i], traced(leaves, radiance, leaves.samples[i], axes), i);
        }
    });
}

/// Two bounces: each side of a leaf passes on what arrives there, and on the other side what its
/// material lets through.
TEST_P(foliage, lets_light_through) {
    const clump leaves(leaf_paint(), leaf_of_two_sides());
    gather::bounce_options options;
    options.axes = 16;
    options.gather = lit_options(5);
    const auto& triangles = leaves.scene.triangles;
    const auto middles = support::middles_of(leaves.scene);
    sides radiance = emitted(leaves);
    for (std::uint64_t bounce = 0; bounce < 2; ++bounce) {
        const auto axes = axes_of(5 + bounce, options.axes);
        sides next = emitted(leaves);
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            const gather_material& m = leaves.scene.materials[triangles[i].material];
            gather_sample behind = middles[i];
            behind.normal = -behind.normal;
            const dvec3 front = traced(leaves, radiance, middles[i], axes);
            if (m.two_sided == 0) {
                next.front[i] += dvec3(m.diffuse) * front / pi;
                continue;
            }
            const dvec3 back = traced(leaves, radiance, behind, axes);
            next.front[i] += (dvec3(m.diffuse) * front + dvec3(m.transmission) * back) / pi;
            next.back[i] += (dvec3(m.diffuse) * back + dvec3(m.transmission) * front) / pi;
        }
        radiance = next;
    }
    support::with_device(GetParam(), [&](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const auto scene = support::make_scene(device, leaves.description());
        auto light = gather::bounced_light<B>::create(device, scene, options);
        ASSERT_TRUE(light) << light.error().message;
        ASSERT_TRUE(light->bounce(2));
        std::vector<vec4> found(scene.patch_count());
        ASSERT_TRUE(light->read_radiance(found));
        std::vector<patch_table> tables(scene.triangle_count());
        ASSERT_TRUE((read_back<B, patch_table>(device, *scene.tables().buffer, tables)));
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            expect_near(found[tables[i].front], radiance.front[i], i);
            if (tables[i].back != no_surface) {
                expect_near(found[tables[i].back], radiance.back[i], i);
            }
        }
        const auto axes = axes_of(9, 24);
        const auto seen =
            support::gathered(device, scene, leaves.samples, axes.size(), lit_options(9));
        for (std::size_t i = 0; i < seen.size(); ++i) {
            expect_near(seen[i], traced(leaves, radiance, leaves.samples[i], axes), i);
        }
    });
}

/// Through a leaf above it, ground gets the leaf's transmission of the sky's light: a large leaf
/// that lets 0.5 through and reflects none has a radiance of 0.5 L below, so the ground 0.5 π L.
TEST_P(foliage, tints_the_ground) {
    scenes::surface_list roof;
    gather_material green;
    green.diffuse = vec3(0);
    green.transmission = vec3(0.1f, 0.5f, 0.05f);
    green.two_sided = 1;
    const std::uint32_t leaf = scenes::add_material(roof, green);
    scenes::add_quad(roof, leaf, vec3(-300, 1, -300), vec3(-300, 1, 300), vec3(300, 1, 300),
                     vec3(300, 1, -300));
    const std::vector<gather_sample> ground{sample_at(vec3(0.1f, 0, 0.2f), vec3(0, 1, 0))};
    support::with_device(GetParam(), [&](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const auto scene = support::make_scene(device, support::describe(roof));
        gather::bounce_options options;
        options.gather.sky = gather::even_sky(vec3(1));
        auto light = gather::bounced_light<B>::create(device, scene, options);
        ASSERT_TRUE(light);
        ASSERT_TRUE(light->bounce());
        const auto found = support::gathered(device, scene, ground, 64);
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(found[0][c], pi * green.transmission[c], 1e-3);
        }
    });
}
