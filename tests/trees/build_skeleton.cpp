#include <skybark/trees/build_skeleton.hpp>

#include "support/sample_qsm.hpp"

#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numeric>

using namespace skybark;
using trees::none;
using trees::segment;
using trees::skeleton;

namespace {

segment wood(glm::vec3 base, glm::vec3 tip, std::uint32_t parent, float radius = 0.1f) {
    segment s;
    s.base = base;
    s.tip = tip;
    s.base_radius = 2 * radius;
    s.radius = radius;
    s.parent = parent;
    return s;
}

skeleton built(const std::vector<segment>& segments) {
    auto s = trees::build_skeleton(segments);
    EXPECT_TRUE(s) << s.error().message;
    return s ? *std::move(s) : skeleton{};
}

std::string complaint(const std::vector<segment>& segments) {
    const auto s = trees::build_skeleton(segments);
    EXPECT_FALSE(s);
    if (s)
        return {};
    EXPECT_EQ(s.error().code, error_code::bad_input);
    return s.error().message;
}

::testing::AssertionResult has(const std::string& sentence, std::string_view part) {
    if (sentence.find(part) != std::string::npos)
        return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << '"' << sentence << "\" lacks \"" << part << '"';
}

/// Everything that is true of every skeleton, whatever it was built from.
void expect_invariants(const skeleton& s, const std::vector<segment>& from,
                       const std::vector<std::uint32_t>& input) {
    const std::size_t n = from.size();
    ASSERT_EQ(s.size(), n);
    ASSERT_EQ(input.size(), n);
    ASSERT_GE(s.levels.size(), 2u);
    EXPECT_EQ(s.levels.front(), 0u);
    EXPECT_EQ(s.levels.back(), n);
    std::vector<std::uint32_t> level(n);
    for (std::size_t l = 0; l + 1 < s.levels.size(); ++l) {
        EXPECT_LT(s.levels[l], s.levels[l + 1]);
        for (std::uint32_t i = s.levels[l]; i < s.levels[l + 1]; ++i)
            level[i] = static_cast<std::uint32_t>(l);
    }
    std::vector<int> used(n);
    for (std::size_t i = 0; i < n; ++i) {
        ++used[input[i]];
        const segment& own = from[input[i]];
        if (own.parent == none) {
            EXPECT_EQ(s.parent[i], none);
            EXPECT_EQ(level[i], 0u);
        } else {
            ASSERT_LT(s.parent[i], i);
            EXPECT_EQ(input[s.parent[i]], own.parent);
            EXPECT_EQ(level[i], level[s.parent[i]] + 1);
            const std::size_t p = s.parent[i];
            EXPECT_GE(i, s.first_child[p]);
            EXPECT_LT(i, s.first_child[p] + s.child_count[p]);
        }
        EXPECT_EQ(s.position[i], own.base);
        const double scale = 1 + std::abs(own.tip.x) + std::abs(own.tip.y) + std::abs(own.tip.z);
        EXPECT_LT(glm::length(s.tip(i) - own.tip), 1e-6 * scale) << i;
        EXPECT_NEAR(glm::length(s.orientation[i]), 1, 1e-6);
        if (s.continuation[i] != none) {
            EXPECT_EQ(s.parent[s.continuation[i]], i);
            EXPECT_EQ(s.base_radius[s.continuation[i]], s.radius[i]);
        }
    }
    EXPECT_EQ(std::count(used.begin(), used.end(), 1), static_cast<std::ptrdiff_t>(n));
    EXPECT_EQ(std::accumulate(s.child_count.begin(), s.child_count.end(), std::size_t{0}),
              n - s.levels[1]);
}

} // namespace

TEST(build_skeleton, empty) { EXPECT_TRUE(has(complaint({}), "at least one segment")); }

