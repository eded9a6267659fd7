// Radiosity against closed forms and against photons.

#include "gather/first_pass/boxes.hpp"

#include <first_pass/form_factor.hpp>
#include <first_pass/photon_map.hpp>
#include <first_pass/radiosity.hpp>

#include <cstring>
#include <gtest/gtest.h>

using namespace skybark;
using first_pass::radiosity;
using first_pass::radiosity_options;
using support::surfaces_of;

namespace {

constexpr double pi = 3.14159265358979323846;

TEST(form_factor, of_a_square_above_is_as_published) {
    // Under the middle of a unit square at height 1: 0.239456 (by Howell's catalogue).
    const glm::vec3 lower[3] = {{-0.5f, 1, -0.5f}, {0.5f, 1, -0.5f}, {0.5f, 1, 0.5f}};
    const glm::vec3 upper[3] = {{-0.5f, 1, -0.5f}, {0.5f, 1, 0.5f}, {-0.5f, 1, 0.5f}};
    const glm::dvec3 up(0, 1, 0);
    EXPECT_NEAR(first_pass::form_factor({}, up, lower) + first_pass::form_factor({}, up, upper),
                0.239456, 5e-7);
}

TEST(form_factor, is_cut_off_at_the_horizon) {
    // A wall that stands on the plane, from far below it to far above: half of it counts, and a
    // wide enough one fills half of the hemisphere.
    const float far = 1e6f;
    const glm::vec3 wall[3] = {{-3 * far, -far, 1}, {3 * far, -far, 1}, {0, 2 * far, 1}};
    EXPECT_NEAR(first_pass::form_factor({}, {0, 1, 0}, wall), 0.5, 1e-5);
    const glm::vec3 below[3] = {{-1, -1, 0}, {1, -1, 0}, {0, -1, 1}};
    EXPECT_EQ(first_pass::form_factor({}, {0, 1, 0}, below), 0);
    const glm::vec3 beside[3] = {{1, 0, 0}, {2, 0, 0}, {1, 0, 1}};
    EXPECT_NEAR(first_pass::form_factor({}, {0, 1, 0}, beside), 0, 1e-15) << "in the plane itself";
}

TEST(radiosity, a_glowing_room_is_even) {
    const auto room = support::glowing_room(2, 0.5f);
    radiosity_options options;
    options.left = 1e-4;
    const auto tables = first_pass::patch_tables(surfaces_of(room), 3);
    const auto found = radiosity(surfaces_of(room), tables, {}, options);
    ASSERT_TRUE(found) << found.error().message;
    ASSERT_EQ(found->radiance.size(), 12u * 9);
    EXPECT_LE(found->left, 1e-4);
    for (const glm::vec4& radiance : found->radiance) {
        // e / (1 − ρ). All that a point sees is walls, and form factors are exact; but the lift
        // moves points by 2e-5 of the room.
        EXPECT_NEAR(radiance.x, 4, 4 * 5e-4);
    }
}

TEST(radiosity, squares_exchange_their_form_factor) {
    const auto scene = support::facing_squares();
    const auto tables = first_pass::patch_tables(surfaces_of(scene), 8);
    const auto found = radiosity(surfaces_of(scene), tables, {}, {});
    ASSERT_TRUE(found) << found.error().message;
    glm::dvec3 mean(0);
    for (std::size_t i = 128; i < 256; ++i) {
        mean += glm::dvec3(glm::vec3(found->irradiance[i])) / 128.0;
    }
    for (int c = 0; c < 3; ++c) {
        // Middles of patches of 1/8: the second difference leaves 1/64 · 1/24 or so.
        EXPECT_NEAR(mean[c] / (pi * (c + 1)), 0.199825, 1e-3);
    }
}

TEST(radiosity, sun_and_sky_light_the_open_ground) {
    scenes::surface_list scene;
    scenes::add_ground(scene, scenes::add_paint(scene, glm::vec3(0.3f)), 1, 2);
    first_pass::far_lights lights;
    lights.to_sun = glm::normalize(glm::vec3(1, 2, 0));
    lights.sun = {3, 2, 1};
    lights.sky = [](glm::vec3) { return glm::vec3(1, 1, 2); };
    const auto tables = first_pass::patch_tables(surfaces_of(scene), 1);
    const auto found = radiosity(surfaces_of(scene), tables, lights, {});
    ASSERT_TRUE(found);
    const double cosine = 2 / std::sqrt(5.0);
    for (const glm::vec4& e : found->irradiance) {
        EXPECT_NEAR(e.x, 3 * cosine + pi, 1e-4);
        EXPECT_NEAR(e.z, 1 * cosine + 2 * pi, 1e-4);
    }
    EXPECT_NEAR(found->radiance[0].x, 0.3 / pi * (3 * cosine + pi), 1e-4);
}

TEST(radiosity, light_comes_through_leaves) {
    scenes::surface_list scene;
    gather_material leaf;
    leaf.diffuse = glm::vec3(0.2f);
    leaf.transmission = glm::vec3(0.3f);
    leaf.two_sided = 1;
    scenes::add_ground(scene, scenes::add_material(scene, leaf), 1, 1);
    first_pass::far_lights lights;
    lights.sun = glm::vec3(1);
    const auto tables = first_pass::patch_tables(surfaces_of(scene), 2);
    const auto found = radiosity(surfaces_of(scene), tables, lights, {});
    ASSERT_TRUE(found);
    ASSERT_EQ(found->radiance.size(), 16u);
    for (std::size_t i = 0; i < 16; ++i) {
        const bool back = i % 8 >= 4;
        EXPECT_NEAR(found->irradiance[i].x, back ? 0 : 1, 1e-5);
        EXPECT_NEAR(found->radiance[i].x, (back ? 0.3 : 0.2) / pi, 1e-5);
    }
}

TEST(radiosity, agrees_with_photons) {
    const auto room = support::lit_room();
    const auto scene = surfaces_of(room);
    const auto tables = first_pass::patch_tables(scene, 6);
    const auto patches = first_pass::patches_of(scene, tables);
    const auto found = radiosity(scene, tables, {}, {});
    ASSERT_TRUE(found);
    first_pass::photon_options many;
    many.photons = 300'000;
    const auto map = first_pass::photon_map::trace(scene, {}, many);
    ASSERT_TRUE(map);
    // The flux that arrives on each wall, on the lamp, and on the box, W: counted, without any
    // estimate of density.
    std::vector<glm::dvec3> by_photons(room.triangles.size());
    const auto triangle_of = [&](const first_pass::photon& p) {
        std::size_t best = 0;
        float least = 1e30f;
        for (std::size_t i = 0; i < room.triangles.size(); ++i) {
            const gather_triangle& t = room.triangles[i];
            const glm::vec3 across = glm::cross(t.b - t.a, t.c - t.a);
            const glm::vec3 from = p.position - t.a;
            const float area = glm::dot(across, across);
            const float u = glm::dot(glm::cross(from, t.c - t.a), across) / area;
            const float v = glm::dot(glm::cross(t.b - t.a, from), across) / area;
            const float off = std::abs(glm::dot(from, across)) / std::sqrt(area) +
                              std::max({-u, -v, u + v - 1, 0.0f});
            if (off < least && glm::dot(across, p.normal) > 0) {
                least = off;
                best = i;
            }
        }
        return best;
    };
    for (const first_pass::photon& p : map->photons()) {
        by_photons[triangle_of(p)] += glm::dvec3(p.power);
    }
    std::vector<glm::dvec3> by_patches(room.triangles.size());
    for (std::size_t i = 0; i < patches.size(); ++i) {
        by_patches[patches[i].triangle] +=
            glm::dvec3(glm::vec3(found->irradiance[i]) * patches[i].area);
    }
    double apart = 0;
    double whole = 0;
    for (std::size_t i = 0; i < by_patches.size(); ++i) {
        apart += std::abs(by_patches[i].x - by_photons[i].x);
        whole += by_photons[i].x;
    }
    // Patches of 1/6 m near the lamp and the box are coarse; photons are good to 0.5 % a wall.
    EXPECT_LE(apart, 0.03 * whole);
    glm::dvec3 absorbed(0);
    glm::dvec3 emitted(0);
    for (std::size_t i = 0; i < patches.size(); ++i) {
        const gather_material& m = room.materials[room.triangles[patches[i].triangle].material];
        absorbed += glm::dvec3((1.0f - m.diffuse) * glm::vec3(found->irradiance[i])) *
                    static_cast<double>(patches[i].area);
        emitted += glm::dvec3(m.emission) * pi * static_cast<double>(patches[i].area);
    }
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(absorbed[c], emitted[c], 0.02 * emitted[c]);
    }
}

TEST(radiosity, does_not_depend_on_threads) {
    const auto room = support::lit_room();
    const auto tables = first_pass::patch_tables(surfaces_of(room), 2);
    radiosity_options one;
    one.threads = 1;
    radiosity_options three;
    three.threads = 3;
    const auto a = radiosity(surfaces_of(room), tables, {}, one);
    const auto b = radiosity(surfaces_of(room), tables, {}, three);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->shots, b->shots);
    EXPECT_EQ(0, std::memcmp(a->radiance.data(), b->radiance.data(),
                             a->radiance.size() * sizeof(glm::vec4)));
}

TEST(radiosity, says_what_it_lacks) {
    const auto none = radiosity({}, {}, {}, {});
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().message, "Radiosity needs triangles: there are none.");
    const auto room = support::glowing_room(1, 0.5f);
    const std::vector<patch_table> few(3);
    const auto lacking = radiosity(surfaces_of(room), few, {}, {});
    ASSERT_FALSE(lacking);
    EXPECT_EQ(lacking.error().message,
              "Radiosity needs a patch table a triangle: there are 3 tables and 12 triangles.");
}

} // namespace
