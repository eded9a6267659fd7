// Bundles that OpenGL resolves its own way: the bits of a plain loop over all triangles.

#include "support.hpp"

#include <skybark/gather/bundle.hpp>
#include <skybark/shared/alpha_map.hpp>
#include <skybark/shared/bundle.hpp>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

namespace skybark::opengl::tests {
namespace {

static_assert(resolves_bundles<gpu>);

constexpr gather_hit untouched{0.0f, 3, 0.5f, 0.5f};

/// Triangles, points that look around, and alpha maps.
struct scene {
    std::vector<gather_triangle> triangles;
    std::vector<gather_sample> samples;
    std::vector<std::uint32_t> alpha;
    std::mt19937 random{5};

    [[nodiscard]] float unit() { return std::ldexp(static_cast<float>(random() >> 8), -24); }
    [[nodiscard]] glm::vec3 anywhere(float reach) {
        const float x = unit();
        const float y = unit();
        return reach * (2.0f * glm::vec3(x, y, unit()) - 1.0f);
    }
    void add_triangle(float reach, float size) {
        gather_triangle t;
        t.a = anywhere(reach);
        t.b = t.a + anywhere(size);
        t.c = t.a + anywhere(size);
        triangles.push_back(t);
    }
    /// At corners, on edges, inside triangles, and elsewhere.
    void add_samples(std::uint32_t count, float reach) {
        for (std::uint32_t i = 0; i < count; ++i) {
            gather_sample s;
            s.position = anywhere(reach);
            s.normal = glm::normalize(anywhere(1) + glm::vec3(1e-3f));
            if (!triangles.empty() && i % 4 != 0) {
                const gather_triangle& t = triangles[random() % triangles.size()];
                const float u = i % 4 == 1 ? 0.0f : unit();
                const float v = i % 4 <= 2 ? 0.0f : (1.0f - u) * unit();
                s.position = t.a + u * (t.b - t.a) + v * (t.c - t.a);
            }
            samples.push_back(s);
        }
    }
    [[nodiscard]] ray_bundle bundle(glm::dvec3 axis, float lift = 1e-4f) const {
        gather::bounds box = gather::bounds_of(triangles);
        for (const gather_sample& s : samples) {
            box.add(s.position);
        }
        return gather::make_bundle(box, axis, 64, lift);
    }
    [[nodiscard]] bool is_hole(std::uint32_t number, float u, float v) const {
        if (number == 0) {
            return false;
        }
        alpha_coordinates at;
        std::memcpy(static_cast<void*>(&at), alpha.data() + 12 * (number - 1), sizeof at);
        const std::uint32_t width = at.size & 0xffffu;
        const std::uint32_t column =
            shared::alpha_texel(shared::alpha_place(at.a.x, at.b.x, at.c.x, u, v), width);
        const std::uint32_t row =
            shared::alpha_texel(shared::alpha_place(at.a.y, at.b.y, at.c.y, u, v), at.size >> 16);
        return std::bit_cast<float>(alpha[at.map + row * width + column]) < at.cutoff;
    }
    /// Every sample against every triangle, those of lower number first.
    [[nodiscard]] std::vector<gather_hit> look_at_all(const ray_bundle& bundle) const {
        std::vector<std::array<glm::vec3, 3>> corners;
        for (const gather_triangle& t : triangles) {
            corners.push_back({shared::across_bundle(bundle, t.a),
                               shared::across_bundle(bundle, t.b),
                               shared::across_bundle(bundle, t.c)});
        }
        std::vector<gather_hit> hits(samples.size());
        for (std::size_t i = 0; i < hits.size(); ++i) {
            const glm::vec3 origin =
                shared::across_bundle(bundle, shared::ray_origin(bundle, samples[i]));
            const float side = shared::side_of_bundle(bundle, samples[i].normal);
            for (std::uint32_t n = 0; n < corners.size(); ++n) {
                const auto met =
                    shared::meet_triangle(corners[n][0], corners[n][1], corners[n][2], origin.x,
                                          origin.y, shared::meeting_slack(bundle));
                const float distance = shared::distance_along(met, side, origin.z, bundle.right.w);
                if (distance >= 0 && distance < hits[i].distance &&
                    !is_hole(triangles[n].alpha, met.u, met.v)) {
                    hits[i] = {distance, 2 * n + (side * met.facing < 0 ? 0u : 1u), met.u, met.v};
                }
            }
        }
        return hits;
    }
};

class resolve_test : public device_test {
  protected:
    std::vector<gather_hit> resolve(const scene& s, const ray_bundle& bundle) {
        const std::size_t count = s.samples.size();
        const buffer triangles = make(s.triangles);
        const buffer samples = make(s.samples);
        const buffer alpha = make(s.alpha);
        const buffer hits = make(std::vector<gather_hit>(count + 32, untouched));
        run([&](recorder& r) {
            r.resolve(bundle, {view<gpu>(triangles), view<gpu>(alpha), view<gpu>(samples),
                               view<gpu, gather_hit>(hits, 16, count)});
        });
        const auto all = read<gather_hit>(hits, count + 32);
        for (std::size_t i = 0; i < 16; ++i) {
            EXPECT_EQ(all[i].surface, untouched.surface);
            EXPECT_EQ(all[count + 16 + i].surface, untouched.surface);
        }
        return {all.begin() + 16, all.end() - 16};
    }
    /// How many of the samples meet something, all being met as a plain loop meets them.
    std::size_t check(const scene& s, const ray_bundle& bundle) {
        auto expected = s.look_at_all(bundle);
        auto got = resolve(s, bundle);
        std::size_t met = 0;
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            expected[i].distance += 0.0f; // −0 and 0 are the same distance
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

TEST_F(resolve_test, triangles_of_all_sizes) {
    // Few samples and many: another grid.
    for (const std::uint32_t samples : {50u, 3000u}) {
        scene s;
        for (std::uint32_t i = 0; i < 1500; ++i) {
            s.add_triangle(10, i % 7 == 0 ? 8.0f : i % 3 == 0 ? 1.0f : 0.15f);
        }
        s.add_samples(samples, 11);
        for (const glm::dvec3 axis : {glm::dvec3(0.3, -0.5, 0.8), glm::dvec3(-1, 0.1, 0)}) {
            EXPECT_GT(check(s, s.bundle(axis)), samples / 3) << samples;
        }
    }
}

TEST_F(resolve_test, slivers_that_cross_many_cells) {
    scene s;
    for (std::uint32_t i = 0; i < 2000; ++i) {
        s.add_triangle(10, 4);
        gather_triangle& t = s.triangles.back();
        t.c = t.a + (t.b - t.a) * s.unit() + s.anywhere(i % 2 == 0 ? 1e-3f : 1e-6f);
    }
    s.add_samples(4000, 10);
    check(s, s.bundle({1, 2, 3}));
}

TEST_F(resolve_test, corners_and_edges_in_line_with_cells) {
    // Squares whose edges lie on those of cells, looked at along an axis.
    scene s;
    for (int y = -8; y < 8; ++y) {
        for (int x = -8; x < 8; ++x) {
            const auto at = [&](int i, int j) {
                return glm::vec3(x + i, y + j, (x * 5 + y * 3) & 3);
            };
            s.triangles.push_back({at(0, 0), 0, at(1, 0), 0, at(1, 1), 0});
            s.triangles.push_back({at(0, 0), 0, at(1, 1), 0, at(0, 1), 0});
        }
    }
    for (int i = 0; i < 65 * 65; ++i) {
        const glm::vec3 place{0.25f * static_cast<float>(i % 65 - 32),
                              0.25f * static_cast<float>(i / 65 - 32), -4};
        s.samples.push_back({place, 0, {0, 0, 1}, 0});
    }
    ray_bundle bundle;
    bundle.centre = {0, 0, 0, 8};
    EXPECT_EQ(check(s, bundle), 65u * 65u); // none slips through
}

TEST_F(resolve_test, beyond_the_bundle) {
    // The bundle's square is smaller than what is to be resolved.
    scene s;
    for (std::uint32_t i = 0; i < 1000; ++i) {
        s.add_triangle(10, i % 4 == 0 ? 5.0f : 1.0f);
    }
    s.add_samples(2000, 12);
    ray_bundle bundle = s.bundle({1, -1, 2});
    bundle.centre.w *= 0.4f;
    EXPECT_GT(check(s, bundle), 500u);
}

TEST_F(resolve_test, holes_are_seen_through) {
    scene s;
    for (std::uint32_t i = 0; i < 500; ++i) {
        s.add_triangle(2, 3);
        s.triangles.back().alpha = i % 3; // 0: none; two kinds
    }
    s.alpha.resize(24);
    for (std::uint32_t n = 0; n < 2; ++n) {
        const alpha_coordinates c{{0, 0}, {2, 0}, {0, 3}, 24 + 12 * n, 4 + (3u << 16), 0.5f, {}};
        std::memcpy(s.alpha.data() + 12 * n, &c, sizeof c);
        for (std::uint32_t i = 0; i < 12; ++i) {
            s.alpha.push_back(std::bit_cast<std::uint32_t>((i * 7 + n) % 3 == 0 ? 1.0f : 0.0f));
        }
    }
    s.add_samples(2000, 2);
    const ray_bundle bundle = s.bundle({1, 2, 3});
    check(s, bundle);
    const auto with = resolve(s, bundle);
    s.alpha.clear(); // no holes anywhere, whatever triangles say
    const auto without = resolve(s, bundle);
    std::size_t through = 0;
    for (std::size_t i = 0; i < with.size(); ++i) {
        through += with[i].distance > without[i].distance ? 1 : 0;
    }
    EXPECT_GT(through, 200u);
}

TEST_F(resolve_test, crowds_of_different_grids) {
    // More triangles in a cell than a pass looks at, the nearest last, and neighbours that look at
    // others: turns of loops add up where invocations run as one. Of equal ones the first counts.
    scene s;
    const float places[] = {-50, -30, -10, 10, 30};
    for (std::uint32_t i = 0; i < 5 * 18000; ++i) {
        const float off = static_cast<float>(i / 20 * 20) / 180000; // fours of equal ones
        const float z = i / 5 % 2 == 0 ? 1.5f - off : 1.5f + off;
        const float size = 0.05f * std::exp2(2 * static_cast<float>(i % 5));
        const float x = places[i % 5];
        s.triangles.push_back({{x - size, -size, z}, 0, {x + size, -size, z}, 0, {x, size, z}, 0});
    }
    for (std::uint32_t i = 0; i < 64; ++i) {
        const float side = i < 32 ? 1.0f : -1.0f;
        s.samples.push_back({{places[i % 5], 0, 1.5f - 1.5f * side}, 0, {0, 0, side}, 0});
    }
    EXPECT_EQ(check(s, s.bundle({0, 0, 1})), 64u);
}

TEST_F(resolve_test, bad_triangles_and_samples_meet_nothing) {
    const float nothing = std::numeric_limits<float>::quiet_NaN();
    const float far = std::numeric_limits<float>::infinity();
    scene s;
    for (std::uint32_t i = 0; i < 300; ++i) {
        s.add_triangle(2, 1);
    }
    s.add_samples(500, 2);
    const ray_bundle bundle = s.bundle({3, 1, -1});
    for (std::uint32_t i = 0; i < 300; i += 10) {
        gather_triangle& t = s.triangles[i];
        (i % 20 == 0 ? t.a : t.c)[static_cast<int>(i % 3)] = i % 30 == 0 ? far : nothing;
        s.triangles[i + 1].c = s.triangles[i + 1].b;
        s.triangles[i + 2].b = s.triangles[i + 2].c = s.triangles[i + 2].a;
        s.triangles[i + 3].b = s.triangles[i + 3].a + 2.0f * glm::vec3(bundle.direction);
    }
    s.samples[7].position.x = nothing;
    s.samples[8].position.y = far;
    s.samples[9].normal.z = nothing;
    check(s, bundle);
}

TEST_F(resolve_test, nothing_to_look_at_is_nothing_met) {
    scene s;
    s.add_samples(100, 1);
    EXPECT_EQ(check(s, s.bundle({0, 1, 0})), 0u);
    s.samples.clear();
    s.add_triangle(1, 1);
    EXPECT_EQ(check(s, s.bundle({0, 1, 0})), 0u);
}

TEST_F(resolve_test, more_triangles_than_a_slice_has_slow) {
    scene s;
    for (std::uint32_t i = 0; i < (1u << 20) + 5000; ++i) {
        s.add_triangle(10, 0.3f);
    }
    s.add_samples(32, 10);
    EXPECT_GT(check(s, s.bundle({1, 1, 1})), 20u);
}

TEST_F(resolve_test, twice_in_one_recorder) {
    scene s;
    for (std::uint32_t i = 0; i < 1000; ++i) {
        s.add_triangle(2, 0.5f);
    }
    s.add_samples(400, 2);
    const buffer triangles = make(s.triangles);
    const buffer samples = make(s.samples);
    const std::array<buffer, 2> hits{zeros(400 * 16), zeros(400 * 16)};
    const std::array<ray_bundle, 2> bundles{s.bundle({1, 0, 0}), s.bundle({-1, 2, 1})};
    run([&](recorder& r) {
        for (std::size_t i = 0; i < 2; ++i) {
            r.resolve(bundles[i],
                      {view<gpu>(triangles), {}, view<gpu>(samples), view<gpu>(hits[i])});
        }
    });
    for (std::size_t i = 0; i < 2; ++i) {
        const auto expected = s.look_at_all(bundles[i]);
        const auto got = read<gather_hit>(hits[i], 400);
        EXPECT_EQ(std::memcmp(got.data(), expected.data(), 400 * 16), 0);
    }
}

} // namespace
} // namespace skybark::opengl::tests