TEST(build_skeleton, sorts_children_first_input_into_levels) {
    //      3   1
    //       \ /
    //    0   4      0 is a root of its own, 2 the tree's
    //        |
    //        2
    const std::vector<segment> in{wood({9, 0, 0}, {9, 1, 0}, none), wood({0, 2, 0}, {1, 3, 0}, 4),
                                  wood({0, 0, 0}, {0, 1, 0}, none), wood({0, 2, 0}, {-1, 3, 0}, 4),
                                  wood({0, 1, 0}, {0, 2, 0}, 2)};
    std::vector<std::uint32_t> input;
    const auto s = trees::build_skeleton(in, &input);
    ASSERT_TRUE(s);
    EXPECT_EQ(input, (std::vector<std::uint32_t>{0, 2, 4, 1, 3}));
    EXPECT_EQ(s->parent, (std::vector<std::uint32_t>{none, none, 1, 2, 2}));
    EXPECT_EQ(s->levels, (std::vector<std::uint32_t>{0, 2, 3, 5}));
    EXPECT_EQ(s->first_child, (std::vector<std::uint32_t>{2, 2, 3, 5, 5}));
    EXPECT_EQ(s->child_count, (std::vector<std::uint32_t>{0, 1, 2, 0, 0}));
    expect_invariants(*s, in, input);
}

TEST(build_skeleton, holds_its_invariants_on_a_scan_in_any_order) {
    std::vector<segment> in;
    for (const auto& c : support::sample_cylinders())
        in.push_back(wood({c.start[0], c.start[2], -c.start[1]}, {c.end[0], c.end[2], -c.end[1]},
                          c.parent_id < 0 ? none : static_cast<std::uint32_t>(c.parent_id),
                          static_cast<float>(c.radius)));
    // shuffle by a stride that has no common factor with the count
    const std::size_t n = in.size();
    std::size_t stride = 101;
    while (std::gcd(stride, n) != 1)
        ++stride;
    std::vector<segment> shuffled(n);
    for (std::size_t i = 0; i < n; ++i) {
        segment s = in[i];
        if (s.parent != none)
            s.parent = static_cast<std::uint32_t>(s.parent * stride % n);
        shuffled[i * stride % n] = s;
    }
    for (const auto& order : {in, shuffled}) {
        std::vector<std::uint32_t> input;
        const auto s = trees::build_skeleton(order, &input);
        ASSERT_TRUE(s) << s.error().message;
        expect_invariants(*s, order, input);
    }
}

TEST(build_skeleton, root_turns_by_the_smallest_rotation) {
    const skeleton s = built({wood({0, 0, 0}, {2, 0, 0}, none)});
    EXPECT_EQ(s.length[0], 2.0f);
    // +Y to +X is a quarter turn about -Z
    EXPECT_NEAR(s.orientation[0].w, std::sqrt(0.5), 1e-6);
    EXPECT_NEAR(s.orientation[0].z, -std::sqrt(0.5), 1e-6);
    EXPECT_NEAR(s.orientation[0].x, 0, 1e-6);
    EXPECT_NEAR(s.orientation[0].y, 0, 1e-6);
}

TEST(build_skeleton, transports_frames_without_twist) {
    // A quarter turn about Z, then about X, then back about Y: parallel transport around an octant
    // of the sphere turns the frame by the octant's area, 90 degrees.
    std::vector<segment> in{wood({0, 0, 0}, {0, 1, 0}, none)};
    const auto follow = [&in](glm::vec3 direction) {
        const glm::vec3 from = in.back().tip;
        in.push_back(wood(from, from + direction, static_cast<std::uint32_t>(in.size() - 1)));
    };
    const auto arc = [&follow](glm::dvec3 a, glm::dvec3 b) {
        for (int i = 1; i <= 90; ++i) {
            const double t = i * 3.14159265358979 / 180;
            follow(glm::vec3(std::cos(t) * a + std::sin(t) * b));
        }
    };
    arc({0, 1, 0}, {1, 0, 0});
    arc({1, 0, 0}, {0, 0, 1});
    arc({0, 0, 1}, {0, 1, 0});
    const skeleton s = built(in);
    const glm::vec3 x = s.orientation.back() * glm::vec3(1, 0, 0);
    const glm::vec3 y = s.orientation.back() * glm::vec3(0, 1, 0);
    EXPECT_NEAR(y.y, 1, 1e-5);
    EXPECT_NEAR(x.x, 0, 1e-4);
    EXPECT_NEAR(std::abs(x.z), 1, 1e-4);
}

