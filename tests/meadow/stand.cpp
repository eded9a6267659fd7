// The stand: where its trees are, what light meets of them, and that it lives through a gale at no
// cost but its work.

#include "support/allocations.hpp"
#include "support/devices.hpp"
#include "support/results.hpp"

#include <meadow/stand.hpp>

#include <cstring>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <set>

using namespace skybark;
using meadow::land;
using support::expect_done;
using support::value_of;

namespace {

/// An oak, an aspen and a little grass.
meadow::description small() {
    meadow::description what;
    what.trees = 2;
    what.grass = 0.02f;
    return what;
}
constexpr meadow::light_budget small_budget{1500, 200};

trees::view_detail usual_view() {
    const meadow::camera from;
    return value_of(trees::view_from(from.eye, 720, from.field));
}

template <backend B>
meadow::stand<B> grown(B& device, const meadow::description& what, float wind = 6) {
    meadow::weather now;
    now.wind = wind;
    return value_of(
        meadow::stand<B>::create(device, what, land(what.seed), now, usual_view(), small_budget));
}

template <backend B>
void sway(B& device, meadow::stand<B>& of, int frames, int first = 0) {
    for (int i = first; i < first + frames; ++i) {
        expect_done(run(device, [&](auto& r) { of.advance(r, i / 30.0, 1.0f / 30); }));
    }
}

/// Everything that it makes, as it is now.
template <backend B>
std::vector<float> made_by(B& device, meadow::stand<B>& of) {
    std::vector<gather_triangle> light;
    expect_done(run(device, [&](auto& r) { of.mesh(r); }));
    expect_done(of.describe_light(device, light));
    std::vector<float> all;
    for (const gather_triangle& t : light) {
        all.insert(all.end(), {t.a.x, t.a.y, t.a.z, t.b.x, t.b.y, t.b.z, t.c.x, t.c.y, t.c.z});
    }
    of.for_each_draw([&](const meadow::drawable<B>& one) {
        count_record count;
        std::uint32_t vertices = one.geometry.count;
        ASSERT_TRUE(one.geometry.length);
        expect_done(read_back<B, count_record>(device, *one.geometry.length.buffer, {&count, 1}));
        vertices = 3 * count.written;
        ASSERT_EQ(count.written, count.required) << "there is room for all that is seen";
        std::vector<surface_vertex> read(vertices);
        expect_done(read_back<B, surface_vertex>(device, *one.vertices.buffer, std::span(read)));
        for (const surface_vertex& v : read) {
            all.insert(all.end(), {v.position.x, v.position.y, v.position.z, v.normal.x, v.normal.y,
                                   v.normal.z, v.u, v.v});
        }
    });
    return all;
}

double area_of(const gather_triangle& t) {
    return static_cast<double>(glm::length(glm::cross(t.b - t.a, t.c - t.a))) / 2;
}

} // namespace

TEST(stand, places_are_apart_on_the_land_and_out_of_the_way) {
    const meadow::camera from;
    for (const std::uint32_t count : {0u, 1u, 24u, 120u}) {
        const auto places = meadow::place_trees(count, 1);
        ASSERT_EQ(places.size(), count);
        std::set<std::uint32_t> species;
        for (std::size_t i = 0; i < places.size(); ++i) {
            species.insert(places[i].species);
            EXPECT_LT(std::max(std::abs(places[i].at.x), std::abs(places[i].at.y)), land::side / 2);
            EXPECT_GT(places[i].height, 5);
            // Nobody stands between the camera and the middle of the clearing.
            const glm::vec2 eye(from.eye.x, from.eye.z);
            const glm::vec2 ahead = glm::normalize(glm::vec2(from.target.x, from.target.z) - eye);
            const float far = glm::dot(places[i].at - eye, ahead);
            const float aside = glm::distance(places[i].at - eye, far * ahead);
            EXPECT_FALSE(far > -5 && far < 55 && aside < 5) << i;
            for (std::size_t k = 0; k < i; ++k) {
                EXPECT_GT(glm::distance(places[i].at, places[k].at), 1.5f) << i << ", " << k;
            }
        }
        EXPECT_EQ(species.size(), std::min<std::size_t>(4, count)) << count;
    }
}

