// Ends, segments and caps of real, grown and impossible trees.

#include "support/test_trees.hpp"

#include <skybark/conformance/branch_reference.hpp>
#include <skybark/trees/branch_layout.hpp>

#include <gtest/gtest.h>
#include <set>

using namespace skybark;
using glm::dvec3;
using kernels::branch_frame;
using trees::branch_layout;
using trees::none;

namespace reference = skybark::conformance::reference;

namespace {

constexpr branch_frame both_frames[] = {branch_frame::slerp, branch_frame::rotation_minimising};

const std::vector<support::test_tree>& all_trees() {
    static const std::vector<support::test_tree> all = [] {
        auto trees = support::grown_trees();
        trees.push_back(support::scanned_tree());
        for (std::uint32_t seed = 1; seed <= 40; ++seed) {
            trees.push_back(support::wild_scan(seed));
        }
        return trees;
    }();
    return all;
}

trees::segment wood(glm::vec3 base, glm::vec3 tip, std::uint32_t parent, float radius) {
    trees::segment s;
    s.base = base;
    s.tip = tip;
    s.base_radius = radius;
    s.radius = radius;
    s.parent = parent;
    return s;
}

bool continues(const branch_layout& layout, const trees::skeleton& s, std::uint32_t i) {
    const std::uint32_t p = s.parent[i];
    return p != none && layout.segments[p].end == layout.segments[i].start;
}

} // namespace

TEST(branch_layout, every_segment_keeps_its_place) {
    for (const auto& [name, s] : all_trees()) {
        const branch_layout layout = trees::layout_branches(s, branch_frame::slerp);
        ASSERT_EQ(layout.segments.size(), s.size());
        for (std::uint32_t i = 0; i < s.size(); ++i) {
            const branch_end& end = layout.ends[layout.segments[i].end];
            // A segment no longer than its rounding has no length at all.
            const float rounding = 1e-6f * (1 + glm::length(end.position));
            ASSERT_LE(glm::distance(end.position, s.tip(i)), rounding) << name;
            ASSERT_EQ(end.radius, s.radius[i]) << name;
        }
    }
}

TEST(branch_layout, ends_are_sound) {
    for (const branch_frame frame : both_frames) {
        for (const auto& [name, s] : all_trees()) {
            const branch_layout layout = trees::layout_branches(s, frame);
            for (const branch_end& e : layout.ends) {
                ASSERT_NEAR(glm::length(e.orientation), 1, 1e-5f) << name;
                ASSERT_TRUE(std::isfinite(e.position.x + e.position.y + e.position.z)) << name;
                ASSERT_TRUE(e.radius >= 0 && e.path >= 0 && std::isfinite(e.path)) << name;
                ASSERT_LE(std::abs(e.slope), 2) << name;
            }
        }
    }
}

// Only a segment and its continuation share an end, and each end that is not shared has a cap.
TEST(branch_layout, chains_are_capped_where_they_end) {
    for (const branch_frame frame : both_frames) {
        for (const auto& [name, s] : all_trees()) {
            const branch_layout layout = trees::layout_branches(s, frame);
            std::vector<int> starts(layout.ends.size(), 0), ends(layout.ends.size(), 0);
            for (const branch_segment& segment : layout.segments) {
                ++starts[segment.start];
                ++ends[segment.end];
            }
            for (std::uint32_t i = 0; i < s.size(); ++i) {
                const branch_segment& segment = layout.segments[i];
                ASSERT_EQ(starts[segment.start], 1) << name << ' ' << i;
                ASSERT_EQ(ends[segment.end], 1) << name << ' ' << i;
                ASSERT_EQ((segment.caps & cap_start) != 0, ends[segment.start] == 0) << name << i;
                ASSERT_EQ((segment.caps & cap_end) != 0, starts[segment.end] == 0) << name << i;
                if (ends[segment.start] != 0) {
                    ASSERT_TRUE(continues(layout, s, i)) << name << ' ' << i;
                    ASSERT_EQ(s.continuation[s.parent[i]], i) << name;
                }
            }
        }
    }
}

// The derivative of the centreline never points against the chord.
TEST(branch_layout, no_centreline_turns_back) {
    for (const branch_frame frame : both_frames) {
        for (const auto& [name, s] : all_trees()) {
            const branch_layout layout = trees::layout_branches(s, frame);
            for (std::uint32_t i = 0; i < s.size(); ++i) {
                const branch_end& a = layout.ends[layout.segments[i].start];
                const branch_end& b = layout.ends[layout.segments[i].end];
                const dvec3 chord = dvec3(b.position) - dvec3(a.position);
                if (glm::length(chord) == 0) {
                    continue;
                }
                const reference::curve curve = reference::curve_of(a, b);
                for (int k = 0; k <= 64; ++k) {
                    ASSERT_GE(glm::dot(curve.direction(k / 64.0), chord), 0)
                        << name << ", segment " << i << ", t " << k / 64.0;
                }
            }
        }
    }
}