TEST(build_skeleton, child_pointing_back_turns_about_its_parents_x) {
    const skeleton s =
        built({wood({0, 0, 0}, {0, 1, 0}, none), wood({0, 1, 0}, {0, 0.5f, 0}, 0),
               wood({0, 0, 0}, {1, 0, 0}, none), wood({1, 0, 0}, {0.25f, 1e-9f, 0}, 2)});
    for (const std::size_t child : {std::size_t{2}, std::size_t{3}}) {
        const glm::quat& parent = s.orientation[s.parent[child]];
        const glm::vec3 before = parent * glm::vec3(1, 0, 0);
        const glm::vec3 after = s.orientation[child] * glm::vec3(1, 0, 0);
        EXPECT_LT(glm::length(before - after), 1e-6f);
        const glm::vec3 back = parent * glm::vec3(0, -1, 0);
        EXPECT_LT(glm::length(s.orientation[child] * glm::vec3(0, 1, 0) - back), 1e-6f);
        EXPECT_EQ(s.continuation[s.parent[child]], none);
    }
    const skeleton down = built({wood({0, 1, 0}, {0, 0, 0}, none)});
    EXPECT_NEAR(std::abs(down.orientation[0].x), 1, 1e-7);
}

TEST(build_skeleton, degenerate_lengths_and_radii) {
    const skeleton s =
        built({wood({0, 0, 0}, {0, 0, 0}, none, 0), wood({0, 0, 0}, {1, 0, 0}, 0, 0),
               wood({1, 0, 0}, {1, 0, 0}, 1, 0), wood({1, 0, 0}, {1, 1e-44f, 0}, 2)});
    EXPECT_EQ(s.orientation[0], glm::quat(1, 0, 0, 0));
    EXPECT_EQ(s.orientation[2], s.orientation[1]);
    EXPECT_EQ(s.length[2], 0.0f);
    EXPECT_EQ(s.continuation[1], 2u);
    EXPECT_NEAR((s.orientation[3] * glm::vec3(0, 1, 0)).y, 1, 1e-6);
}

TEST(build_skeleton, orientation_does_not_drift_along_a_chain) {
    std::vector<segment> in;
    glm::dvec3 at(0);
    for (std::uint32_t i = 0; i < 100'000; ++i) {
        const glm::dvec3 next =
            at + 0.01 * glm::dvec3(std::cos(0.1 * i), std::sin(0.013 * i), std::sin(0.1 * i));
        in.push_back(wood(glm::vec3(at), glm::vec3(next), i == 0 ? none : i - 1));
        at = next;
    }
    const skeleton s = built(in);
    double worst = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
        const glm::dvec3 chord = glm::dvec3(in[i].tip) - glm::dvec3(in[i].base);
        const glm::dvec3 up = glm::dquat(s.orientation[i]) * glm::dvec3(0, 1, 0);
        worst = std::max(worst, glm::length(up - glm::normalize(chord)));
    }
    EXPECT_LT(worst, 5e-7);
}

TEST(build_skeleton, continues_in_the_best_aligned_child) {
    const skeleton s =
        built({wood({0, 0, 0}, {0, 1, 0}, none), wood({0, 1, 0}, {1, 2, 0}, 0, 0.5f), // 45°, thick
               wood({0, 1, 0}, {0.1f, 2, 0}, 0),      // nearly straight
               wood({0, 1, 0}, {0.2f, 3, 0}, 0, 9)}); // as straight, longer, thicker
    EXPECT_EQ(s.continuation[0], 3u);
    EXPECT_EQ(s.base_radius[3], s.radius[0]);
    EXPECT_EQ(s.base_radius[1], 1.0f) << "a side branch keeps its own";
    EXPECT_EQ(s.base_radius[2], 0.2f);
}

TEST(build_skeleton, equal_children_fall_to_the_first) {
    const skeleton s = built({wood({0, 0, 0}, {0, 1, 0}, none), wood({0, 1, 0}, {-1, 2, 0}, 0),
                              wood({0, 1, 0}, {1, 2, 0}, 0)});
    EXPECT_EQ(s.continuation[0], 1u);
}

TEST(build_skeleton, continues_up_to_a_right_angle) {
    const auto turned = [](double degrees) {
        const double a = degrees * 3.14159265358979 / 180;
        const glm::dvec3 to(std::sin(a), 1 + std::cos(a), 0);
        return built({wood({0, 0, 0}, {0, 1, 0}, none), wood({0, 1, 0}, glm::vec3(to), 0)})
            .continuation[0];
    };
    EXPECT_EQ(turned(89.9), 1u);
    EXPECT_EQ(turned(90), 1u);
    EXPECT_EQ(turned(90.1), none);
    EXPECT_EQ(turned(180), none);
}