TEST(stand, trees_stand_on_the_land) {
    const land ground(1);
    const auto places = meadow::place_trees(6, 1);
    std::size_t roots = 0;
    for (const meadow::grown_trees& each : value_of(meadow::grow_trees(places, ground, 1))) {
        for (std::size_t i = 0; i < each.wood.size(); ++i) {
            if (each.wood.parent[i] == trees::none) {
                ++roots;
                const glm::vec3 foot = each.wood.position[i];
                const float deep = ground.height(foot.x, foot.z) - foot.y;
                EXPECT_GE(deep, -0.01f);
                EXPECT_LE(deep, 0.1f);
            }
        }
        EXPECT_GT(each.leaves.size(), 1000u);
        EXPECT_GT(each.leaf_cover, 0.3f);
    }
    EXPECT_EQ(roots, 6u);
}

TEST(stand, grass_grows_on_the_land_and_thins_out_with_the_distance) {
    const land ground(1);
    const auto grass = value_of(meadow::grow_grass(0.1f, ground, 1));
    ASSERT_EQ(grass.stems.size(), grass.area.size());
    const meadow::camera from;
    const glm::vec2 eye(from.eye.x, from.eye.z);
    std::array<double, 2> tufts{};
    for (const meadow::grown_blades& kind : grass.kinds) {
        EXPECT_GT(kind.blades.size(), 50u);
        for (const leaf& each : kind.blades) {
            ASSERT_LT(each.carrier, grass.stems.size());
            const glm::vec3 at = each.position;
            EXPECT_NEAR(at.y, ground.height(at.x, at.z) + 0.35f, 0.4f);
            const float far = glm::distance(glm::vec2(at.x, at.z), eye);
            tufts[0] += far < 15 ? 1 : 0;
            tufts[1] += far > 40 && far < 55 ? 1 : 0;
        }
    }
    // Rings of 707 m² (of which the land ends within 18 m) and 4,477 m².
    EXPECT_GT(tufts[0] / 707, 2 * tufts[1] / 4477);
    EXPECT_GT(tufts[1], 100);
    EXPECT_TRUE(value_of(meadow::grow_grass(0, ground, 1)).stems.empty());
    const auto twice = value_of(meadow::grow_grass(0.2f, ground, 1));
    EXPECT_NEAR(static_cast<double>(twice.kinds[0].blades.size()),
                2.0 * static_cast<double>(grass.kinds[0].blades.size()),
                0.1 * static_cast<double>(twice.kinds[0].blades.size()));
}

TEST(stand, light_meets_the_leaves_area) {
    const land ground(1);
    cpu::device device;
    const meadow::description what = small();
    auto stand = grown(device, what);
    std::vector<gather_triangle> light(2);
    expect_done(stand.describe_light(device, light, 5));
    ASSERT_EQ(light.size(), 2 + std::size_t{stand.light_triangles()});
    const auto materials = stand.light_materials();
    ASSERT_EQ(materials.size(), stand.materials().size());
    std::vector<double> area(materials.size() + 5, 0.0);
    for (std::size_t i = 2; i < light.size(); ++i) {
        ASSERT_GE(light[i].material, 5u);
        ASSERT_LT(light[i].material, area.size());
        area[light[i].material] += area_of(light[i]);
    }
    // A blade's octagon is 1/√2 of its width times its length, and its picture fills a part.
    std::size_t number = 5;
    std::size_t bound = 0;
    for (const auto& each :
         value_of(meadow::grow_trees(meadow::place_trees(what.trees, 1), ground, 1))) {
        double leaves = 0;
        for (const leaf& l : each.leaves) {
            leaves += static_cast<double>(l.width) * static_cast<double>(l.length);
        }
        leaves *= 0.70710678 * static_cast<double>(each.leaf_cover);
        EXPECT_GT(area[number], 0) << each.species;
        EXPECT_EQ(materials[number - 5].two_sided, 0u);
        EXPECT_NEAR(area[number + 1], leaves, 0.05 * leaves) << each.species;
        const gather_material& blade = materials[number - 4];
        EXPECT_EQ(blade.two_sided, 1u);
        for (int c = 0; c < 3; ++c) {
            EXPECT_GT(blade.diffuse[c], 0.01f);
            EXPECT_LE(blade.diffuse[c] + blade.transmission[c], 1.0f);
        }
        number += 2;
        bound += 2;
    }
    EXPECT_EQ(bound, 4u);
    EXPECT_LE(stand.light_triangles(), 2 * small_budget.leaves + 6 * small_budget.wood);
}

