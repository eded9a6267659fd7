// Bundles that the backend resolves itself: against a plain loop over all triangles with the same
// formulas, whose bits must come out, and against planes whose distances are known.
#include "support.hpp"

#include <skybark/gather/bundle.hpp>
#include <skybark/gather/bundle_resolver.hpp>
#include <skybark/shared/alpha_map.hpp>
#include <skybark/shared/bundle.hpp>

#include <cstring>

namespace skybark::testing {
namespace {

using triangles = std::vector<gather_triangle>;
using samples = std::vector<gather_sample>;

static_assert(resolves_bundles<device>);

struct scene {
    triangles surfaces;
    samples points;
    std::vector<std::uint32_t> alpha;
    noise random;

    [[nodiscard]] glm::vec3 anywhere(float reach) {
        return reach * (2.0f * glm::vec3(random.unit(), random.unit(), random.unit()) - 1.0f);
    }
    /// A triangle of about this size somewhere within `reach`.
    void add_triangle(float reach, float size) {
        gather_triangle t;
        t.a = anywhere(reach);
        t.b = t.a + anywhere(size);
        t.c = t.a + anywhere(size);
        surfaces.push_back(t);
    }
    /// Samples on triangles, at their corners and on their edges as well, and elsewhere.
    void add_points(std::uint32_t count, float reach) {
        for (std::uint32_t i = 0; i < count; ++i) {
            gather_sample s;
            s.normal = glm::normalize(anywhere(1) + glm::vec3(1e-3f));
            s.position = anywhere(reach);
            if (!surfaces.empty() && i % 4 != 0) {
                const gather_triangle& t =
                    surfaces[random() % static_cast<std::uint32_t>(surfaces.size())];
                const float u = i % 4 == 1 ? 0.0f : random.unit();
                const float v = i % 4 <= 2 ? 0.0f : (1.0f - u) * random.unit();
                s.position = t.a + u * (t.b - t.a) + v * (t.c - t.a);
            }
            points.push_back(s);
        }
    }
};

bool is_hole(const scene& s, std::uint32_t number, float u, float v) {
    if (number == 0) {
        return false;
    }
    alpha_coordinates at;
    std::memcpy(static_cast<void*>(&at), s.alpha.data() + 12 * (number - 1), sizeof at);
    const std::uint32_t width = at.size & 0xffffu;
    const std::uint32_t column =
        shared::alpha_texel(shared::alpha_place(at.a.x, at.b.x, at.c.x, u, v), width);
    const std::uint32_t row =
        shared::alpha_texel(shared::alpha_place(at.a.y, at.b.y, at.c.y, u, v), at.size >> 16);
    return std::bit_cast<float>(s.alpha[at.map + row * width + column]) < at.cutoff;
}

/// Every sample against every triangle, those of lower number first.
std::vector<gather_hit> by_looking_at_all(const scene& s, const ray_bundle& bundle) {
    std::vector<std::array<glm::vec3, 3>> corners;
    for (const gather_triangle& t : s.surfaces) {
        corners.push_back({shared::across_bundle(bundle, t.a), shared::across_bundle(bundle, t.b),
                           shared::across_bundle(bundle, t.c)});
    }
    std::vector<gather_hit> hits(s.points.size());
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const glm::vec3 origin =
            shared::across_bundle(bundle, shared::ray_origin(bundle, s.points[i]));
        const float side = shared::side_of_bundle(bundle, s.points[i].normal);
        for (std::uint32_t n = 0; n < corners.size(); ++n) {
            const auto met =
                shared::meet_triangle(corners[n][0], corners[n][1], corners[n][2], origin.x,
                                      origin.y, shared::meeting_slack(bundle));
            const float distance = shared::distance_along(met, side, origin.z, bundle.right.w);
            if (distance >= 0 && distance < hits[i].distance &&
                !is_hole(s, s.surfaces[n].alpha, met.u, met.v)) {
                hits[i] = {distance, 2 * n + (side * met.facing < 0 ? 0u : 1u), met.u, met.v};
            }
        }
    }
    return hits;
}

class resolving : public both_ways {
  protected:
    [[nodiscard]] static ray_bundle bundle_of(const scene& s, std::uint32_t cells, glm::dvec3 axis,
                                              float lift = 1e-4f) {
        gather::bounds box = gather::bounds_of(s.surfaces);
        for (const gather_sample& p : s.points) {
            box.add(p.position);
        }
        return gather::make_bundle(box, axis, cells, lift);
    }

