// What maps make of bark and leaves, and how land melts into the distance, against closed forms in
// double precision.

#include <skybark/kernels/meadow_scene.hpp>
#include <skybark/shared/surfaces.hpp>

#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;
using glm::vec3;
using glm::vec4;

namespace {

/// A texel of a normal map that leans by `x` and `y` (of the tangents) out of `z`.
vec4 texel_of(dvec3 n, float height) { return {vec3(glm::normalize(n) * 0.5 + 0.5), height}; }

} // namespace

TEST(meadow_surfaces, bark_leans_as_its_normal_map_says) {
    const dvec3 normal = glm::normalize(dvec3(0.3, -0.2, 0.9));
    const dvec3 around = glm::normalize(glm::cross(dvec3(0, 1, 0), normal));
    const dvec3 along = glm::cross(normal, around);
    for (const float hand : {1.0f, -1.0f}) {
        for (const dvec3 map : {dvec3(0, 0, 1), dvec3(0.4, 0, 1), dvec3(-0.2, 0.7, 1)}) {
            // The tangent is longer than 1 and leans towards the normal, as between two vertices.
            const vec4 tangent(vec3(around * 1.7 + normal * 0.4), hand);
            const auto surface = shared::bark_surface_of(texel_of(map, 0.25f), vec3(normal),
                                                         tangent, vec3(0.1f), vec3(0.5f), 1);
            const dvec3 expected =
                glm::normalize(normal * map.z + around * map.x + along * (map.y * double{hand}));
            // Five or so roundings, of numbers up to 1.
            EXPECT_LE(glm::length(dvec3(surface.normal) - expected), 2e-6);
            EXPECT_NEAR(surface.albedo.x, 0.2, 1e-6);
        }
    }
}

TEST(meadow_surfaces, bark_without_texture_directions_is_plain) {
    const auto surface = shared::bark_surface_of(texel_of({0.5, 0.5, 1}, 1), {0, 0, 1}, vec4(0),
                                                 vec3(0.1f), vec3(0.5f), 1);
    EXPECT_LE(glm::length(surface.normal - vec3(0, 0, 1)), 1e-6f);
    EXPECT_FLOAT_EQ(surface.albedo.y, 0.5f);
}

TEST(meadow_surfaces, slopes_of_the_normal_map_can_be_made_flatter) {
    const vec4 texel = texel_of({0.6, 0, 1}, 0);
    const vec4 tangent(1, 0, 0, 1);
    const auto half = shared::bark_surface_of(texel, {0, 0, 1}, tangent, {}, {}, 0.5f);
    EXPECT_NEAR(half.normal.x / half.normal.z, 0.3, 1e-5);
}

TEST(meadow_surfaces, leaves_pass_on_light_that_is_yellower) {
    const auto leaf = shared::leaf_surface_of({0.5f, 0.5f, 0.5f, 1}, 0.5f);
    const double linear = std::pow((0.5 + 0.055) / 1.055, 2.4); // sRGB
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(leaf.reflected[i], linear, 0.002); // the cubic's error
    }
    EXPECT_NEAR(leaf.through.x, 0.55 * linear, 0.002);
    EXPECT_NEAR(leaf.through.y, 0.5 * linear, 0.002);
    EXPECT_NEAR(leaf.through.z, 0.15 * linear, 0.002);
}

TEST(meadow_surfaces, clouds_dim_by_the_strength_of_their_shadow) {
    kernels::surroundings_record around{};
    for (const float strength : {0.0f, 0.3f, 1.0f}) {
        around.cloud_shadow = strength;
        for (const double attenuation : {0.0, 0.01, 1.0, 7.0, 60.0}) {
            const double expected = 1 - double{strength} * -std::expm1(-attenuation);
            EXPECT_NEAR(shared::meadow_cloud_light(around, static_cast<float>(attenuation)),
                        expected, 1e-6);
        }
    }
}

TEST(meadow_surfaces, grass_melts_into_the_country_without_a_step) {
    for (const float x : {-310.0f, 12.5f, 170.0f}) {
        const float z = 0.7f * x + 3;
        const vec3 grass = shared::grass_albedo(x, z);
        EXPECT_EQ(shared::meadow_albedo(x, z, 0), grass);
        EXPECT_EQ(shared::meadow_albedo(x, z, 60), grass);
        EXPECT_EQ(shared::meadow_albedo(x, z, 500), shared::country_albedo(x, z, 500));
        for (float distance = 0; distance < 600; distance += 1) {
            const vec3 here = shared::meadow_albedo(x, z, distance);
            const vec3 next = shared::meadow_albedo(x, z, distance + 1);
            // A smooth step over 340 m is 1.5 / 340 a metre at most, of albedos below 0.4.
            EXPECT_LE(glm::length(next - here), 0.004f) << distance;
        }
    }
}

TEST(meadow_surfaces, air_takes_light_and_gives_the_skys) {
    kernels::surroundings_record around{};
    shared::daylight_sky dark{}; // gives nothing: the zenith is black
    dark.zenith = {0, 0.3f, 0.3f, 0};
    dark.to_sun = {0, 1, 0, 0};
    around.air = 1.25e-4f;
    for (const double distance : {0.0, 1.0, 300.0, 8000.0, 60000.0}) {
        const vec3 away(glm::normalize(dvec3(0.6, -0.1, 0.3)) * distance);
        const vec3 seen = shared::meadow_through_air(around, dark, {3, 2, 1}, away);
        const double left = std::exp(-1.25e-4 * distance);
        EXPECT_NEAR(seen.x, 3 * left, 3e-5);
        EXPECT_NEAR(seen.z, 1 * left, 1e-5);
    }
}