TEST(stand, light_follows_the_sway) {
    cpu::device device;
    auto stand = grown(device, small(), 12);
    std::vector<gather_triangle> rest;
    expect_done(stand.describe_light(device, rest));
    sway(device, stand, 60);
    std::vector<gather_triangle> moved;
    expect_done(stand.describe_light(device, moved));
    const auto materials = stand.light_materials();
    const auto apart = [](glm::vec3 a, glm::vec3 b) {
        return static_cast<double>(glm::distance(a, b));
    };
    bool last_was_right = false;
    double most = 0;
    double most_wood = 0;
    double area_at_rest = 0;
    double area = 0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
        ASSERT_EQ(rest[i].material, moved[i].material);
        const bool wood = materials[rest[i].material].two_sided == 0;
        if (!wood && !last_was_right) {
            // A right half goes from the stalk's end to the tip's. Its quadrilateral reaches 2^¼ −
            // 1 of half its length beyond both; where the leaf hangs moves with the twig alone.
            const auto hangs = [](const gather_triangle& t) {
                return glm::mix(t.a, t.c, 0.18920712f / 2.37841423f);
            };
            most = std::max(most, apart(hangs(rest[i]), hangs(moved[i])));
        }
        last_was_right = !wood && !last_was_right;
        most_wood = wood ? std::max(most_wood, apart(rest[i].a, moved[i].a)) : most_wood;
        area_at_rest += area_of(rest[i]);
        area += area_of(moved[i]);
    }
    EXPECT_GT(most, 0.05); // m
    EXPECT_GT(most_wood, 0.005);
    EXPECT_LT(most, 10);
    EXPECT_NEAR(area, area_at_rest, 0.02 * area_at_rest);
    // What is recorded begins where it is told to, and leaves the rest alone.
    auto room = value_of(device.create_buffer((moved.size() + 3) * sizeof(gather_triangle)));
    expect_done(run(
        device, [&](auto& r) { stand.record_light_surfaces(r, view<cpu::device>(room), 2, 9); }));
    std::vector<gather_triangle> recorded(moved.size() + 3);
    expect_done(read_back<cpu::device, gather_triangle>(device, room, std::span(recorded)));
    for (std::size_t i = 0; i < moved.size(); ++i) {
        ASSERT_EQ(recorded[i + 2].b, moved[i].b);
        ASSERT_EQ(recorded[i + 2].material, moved[i].material + 9);
    }
    EXPECT_EQ(recorded[1].c, glm::vec3(0));
    EXPECT_EQ(recorded.back().c, glm::vec3(0));
}

TEST(stand, nothing_breaks_in_a_wind_and_two_are_alike) {
    cpu::device device;
    std::array<std::vector<float>, 2> made;
    for (auto& one : made) {
        auto stand = grown(device, small(), 12);
        sway(device, stand, 150); // 5 s
        expect_done(stand.set_wind(device, 20, 100));
        sway(device, stand, 30, 150);
        one = made_by(device, stand);
    }
    for (const float x : made[0]) {
        ASSERT_TRUE(std::isfinite(x));
        ASSERT_LT(std::abs(x), 200);
    }
    ASSERT_EQ(made[0].size(), made[1].size());
    EXPECT_EQ(std::memcmp(made[0].data(), made[1].data(), made[0].size() * sizeof(float)), 0);
}

TEST(stand, the_wind_changes_without_a_jump) {
    cpu::device device;
    auto stand = grown(device, small(), 10);
    const auto light_at = [&](double seconds, float step) {
        expect_done(run(device, [&](auto& r) { stand.advance(r, seconds, step); }));
        std::vector<gather_triangle> light;
        expect_done(stand.describe_light(device, light));
        return light;
    };
    // An hour on, gusts of another speed would be others; nothing sways, but leaves lean.
    const auto before = light_at(3600, 0);
    expect_done(stand.set_wind(device, 10.5f, 250));
    const auto after = light_at(3600, 0);
    expect_done(stand.set_wind(device, 4, 70));
    const auto turned = light_at(3600, 0);
    double most = 0;
    double most_turned = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
        const auto moved = [&](const std::vector<gather_triangle>& to) {
            return static_cast<double>(glm::distance(before[i].c, to[i].c));
        };
        most = std::max(most, moved(after));
        most_turned = std::max(most_turned, moved(turned));
    }
    EXPECT_GT(most, 0);
    EXPECT_LT(most, 0.1); // m, of leaves that are enlarged to one and a half
    EXPECT_GT(most_turned, 0.3);
    EXPECT_FALSE(stand.set_wind(device, 5000, 0));
    EXPECT_FALSE(stand.set_wind(device, std::numeric_limits<float>::quiet_NaN(), 0));
    expect_done(stand.set_wind(device, 0, 0)); // a calm
    for (const gather_triangle& t : light_at(3600.1, 0.05f)) {
        ASSERT_TRUE(std::isfinite(t.a.x + t.b.y + t.c.z));
    }
}