    [[nodiscard]] std::vector<gather_hit> resolve(const scene& s, const ray_bundle& bundle) {
        const auto surfaces = upload(gpu(), s.surfaces);
        const auto points = upload(gpu(), s.points);
        const auto alpha = upload(gpu(), s.alpha);
        // Hits of something else, which must not be seen, and some that must stay.
        const gather_hit other{0.0f, 3, 0.5f, 0.5f};
        const auto hits = upload(gpu(), std::vector<gather_hit>(s.points.size() + 16, other));
        const bundle_work<device> work{view<device>(surfaces), view<device>(alpha),
                                       view<device>(points),
                                       view<device, gather_hit>(hits, 0, s.points.size())};
        go(gpu(), [&](auto& r) { r.resolve(bundle, work); });
        auto all = download<gather_hit>(gpu(), hits, s.points.size() + 16);
        for (std::size_t i = s.points.size(); i < all.size(); ++i) {
            EXPECT_EQ(all[i].surface, 3u);
        }
        all.resize(s.points.size());
        return all;
    }

    /// How many of the samples meet something, all being met as a plain loop does.
    std::size_t check(const scene& s, const ray_bundle& bundle) {
        auto expected = by_looking_at_all(s, bundle);
        auto got = resolve(s, bundle);
        std::size_t met = 0;
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            // −0 or 0, whatever the greater of them is.
            expected[i].distance += 0.0f;
            got[i].distance += 0.0f;
            met += expected[i].surface != no_surface ? 1 : 0;
            if (std::memcmp(&got[i], &expected[i], sizeof(gather_hit)) != 0 && wrong++ < 3) {
                ADD_FAILURE() << "sample " << i << ": " << got[i].distance << " " << got[i].surface
                              << " and not " << expected[i].distance << " " << expected[i].surface;
            }
        }
        EXPECT_EQ(wrong, 0u);
        return met;
    }
};
INSTANTIATE_TEST_SUITE_P(vulkan, resolving, ::testing::Bool(), way_name);

TEST_P(resolving, planes_are_met_at_their_distances) {
    // Squares 4 m wide at z = 0 and 1, each of two triangles: between them, above and beside.
    scene s;
    for (const float z : {0.0f, 1.0f}) {
        const glm::vec3 a{-2, -2, z}, b{2, -2, z}, c{2, 2, z}, d{-2, 2, z};
        s.surfaces.push_back({a, 0, b, 0, c, 0});
        s.surfaces.push_back({a, 0, c, 0, d, 0});
    }
    const glm::vec3 up{0, 0, 1};
    s.points = {{{1, 0.5f, 0}, 0, up, 0},      {{1, 0.5f, 1}, 0, -up, 0},
                {{1, 0.5f, 1}, 0, up, 0},      {{0.5f, 1, 0.25f}, 0, up, 0},
                {{0.5f, 1, 0.25f}, 0, -up, 0}, {{3, 0, 0.5f}, 0, up, 0}};
    const float lift = 1e-4f;
    const auto hits = resolve(s, bundle_of(s, 8, {0, 0, 1}, lift));
    const float expected[] = {1 - lift,     1 - lift,     no_distance,
                              0.75f - lift, 0.25f - lift, no_distance};
    // Triangle b c and its side: backs are seen from below, fronts from above.
    const std::uint32_t surface[] = {5, 0, no_surface, 7, 2, no_surface};
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_NEAR(hits[i].distance, expected[i], 1e-6f) << i;
        EXPECT_EQ(hits[i].surface, surface[i]) << i;
    }
    // (1, 0.5) = a + u (b - a) + v (c - a) with u + v = 3/4 and v = 5/8.
    EXPECT_NEAR(hits[0].u, 0.125f, 1e-6f);
    EXPECT_NEAR(hits[0].v, 0.625f, 1e-6f);
}