TEST(build_skeleton, a_branch_from_the_middle_never_continues) {
    const skeleton s = built({wood({0, 0, 0}, {0, 1, 0}, none), wood({0, 0.5f, 0}, {0, 2, 0}, 0)});
    EXPECT_EQ(s.continuation[0], none);
    const skeleton close = // a gap within the ring, as between fitted cylinders
        built({wood({0, 0, 0}, {0, 1, 0}, none), wood({0, 1.05f, 0}, {0, 2, 0}, 0)});
    EXPECT_EQ(close.continuation[0], 1u);
}

TEST(build_skeleton, names_the_segment_and_the_value) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    const segment good = wood({0, 0, 0}, {0, 1, 0}, none);
    const auto with = [&good](auto change) {
        segment s = good;
        change(s);
        return std::vector<segment>{good, s};
    };
    EXPECT_TRUE(has(complaint(with([&](segment& s) { s.base.y = nan; })),
                    "Segment 1 has the base (0, nan, 0)"));
    EXPECT_TRUE(has(complaint(with([&](segment& s) { s.tip.z = -infinity; })),
                    "Segment 1 has the tip (0, 1, -inf)"));
    EXPECT_TRUE(has(complaint(with([&](segment& s) { s.radius = -0.5f; })),
                    "Segment 1 has the radius -0.5"));
    EXPECT_TRUE(has(complaint(with([&](segment& s) { s.base_radius = nan; })),
                    "Segment 1 has the base radius nan"));
    EXPECT_TRUE(has(complaint(with([](segment& s) { s.parent = 2; })),
                    "Segment 1 has the parent 2, but there are only 2"));
    EXPECT_TRUE(has(complaint(with([](segment& s) { s.parent = 1; })), "Segment 1 is its own"));
    EXPECT_TRUE(has(complaint(with([](segment& s) {
                        s.tip.y = 3e38f;
                        s.base.y = -3e38f;
                    })),
                    "more than a float can hold"));
}

TEST(build_skeleton, names_the_segments_of_a_cycle) {
    std::vector<segment> in(6, wood({0, 0, 0}, {0, 1, 0}, none));
    in[1].parent = 0;
    in[2].parent = 4;
    in[3].parent = 2; // hangs from the cycle 2, 4, 5 but isn't on it
    in[4].parent = 5;
    in[5].parent = 2;
    const std::string sentence = complaint(in);
    EXPECT_TRUE(has(sentence, "Segments 2, 4, 5 are each other's ancestors"));
    std::vector<segment> ring(1000, in[0]);
    for (std::uint32_t i = 0; i < 1000; ++i)
        ring[i].parent = (i + 1) % 1000;
    EXPECT_LT(complaint(ring).size(), 200u);
}

TEST(build_skeleton, bounds_and_height) {
    const skeleton s =
        built({wood({0, 1, 0}, {0, 4, 0}, none, 0.5f), wood({0, 4, 0}, {3, 3.5f, 0}, 0, 0.25f)});
    const trees::bounding_box box = trees::bounds(s);
    EXPECT_NEAR(box.min.x, -1, 1e-6) << "the root's base radius is 1";
    EXPECT_NEAR(box.min.y, 0, 1e-6);
    EXPECT_NEAR(box.max.x, 3.25, 1e-6);
    EXPECT_NEAR(box.max.y, 4.5, 1e-6);
    EXPECT_NEAR(trees::height(s), 3, 1e-6);
    EXPECT_EQ(trees::height(skeleton{}), 0.0f);
    EXPECT_EQ(trees::bounds(skeleton{}).max, glm::vec3(0));
}

TEST(build_skeleton, a_chain_of_a_million_is_quick) {
    std::vector<segment> in(1'000'000, wood({0, 0, 0}, {0, 1, 0}, none));
    for (std::uint32_t i = 0; i + 1 < in.size(); ++i)
        in[i].parent = i + 1; // root last
    const auto begin = std::chrono::steady_clock::now();
    const skeleton s = built(in);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    EXPECT_EQ(s.levels.size(), in.size() + 1);
    EXPECT_LT(took.count(), 10.0);
}