// A start that is not a root's is a ball inside of the parent, taken as a cone with round ends.
TEST(branch_layout, side_chains_start_inside_their_parents) {
    for (const branch_frame frame : both_frames) {
        for (const auto& [name, s] : all_trees()) {
            const branch_layout layout = trees::layout_branches(s, frame);
            for (std::uint32_t i = 0; i < s.size(); ++i) {
                const std::uint32_t p = s.parent[i];
                if (p == none || continues(layout, s, i)) {
                    continue;
                }
                const branch_end& start = layout.ends[layout.segments[i].start];
                const branch_end& a = layout.ends[layout.segments[p].start];
                const branch_end& b = layout.ends[layout.segments[p].end];
                const dvec3 axis = dvec3(b.position) - dvec3(a.position);
                const dvec3 from = dvec3(start.position) - dvec3(a.position);
                const double l2 = glm::dot(axis, axis);
                const double t = l2 > 0 ? std::clamp(glm::dot(from, axis) / l2, 0.0, 1.0) : 1;
                const double radius = double{a.radius} + (double{b.radius} - double{a.radius}) * t;
                // The start is rounded to a float of the tree's size.
                const double rounding = 1e-6 * (1 + glm::length(dvec3(start.position)));
                ASSERT_LE(glm::length(from - axis * t) + double{start.radius}, radius + rounding)
                    << name << ", segment " << i;
                ASSERT_NEAR(start.path, a.path + (b.path - a.path) * t, 1e-4) << name;
            }
        }
    }
}

TEST(branch_layout, path_adds_up_the_wood) {
    const branch_layout layout = trees::layout_branches(
        support::built({wood({0, 0, 0}, {0, 2, 0}, none, 0.2f), wood({0, 2, 0}, {0, 2, 1}, 0, 0.1f),
                        wood({0, 2, 1}, {0, 5, 5}, 1, 0.1f)}),
        branch_frame::slerp);
    std::multiset<float> paths;
    for (const branch_end& e : layout.ends) {
        paths.insert(std::round(e.path * 1000) / 1000);
    }
    EXPECT_EQ(paths, (std::multiset<float>{0, 2, 3, 8}));
}

TEST(branch_layout, joint_leans_half_way) {
    const branch_layout layout =
        trees::layout_branches(support::built({wood({0, 0, 0}, {0, 2, 0}, none, 0.02f),
                                               wood({0, 2, 0}, {2, 4, 0}, 0, 0.02f)}),
                               branch_frame::slerp);
    const dvec3 up =
        reference::turned(glm::dvec4(layout.ends[layout.segments[1].start].orientation), {0, 1, 0});
    EXPECT_LE(glm::length(up - dvec3(std::sin(0.3926991), std::cos(0.3926991), 0)), 1e-6);
    EXPECT_EQ(layout.segments[0].end, layout.segments[1].start);
}

TEST(branch_layout, straight_back_starts_anew) {
    const branch_layout layout =
        trees::layout_branches(support::built({wood({0, 0, 0}, {0, 2, 0}, none, 0.1f),
                                               wood({0, 2, 0}, {0.1f, 1, 0}, 0, 0.1f)}),
                               branch_frame::slerp);
    EXPECT_NE(layout.segments[0].end, layout.segments[1].start);
    EXPECT_EQ(layout.segments[0].caps, cap_start | cap_end);
    EXPECT_EQ(layout.segments[1].caps, cap_start | cap_end);
}

TEST(branch_layout, slope_of_a_cone) {
    auto cone = wood({0, 0, 0}, {0, 4, 0}, none, 0.5f);
    cone.radius = 0.25f;
    const branch_layout layout =
        trees::layout_branches(support::built({cone}), branch_frame::slerp);
    for (const branch_end& e : layout.ends) {
        EXPECT_NEAR(e.slope, -0.0625f, 1e-7f);
    }
}

TEST(branch_layout, nothing_of_nothing) {
    const branch_layout layout = trees::layout_branches({}, branch_frame::slerp);
    EXPECT_TRUE(layout.ends.empty());
    EXPECT_TRUE(layout.segments.empty());
}