TEST_P(resolving, triangles_of_all_sizes_are_found_in_any_grid) {
    scene s;
    for (std::uint32_t i = 0; i < 1500; ++i) {
        s.add_triangle(10, i % 7 == 0 ? 8.0f : i % 3 == 0 ? 1.0f : 0.15f);
    }
    s.add_points(1500, 11);
    for (const std::uint32_t cells : {1u, 2u, 4u, 64u, 512u}) {
        const glm::dvec3 axis{0.3 * cells, -0.5, 0.8};
        EXPECT_GT(check(s, bundle_of(s, cells, axis)), 500u) << cells;
    }
}

TEST_P(resolving, corners_and_edges_in_line_with_cells_are_found) {
    // A grid of squares whose edges lie on those of cells, looked at along an axis.
    scene s;
    for (int y = -8; y < 8; ++y) {
        for (int x = -8; x < 8; ++x) {
            const float z = static_cast<float>((x * 5 + y * 3) % 4);
            const auto at = [&](int i, int j) {
                return glm::vec3(static_cast<float>(x + i), static_cast<float>(y + j), z);
            };
            s.surfaces.push_back({at(0, 0), 0, at(1, 0), 0, at(1, 1), 0});
            s.surfaces.push_back({at(0, 0), 0, at(1, 1), 0, at(0, 1), 0});
        }
    }
    for (int i = 0; i < 33 * 33; ++i) { // on corners, edges and between them
        const glm::vec3 place{0.5f * static_cast<float>(i % 33 - 16),
                              0.5f * static_cast<float>(i / 33 - 16), -4};
        s.points.push_back({place, 0, {0, 0, 1}, 0});
    }
    ray_bundle bundle;
    bundle.centre = {0, 0, 0, 8};
    bundle.right.w = 0;
    bundle.up.w = 1;
    bundle.direction.w = 16;
    EXPECT_EQ(check(s, bundle), 33u * 33u); // none slips through
}

TEST_P(resolving, holes_are_seen_through) {
    scene s;
    for (std::uint32_t i = 0; i < 500; ++i) {
        s.add_triangle(2, 3);
        s.surfaces.back().alpha = i % 3; // 0: none; two kinds
    }
    s.alpha.resize(24);
    for (std::uint32_t n = 0; n < 2; ++n) {
        const alpha_coordinates c{{0, 0}, {2, 0}, {0, 3}, 24 + 12 * n, 4 + (3u << 16), 0.5f, {}};
        std::memcpy(s.alpha.data() + 12 * n, &c, sizeof c);
        for (std::uint32_t i = 0; i < 12; ++i) {
            s.alpha.push_back(std::bit_cast<std::uint32_t>((i * 7 + n) % 3 == 0 ? 1.0f : 0.0f));
        }
    }
    s.add_points(2000, 2);
    const ray_bundle bundle = bundle_of(s, 32, {1, 2, 3});
    check(s, bundle);
    const auto with = resolve(s, bundle);
    s.alpha.clear();
    for (gather_triangle& t : s.surfaces) {
        t.alpha = 0;
    }
    const auto without = resolve(s, bundle);
    std::size_t through = 0;
    for (std::size_t i = 0; i < with.size(); ++i) {
        through += with[i].distance > without[i].distance ? 1 : 0;
    }
    EXPECT_GT(through, 200u);
}

TEST_P(resolving, crowds_are_looked_at_in_several_passes) {
    // 9,000 triangles around one line, in two grids, and equal ones, of which the first counts.
    scene s;
    for (std::uint32_t i = 0; i < 9000; ++i) {
        const float z = 1 + static_cast<float>((i * 7919) % 4500) / 4500;
        const float size = i % 2 == 0 ? 0.01f : 1.0f;
        s.surfaces.push_back({{-size, -size, z}, 0, {size, -size, z}, 0, {0, size, z}, 0});
    }
    s.add_triangle(50, 0.1f);
    for (std::uint32_t i = 0; i < 200; ++i) {
        const float x = 0.01f * (s.random.unit() - 0.5f), y = 0.01f * (s.random.unit() - 0.5f);
        s.points.push_back(
            {{x, y, i % 2 == 0 ? 0.0f : 3.0f}, 0, {0, 0, i % 2 == 0 ? 1.0f : -1.0f}, 0});
    }
    EXPECT_GT(check(s, bundle_of(s, 64, {0, 0, 1})), 190u);
}