/// Sways for a second there and on the CPU: what light meets, and how much is drawn.
template <backend B>
void expect_the_cpus_stand(B& device) {
    cpu::device cpu;
    auto here = grown(cpu, small(), 8);
    auto there = grown(device, small(), 8);
    sway(cpu, here, 30);
    sway(device, there, 30);
    std::vector<gather_triangle> wanted;
    std::vector<gather_triangle> light;
    expect_done(here.describe_light(cpu, wanted));
    expect_done(there.describe_light(device, light));
    ASSERT_EQ(light.size(), wanted.size());
    for (std::size_t i = 0; i < light.size(); ++i) {
        ASSERT_EQ(light[i].material, wanted[i].material);
        // Some micrometres of sway and rounding, at most.
        ASSERT_LT(glm::distance(light[i].a, wanted[i].a), 2e-4f) << i;
        ASSERT_LT(glm::distance(light[i].c, wanted[i].c), 2e-4f) << i;
    }
    expect_done(run(cpu, [&](auto& r) { here.mesh(r); }));
    expect_done(run(device, [&](auto& r) { there.mesh(r); }));
    const auto triangles = static_cast<double>(value_of(here.triangles(cpu)));
    EXPECT_NEAR(static_cast<double>(value_of(there.triangles(device))), triangles,
                1e-3 * triangles); // at thresholds of detail roundings decide
}
TEST(stand, opengl_has_the_cpus) {
    support::with_device("opengl", [](auto& device) { expect_the_cpus_stand(device); });
}
TEST(stand, vulkan_has_the_cpus) {
    support::with_device("vulkan", [](auto& device) { expect_the_cpus_stand(device); });
}

TEST(stand, a_far_view_costs_less) {
    cpu::device device;
    auto stand = grown(device, small());
    const auto near = value_of(stand.triangles(device));
    trees::view_detail far = usual_view();
    far.camera = {0, 300, 900};
    stand.look_from(far);
    expect_done(run(device, [&](auto& r) { stand.mesh(r); }));
    EXPECT_LT(value_of(stand.triangles(device)), near / 4);
    trees::view_detail close = usual_view();
    close.camera = glm::vec3(stand.box().min.x, 2, stand.box().max.z);
    close.pixels_per_radian *= 8;
    stand.look_from(close);
    expect_done(run(device, [&](auto& r) { stand.mesh(r); }));
    EXPECT_TRUE(value_of(stand.update(device)));
    expect_done(run(device, [&](auto& r) { stand.mesh(r); }));
    EXPECT_FALSE(value_of(stand.update(device))) << "there is room now";
    EXPECT_GT(value_of(stand.triangles(device)), near);
}

TEST(stand, steady_frames_allocate_nothing) {
#if SKYBARK_TEST_COUNTS_ALLOCATIONS
    cpu::device device;
    auto stand = grown(device, small());
    auto room = value_of(
        device.create_buffer(std::uint64_t{stand.light_triangles()} * sizeof(gather_triangle)));
    const auto frame = [&](int i) {
        auto recorder = device.begin();
        stand.advance(*recorder, i / 30.0, 1.0f / 30);
        stand.mesh(*recorder);
        stand.record_light_surfaces(*recorder, view<cpu::device>(room), 0);
        EXPECT_TRUE(device.submit(*recorder).has_value());
    };
    frame(0);
    frame(1);
    const std::uint64_t before = support::allocations;
    for (int i = 2; i < 12; ++i) {
        frame(i);
    }
    EXPECT_EQ(support::allocations - before, 0u);
#endif
}

TEST(stand, neither_trees_nor_grass_is_a_stand_as_well) {
    cpu::device device;
    meadow::description nothing;
    nothing.trees = 0;
    nothing.grass = 0;
    auto stand = grown(device, nothing);
    EXPECT_EQ(stand.light_triangles(), 0u);
    EXPECT_EQ(stand.segments(), 0u);
    sway(device, stand, 2);
    expect_done(run(device, [&](auto& r) { stand.mesh(r); }));
    EXPECT_EQ(value_of(stand.triangles(device)), 0u);
    std::vector<gather_triangle> light;
    expect_done(stand.describe_light(device, light));
    EXPECT_TRUE(light.empty());
}
