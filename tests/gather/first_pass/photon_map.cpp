// Photon maps against closed forms.

#include "gather/first_pass/boxes.hpp"

#include <first_pass/photon_map.hpp>

#include <cstring>
#include <gtest/gtest.h>

using namespace skybark;
using first_pass::photon_map;
using first_pass::photon_options;
using support::surfaces_of;

namespace {

constexpr double pi = 3.14159265358979323846;

photon_map traced(const scenes::surface_list& scene, const first_pass::far_lights& lights,
                  const photon_options& options) {
    auto map = photon_map::trace(surfaces_of(scene), lights, options);
    EXPECT_TRUE(map) << map.error().message;
    return std::move(*map);
}

photon_options photons(std::uint32_t count, std::uint32_t most_bounces = 1000) {
    photon_options options;
    options.photons = count;
    options.most_bounces = most_bounces;
    return options;
}

/// Points on the floor of the room, 0.1 and more from its walls.
std::vector<gather_sample> on_the_floor() {
    std::vector<gather_sample> samples;
    for (int i = 0; i < 20; ++i) {
        for (int j = 0; j < 20; ++j) {
            gather_sample s;
            s.position = {0.1f + 0.042f * static_cast<float>(i), 0,
                          0.1f + 0.042f * static_cast<float>(j)};
            s.normal = {0, 1, 0};
            samples.push_back(s);
        }
    }
    return samples;
}

double mean_of(std::span<const glm::vec4> values, int channel) {
    double sum = 0;
    for (const glm::vec4& v : values) {
        sum += static_cast<double>(v[channel]);
    }
    return sum / static_cast<double>(values.size());
}

TEST(photon_map, a_glowing_room_has_the_light_of_its_bounces) {
    const auto room = support::glowing_room(2, 0.5f);
    for (const std::uint32_t bounces : {0u, 1u, 3u, 1000u}) {
        const auto map = traced(room, {}, photons(200'000, bounces));
        const auto found = map.irradiance(on_the_floor(), 100);
        // π e (1 − ρ^(k+1)) / (1 − ρ). 400 disks of 99 photons share some of them: of about 40,000
        // that count, the mean is good to 1/√40,000 = 0.5 %; 4 of those.
        const double expected = pi * 2 * (1 - std::pow(0.5, bounces + 1.0)) / 0.5;
        EXPECT_NEAR(mean_of(found, 0), expected, 0.02 * expected) << bounces << " bounces";
        // One disk has √(1/98): 10 %; the spread of 400 of them is known to a tenth of itself.
        double squares = 0;
        for (const glm::vec4& v : found) {
            squares += std::pow(static_cast<double>(v.x) - expected, 2) / 400;
        }
        EXPECT_NEAR(std::sqrt(squares) / expected, 0.10, 0.03) << bounces << " bounces";
    }
}

TEST(photon_map, no_light_is_lost) {
    const auto room = support::lit_room();
    const auto map = traced(room, {}, photons(100'000));
    const first_pass::photon_balance& where = map.balance();
    // Roulette keeps the sum on average: 100,000 photons of 1 to a few bounces, 0.3 % each way.
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(where.emitted[c], pi * 0.16 * (10 - c), 1e-4 * where.emitted[c]);
        EXPECT_NEAR(where.absorbed[c], where.emitted[c], 0.012 * where.emitted[c]);
        EXPECT_EQ(where.escaped[c], 0) << "the room is closed";
    }
}

TEST(photon_map, squares_exchange_their_form_factor) {
    const auto map = traced(support::facing_squares(), {}, photons(400'000));
    // Everything stays that the black square gets; 80,000 of the photons: 1/√80,000 = 0.35 %.
    const first_pass::photon_balance& where = map.balance();
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(where.absorbed[c] / where.emitted[c], 0.199825, 4 * 0.0035 * 0.199825);
    }
    double arrived = 0;
    for (const first_pass::photon& p : map.photons()) {
        arrived += static_cast<double>(p.power.x);
        EXPECT_NEAR(p.position.y, 0, 1e-6);
        EXPECT_EQ(p.normal, glm::vec3(0, 1, 0));
    }
    EXPECT_NEAR(arrived, where.absorbed.x, 1e-6 * arrived);
}

TEST(photon_map, sun_and_sky_light_the_open_ground) {
    scenes::surface_list scene;
    scenes::add_ground(scene, scenes::add_paint(scene, glm::vec3(0.3f)), 1, 2);
    first_pass::far_lights lights;
    lights.to_sun = glm::normalize(glm::vec3(1, 2, 0));
    lights.sun = {3, 2, 1};
    lights.sky = [](glm::vec3 from) { return glm::vec3(1, 1, 2) * (from.y > 0 ? 1.0f : 0.0f); };
    auto map = photon_map::trace(surfaces_of(scene), lights, photons(400'000));
    ASSERT_TRUE(map);
    std::vector<gather_sample> middle(1);
    middle[0].normal = {0, 1, 0};
    const auto found = map->irradiance(middle, 20'000);
    const double cosine = 2 / std::sqrt(5.0);
    // 20,000 photons: 0.7 %, and 4 of those; colours of sun and sky mix within one estimate.
    EXPECT_NEAR(found[0].x, 3 * cosine + pi, 0.03 * (3 * cosine + pi));
    EXPECT_NEAR(found[0].y, 2 * cosine + pi, 0.03 * (2 * cosine + pi));
    EXPECT_NEAR(found[0].z, 1 * cosine + 2 * pi, 0.03 * (cosine + 2 * pi));
}

TEST(photon_map, light_comes_through_leaves) {
    // A leaf over the ground: what is below gets what passes, and the ground's own side nothing
    // but that. The leaf hides the whole sky of a sun straight above.
    scenes::surface_list scene;
    gather_material leaf;
    leaf.diffuse = {0.1f, 0.2f, 0.05f};
    leaf.transmission = {0.05f, 0.25f, 0.02f};
    leaf.two_sided = 1;
    const std::uint32_t green = scenes::add_material(scene, leaf);
    scenes::add_ground(scene, green, 1, 1);
    first_pass::far_lights lights;
    lights.sun = glm::vec3(1);
    const auto map = traced(scene, lights, photons(300'000));
    // The 4 m² of the leaf get 4 W; 1 − ρ − τ of them stay, the rest leaves.
    const first_pass::photon_balance& where = map.balance();
    const glm::dvec3 stays(0.85, 0.55, 0.93);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(where.absorbed[c], 4 * stays[c], 0.02 * 4 * stays[c]);
        EXPECT_NEAR(where.absorbed[c] + where.escaped[c], where.emitted[c],
                    0.01 * where.emitted[c]);
    }
    // Turned over, with the sun behind it, it is lit on its other side alone.
    lights.to_sun = {0, -1, 0};
    const auto below = traced(scene, lights, photons(10'000));
    for (const first_pass::photon& p : below.photons()) {
        EXPECT_EQ(p.normal, glm::vec3(0, -1, 0));
    }
}

TEST(photon_map, holes_let_photons_pass) {
    auto scene = support::facing_squares();
    const std::uint32_t black = 1;
    // A screen half way whose every texel is a hole, or none is.
    scenes::add_quad(scene, black, {-1, 0.5f, -1}, {2, 0.5f, -1}, {2, 0.5f, 2}, {-1, 0.5f, 2});
    scene.triangles[4].alpha = scene.triangles[5].alpha = 1;
    alpha_coordinates where;
    where.map = 12;
    where.size = 1 + 65536;
    std::vector<std::uint32_t> words(13);
    std::memcpy(words.data(), &where, sizeof(where));
    for (const float cover : {0.25f, 0.75f}) {
        std::memcpy(&words[12], &cover, sizeof(cover));
        auto map =
            photon_map::trace({scene.triangles, scene.materials, words}, {}, photons(20'000));
        ASSERT_TRUE(map);
        // Through the holes a fifth arrives below; the screen's black back keeps no photons.
        if (cover < 0.5f) {
            EXPECT_NEAR(static_cast<double>(map->photons().size()), 0.199825 * 20'000, 250);
        } else {
            EXPECT_TRUE(map->photons().empty());
            EXPECT_GE(map->balance().absorbed.x, 0.5 * map->balance().emitted.x);
        }
    }
}

TEST(photon_map, does_not_depend_on_threads) {
    const auto room = support::lit_room();
    photon_options one = photons(50'000);
    one.threads = 1;
    photon_options three = one;
    three.threads = 3;
    const auto a = traced(room, {}, one);
    const auto b = traced(room, {}, three);
    ASSERT_EQ(a.photons().size(), b.photons().size());
    EXPECT_EQ(0, std::memcmp(a.photons().data(), b.photons().data(), a.photons().size_bytes()));
    const auto at = on_the_floor();
    const auto x = a.irradiance(at, 50);
    const auto y = b.irradiance(at, 50);
    EXPECT_EQ(0, std::memcmp(x.data(), y.data(), x.size() * sizeof(glm::vec4)));
    photon_options other = one;
    other.seed = 2;
    EXPECT_NE(traced(room, {}, other).photons()[0].position, a.photons()[0].position);
}

TEST(photon_map, says_what_it_lacks) {
    const auto room = support::glowing_room(0, 0.5f);
    const auto dark = photon_map::trace(surfaces_of(room), {}, {});
    ASSERT_FALSE(dark);
    EXPECT_EQ(dark.error().message,
              "A photon map needs light: nothing emits, and sun and sky are black.");
    const auto none = photon_map::trace({}, {}, {});
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().message, "A photon map needs triangles: there are none.");
    const auto zero = photon_map::trace(surfaces_of(room), {}, photons(0));
    ASSERT_FALSE(zero);
    EXPECT_EQ(zero.error().message, "A photon map needs photons: 0 are asked for.");
}

} // namespace