TEST_P(resolving, neighbours_in_crowds_of_different_grids) {
    // Invocations that run as one wait for each other in each grid, so that their turns add up.
    scene s;
    const float places[] = {-50, -30, -10, 10, 30};
    for (std::uint32_t i = 0; i < 5 * 7000; ++i) {
        const float z = 1 + static_cast<float>((i * 7919) % 35000) / 35000;
        const float size = 0.05f * std::exp2(2 * static_cast<float>(i % 5));
        const float x = places[i % 5];
        s.surfaces.push_back({{x - size, -size, z}, 0, {x + size, -size, z}, 0, {x, size, z}, 0});
    }
    for (std::uint32_t i = 0; i < 64; ++i) {
        s.points.push_back(
            {{places[i % 5], 0, i < 32 ? 0.0f : 3.0f}, 0, {0, 0, i < 32 ? 1.0f : -1.0f}, 0});
    }
    EXPECT_EQ(check(s, bundle_of(s, 2048, {0, 0, 1})), 64u);
}

TEST_P(resolving, composed_neighbours_of_one_crowd_add_up_no_turns) {
    // The crowd is in the first, second or third row of cells around a sample: 120,000 turns, were
    // the rows looped over one after the other by all that run as one.
    scene s;
    const std::uint32_t crowd = 40000;
    for (std::uint32_t i = 0; i < crowd; ++i) {
        const float z = 1 + static_cast<float>((i * 7919) % crowd) / crowd;
        s.surfaces.push_back({{-1.1f, -1.1f, z}, 0, {1.1f, -1.1f, z}, 0, {0, 1.2f, z}, 0});
    }
    s.surfaces.push_back({{-64, -64, 5}, 0, {64, -64, 5}, 0, {0, 64, 5}, 0});
    for (int i = 0; i < 64; ++i) {
        s.points.push_back(
            {{0.01f * static_cast<float>(i % 8), 1.1f * static_cast<float>(i % 3 - 1), 0},
             0,
             {0, 0, 1},
             0});
    }
    gather::resolver_options options;
    options.route = gather::resolve_route::composed;
    options.cells = 128;
    auto resolver =
        must(gather::bundle_resolver<device>::create(gpu(), s.surfaces.size(), options));
    const ray_bundle bundle = bundle_of(s, 128, {0, 0, 1});
    const auto surfaces = upload(gpu(), s.surfaces);
    const auto points = upload(gpu(), s.points);
    const auto hits = must(gpu().create_buffer(64 * sizeof(gather_hit)));
    go(gpu(), [&](auto& r) {
        resolver.record(r, bundle,
                        {view<device>(surfaces), {}, view<device>(points), view<device>(hits)});
    });
    const auto expected = by_looking_at_all(s, bundle);
    const auto got = download<gather_hit>(gpu(), hits, 64);
    for (std::size_t i = 0; i < 64; ++i) {
        EXPECT_EQ(got[i].surface, expected[i].surface) << i;
        EXPECT_EQ(got[i].distance, expected[i].distance) << i;
    }
}

TEST_P(resolving, bad_triangles_and_samples_meet_nothing) {
    const float none = std::numeric_limits<float>::quiet_NaN();
    const float far = std::numeric_limits<float>::infinity();
    scene s;
    for (std::uint32_t i = 0; i < 300; ++i) {
        s.add_triangle(2, 1);
    }
    s.add_points(500, 2);
    const ray_bundle bundle = bundle_of(s, 16, {3, 1, -1});
    for (std::uint32_t i = 0; i < 300; i += 10) {
        gather_triangle& t = s.surfaces[i];
        (i % 20 == 0 ? t.a : t.c)[i % 3] = i % 30 == 0 ? far : none;
        s.surfaces[i + 1].c = s.surfaces[i + 1].b;                                      // a line
        s.surfaces[i + 2].b = s.surfaces[i + 2].c = s.surfaces[i + 2].a;                // a point
        s.surfaces[i + 3].b = s.surfaces[i + 3].a + 2.0f * glm::vec3(bundle.direction); // on edge
    }
    s.points[7].position.x = none;
    s.points[8].position.y = far;
    s.points[9].normal.z = none;
    check(s, bundle);
}

TEST_P(resolving, nothing_to_look_at_is_nothing_met) {
    scene s;
    s.add_points(100, 1);
    EXPECT_EQ(check(s, bundle_of(s, 1, {0, 1, 0})), 0u);
    s.points.clear();
    s.add_triangle(1, 1);
    EXPECT_EQ(check(s, bundle_of(s, 1, {0, 1, 0})), 0u);
}

TEST_P(resolving, more_triangles_than_a_list_can_number) {
    scene s;
    for (std::uint32_t i = 0; i < (1u << 18) + 5000; ++i) {
        s.add_triangle(10, 0.3f);
    }
    s.add_points(32, 10);
    EXPECT_GT(check(s, bundle_of(s, 512, {1, 1, 1})), 20u);
}

TEST_P(resolving, stays_within_its_buffers_slow) {
    scene s;
    for (std::uint32_t i = 0; i < 300; ++i) {
        s.add_triangle(2, i % 9 == 0 ? 3.0f : 0.2f);
    }
    s.surfaces[7].a.x = std::numeric_limits<float>::quiet_NaN();
    s.add_points(100, 3);
    vulkan::headless_options o = options();
    o.gpu_assisted = true;
    log other;
    o.sink = other.sink();
    {
        auto checked = must(vulkan::headless::create(std::move(o)));
        device& d = checked.device();
        const auto points = upload(d, s.points);
        const auto hits = must(d.create_buffer(100 * sizeof(gather_hit)));
        for (const std::size_t count : {std::size_t{0}, std::size_t{1}, s.surfaces.size()}) {
            const auto surfaces =
                upload(d, triangles(s.surfaces.begin(),
                                    s.surfaces.begin() + static_cast<std::ptrdiff_t>(count)));
            const bundle_work<device> work{
                view<device>(surfaces), {}, view<device>(points), view<device>(hits)};
            go(d, [&](auto& r) { r.resolve(bundle_of(s, 16, {1, 2, 3}), work); });
        }
    }
    // The layer says that it is slow, and what it turned on: those are no findings.
    for (const std::string& m : other.messages) {
        EXPECT_EQ(m.find("out of bounds"), std::string::npos) << m;
        EXPECT_EQ(m.find("VUID"), std::string::npos) << m;
    }
}

TEST_P(resolving, twice_in_one_recorder) {
    scene s;
    for (std::uint32_t i = 0; i < 1000; ++i) {
        s.add_triangle(2, 0.5f);
    }
    s.add_points(400, 2);
    const auto surfaces = upload(gpu(), s.surfaces);
    const auto points = upload(gpu(), s.points);
    const ray_bundle bundles[] = {bundle_of(s, 32, {1, 0, 0}), bundle_of(s, 16, {-1, 2, 1})};
    const auto one = must(gpu().create_buffer(400 * 16));
    const auto two = must(gpu().create_buffer(400 * 16));
    go(gpu(), [&](auto& r) {
        r.resolve(bundles[0],
                  {view<device>(surfaces), {}, view<device>(points), view<device>(one)});
        r.resolve(bundles[1],
                  {view<device>(surfaces), {}, view<device>(points), view<device>(two)});
    });
    const auto expected_one = by_looking_at_all(s, bundles[0]);
    const auto expected_two = by_looking_at_all(s, bundles[1]);
    const auto got_one = download<gather_hit>(gpu(), one, 400);
    const auto got_two = download<gather_hit>(gpu(), two, 400);
    EXPECT_EQ(std::memcmp(got_one.data(), expected_one.data(), 400 * 16), 0);
    EXPECT_EQ(std::memcmp(got_two.data(), expected_two.data(), 400 * 16), 0);
}

} // namespace
} // namespace skybark::testing
