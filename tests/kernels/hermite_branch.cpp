// The branch kernel's vertices, forms and orientation, segment by segment.

#include <skybark/kernels/branch_cap.hpp>
#include <skybark/kernels/hermite_branch.hpp>
#include <skybark/kernels/unit_polygon.hpp>

#include "support/closed_surface.hpp"
#include "support/random.hpp"

#include <algorithm>
#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;
using glm::dvec4;
using glm::vec3;
using kernels::branch_frame;
using kernels::hermite_branch;

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr branch_frame both_frames[] = {branch_frame::slerp, branch_frame::rotation_minimising};

struct collect {
    std::vector<surface_vertex>* to;
    void operator()(const surface_vertex& v) const { to->push_back(v); }
};

/// One segment, its ends and its polygon.
struct one_branch {
    hermite_branch kernel;
    branch_end a, b;
    std::uint32_t caps = cap_start | cap_end;

    [[nodiscard]] std::vector<branch_segment> segments() const { return {{0, 1, caps, 0}}; }
    [[nodiscard]] std::vector<branch_end> ends() const { return {a, b}; }

    [[nodiscard]] std::vector<surface_vertex> rings() const {
        return ring_part(0, kernel.ring_vertices());
    }
    [[nodiscard]] std::vector<surface_vertex> ring_part(std::uint32_t first,
                                                        std::uint32_t count) const {
        std::vector<surface_vertex> made;
        const auto s = segments();
        const auto e = ends();
        const auto corners = kernels::unit_polygon(kernel.sides);
        kernel.ring(0, first, count, collect{&made}, s, e, corners);
        return made;
    }
    /// The corners of the list's triangles, strip by strip, as the contract puts them together.
    [[nodiscard]] std::vector<surface_vertex> list(std::uint32_t first_strip,
                                                   std::uint32_t last_strip) const {
        std::vector<surface_vertex> made;
        const auto s = segments();
        const auto e = ends();
        const auto corners = kernels::unit_polygon(kernel.sides);
        for (std::uint32_t strip = first_strip; strip < last_strip; ++strip) {
            const std::uint32_t triangles = kernel.triangles(0, strip, s, e, corners);
            if (triangles == 0) {
                continue;
            }
            std::vector<surface_vertex> run;
            kernel.strip(0, strip, 0, triangles + 2, collect{&run}, s, e, corners);
            for (std::uint32_t t = 0; t < triangles; ++t) {
                made.push_back(run[t + t % 2]);
                made.push_back(run[t + 1 - t % 2]);
                made.push_back(run[t + 2]);
            }
        }
        return made;
    }
};

branch_end end_at(dvec3 position, dvec4 orientation, double radius) {
    branch_end e;
    e.position = vec3(position);
    e.orientation = glm::vec4(orientation);
    e.radius = static_cast<float>(radius);
    return e;
}

one_branch random_branch(support::random_source& random, std::uint32_t sides, std::uint32_t rings,
                         branch_frame frame) {
    const dvec4 q = random.rotation(pi);
    const dvec4 turn(glm::vec4(random.rotation(0.6)));
    const dvec3 u(turn), v(q);
    const dvec4 r(turn.w * v + q.w * u + glm::cross(u, v), turn.w * q.w - glm::dot(u, v));
    one_branch branch{{sides, rings, frame}, end_at({1, 2, 3}, q, 0.2), end_at({}, r, 0.1)};
    branch.b.position = branch.a.position + shared::quaternion_y(branch.a.orientation) +
                        shared::quaternion_y(branch.b.orientation) * 0.9f;
    branch.a.path = 1.5f;
    branch.b.path = 3.5f;
    branch.a.slope = -0.05f;
    branch.b.slope = -0.1f;
    return branch;
}

std::vector<std::uint32_t> counted_up(std::size_t n) {
    std::vector<std::uint32_t> indices(n);
    for (std::size_t i = 0; i < n; ++i) {
        indices[i] = static_cast<std::uint32_t>(i);
    }
    return indices;
}

/// (area of the unit polygon) · length / 3 · (r1² + r1 r2 + r2²)
double frustum(std::uint32_t sides, double length, double r1, double r2) {
    return sides / 2.0 * std::sin(2 * pi / sides) * length / 3 * (r1 * r1 + r1 * r2 + r2 * r2);
}

bool equal_bits(const surface_vertex& a, const surface_vertex& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

} // namespace

TEST(hermite_branch, list_is_the_rings_gathered_by_their_indices) {
    support::random_source random(1);
    for (const branch_frame frame : both_frames) {
        for (const std::uint32_t sides : {3u, 4u, 8u, 17u}) {
            for (const std::uint32_t rings : {2u, 3u, 4u, 9u}) {
                const one_branch branch = random_branch(random, sides, rings, frame);
                const auto ring = branch.rings();
                const auto list = branch.list(1, rings); // the caps are strips 0 and `rings`
                ASSERT_EQ(ring.size(), branch.kernel.ring_vertices());
                ASSERT_EQ(list.size(), 3 * branch.kernel.ring_triangles());
                for (std::uint32_t k = 0; k < list.size(); ++k) {
                    ASSERT_TRUE(equal_bits(list[k], ring[branch.kernel.ring_index(k)])) << k;
                }
            }
        }
    }
}

TEST(hermite_branch, any_part_of_the_rings_is_that_part) {
    support::random_source random(2);
    for (const branch_frame frame : both_frames) {
        const one_branch branch = random_branch(random, 5, 4, frame);
        const auto all = branch.rings();
        for (std::uint32_t first = 0; first <= all.size(); ++first) {
            for (std::uint32_t count = 0; first + count <= all.size(); ++count) {
                const auto part = branch.ring_part(first, count);
                ASSERT_EQ(part.size(), count);
                for (std::uint32_t i = 0; i < count; ++i) {
                    ASSERT_TRUE(equal_bits(part[i], all[first + i]));
                }
            }
        }
    }
}

// Any part of a strip, too: a geometry shader draws long strips in parts.
TEST(hermite_branch, any_part_of_a_strip_is_that_part) {
    support::random_source random(3);
    const one_branch branch = random_branch(random, 7, 3, branch_frame::slerp);
    const auto s = branch.segments();
    const auto e = branch.ends();
    const auto corners = kernels::unit_polygon(7);
    for (std::uint32_t strip = 0; strip < branch.kernel.strips(); ++strip) {
        const std::uint32_t n = branch.kernel.triangles(0, strip, s, e, corners) + 2;
        std::vector<surface_vertex> all;
        branch.kernel.strip(0, strip, 0, n, collect{&all}, s, e, corners);
        ASSERT_EQ(all.size(), n);
        for (std::uint32_t first = 0; first < n; ++first) {
            std::vector<surface_vertex> part;
            branch.kernel.strip(0, strip, first, n - first, collect{&part}, s, e, corners);
            ASSERT_EQ(part.size(), n - first);
            for (std::uint32_t i = 0; i < part.size(); ++i) {
                ASSERT_TRUE(equal_bits(part[i], all[first + i]));
            }
        }
    }
}

TEST(hermite_branch, straight_capped_tube_has_the_volume_of_a_frustum) {
    support::random_source random(4);
    for (const branch_frame frame : both_frames) {
        for (const std::uint32_t sides : {3u, 8u, 17u, 64u}) {
            for (const double tip : {0.3, 0.1, 0.0}) {
                const dvec4 q = random.rotation(pi);
                one_branch branch{
                    {sides, 5, frame}, end_at({-2, 1, 4}, q, 0.3), end_at({}, q, tip)};
                const vec3 up = shared::quaternion_y(branch.a.orientation);
                branch.b.position = branch.a.position + up * 2.0f;
                const auto list = branch.list(0, branch.kernel.strips());
                const double volume = support::signed_volume(list, counted_up(list.size()));
                EXPECT_NEAR(volume, frustum(sides, 2, 0.3, tip), 1e-5) << sides << ' ' << tip;
            }
        }
    }
}

TEST(hermite_branch, bent_capped_tube_is_closed_and_faces_outwards) {
    support::random_source random(5);
    for (const branch_frame frame : both_frames) {
        for (int i = 0; i < 200; ++i) {
            const one_branch branch =
                random_branch(random, 3 + random.below(12), 2 + random.below(7), frame);
            const auto list = branch.list(0, branch.kernel.strips());
            const auto indices = counted_up(list.size());
            const auto edges = support::count_edges(support::weld(list), indices);
            ASSERT_EQ(edges.open, 0u);
            ASSERT_EQ(edges.degenerate_triangles, 0u);
            // Within its bounds: 2 m long or so, 0.1 to 0.2 m thick.
            const double volume = support::signed_volume(list, indices);
            ASSERT_GT(volume, 1.2 * frustum(3, 1.4, 0.1, 0.2) * 0.8);
            ASSERT_LT(volume, pi * 2.1 * 0.2 * 0.2);
        }
    }
}

TEST(hermite_branch, caps_are_there_where_they_are_asked_for) {
    support::random_source random(6);
    one_branch branch = random_branch(random, 6, 3, branch_frame::slerp);
    for (std::uint32_t caps = 0; caps < 4; ++caps) {
        branch.caps = caps;
        EXPECT_EQ(branch.list(0, 1).size(), (caps & cap_start) != 0 ? 12u : 0u);
        EXPECT_EQ(branch.list(3, 4).size(), (caps & cap_end) != 0 ? 12u : 0u);
    }
}

// As rings and as a list: the same caps.
TEST(hermite_branch, branch_cap_makes_the_lists_caps) {
    support::random_source random(7);
    for (const std::uint32_t sides : {3u, 4u, 5u, 8u, 33u}) {
        const one_branch branch = random_branch(random, sides, 3, branch_frame::slerp);
        const kernels::branch_cap cap{sides};
        const auto e = branch.ends();
        const auto corners = kernels::unit_polygon(sides);
        for (const bool base : {true, false}) {
            const std::vector<std::uint32_t> caps{base ? 1u : 2u}; // 2 · end, + 1 at a start
            std::vector<surface_vertex> ring;
            cap.ring(0, 0, cap.ring_vertices(), collect{&ring}, caps, e, corners);
            const auto list = base ? branch.list(0, 1) : branch.list(3, 4);
            ASSERT_EQ(list.size(), 3 * cap.ring_triangles());
            for (std::uint32_t k = 0; k < list.size(); ++k) {
                ASSERT_TRUE(equal_bits(list[k], ring[cap.ring_index(k)])) << k;
            }
        }
    }
}

// Each triangle is counter-clockwise along the cap's normal, and together they are the polygon.
TEST(hermite_branch, caps_are_the_polygon_facing_outwards) {
    support::random_source random(8);
    for (const std::uint32_t sides : {3u, 4u, 5u, 8u, 33u}) {
        const one_branch branch = random_branch(random, sides, 2, branch_frame::slerp);
        for (const bool base : {true, false}) {
            const branch_end& end = base ? branch.a : branch.b;
            const dvec3 out = (base ? -1.0 : 1.0) * dvec3(shared::quaternion_y(end.orientation));
            const auto list = base ? branch.list(0, 1) : branch.list(2, 3);
            double area = 0;
            for (std::size_t k = 0; k < list.size(); k += 3) {
                const dvec3 p(list[k].position);
                const dvec3 face =
                    glm::cross(dvec3(list[k + 1].position) - p, dvec3(list[k + 2].position) - p);
                ASSERT_GT(glm::dot(face, out), 0);
                area += glm::dot(face, out) / 2;
                ASSERT_NEAR(glm::dot(dvec3(list[k].normal), out), 1, 1e-6);
            }
            const double polygon = sides / 2.0 * std::sin(2 * pi / sides);
            EXPECT_NEAR(area, polygon * double{end.radius} * double{end.radius}, 1e-6);
        }
    }
}

TEST(hermite_branch, normals_are_unit_and_across_the_tangents) {
    support::random_source random(9);
    for (const branch_frame frame : both_frames) {
        for (int i = 0; i < 500; ++i) {
            const one_branch branch = random_branch(random, 9, 5, frame);
            for (const surface_vertex& v : branch.list(0, branch.kernel.strips())) {
                const dvec3 n(v.normal);
                const dvec3 t(v.tangent);
                ASSERT_NEAR(glm::length(n), 1, 2e-6);
                ASSERT_NEAR(glm::length(t), 1, 2e-6);
                ASSERT_NEAR(glm::dot(n, t), 0, 2e-6);
                ASSERT_EQ(std::abs(v.tangent.w), 1);
            }
        }
    }
}

// A cone: its normal is known, and leans with the change of radius.
TEST(hermite_branch, normals_of_a_cone) {
    one_branch branch{{12, 5, branch_frame::slerp},
                      end_at({0, 0, 0}, {0, 0, 0, 1}, 0.5),
                      end_at({0, 2, 0}, {0, 0, 0, 1}, 0.25)};
    branch.a.slope = branch.b.slope = -0.125f;
    for (const surface_vertex& v : branch.rings()) {
        const dvec3 p(v.position);
        const double r = std::hypot(p.x, p.z);
        // F = r − (0.5 − y / 8) is zero on the cone; its gradient is (x/r, 1/8, z/r).
        EXPECT_NEAR(r, 0.5 - p.y / 8, 1e-6);
        const dvec3 gradient = glm::normalize(dvec3(p.x / r, 0.125, p.z / r));
        EXPECT_LE(glm::length(dvec3(v.normal) - gradient), 1e-6);
    }
}

// The tangent points where u grows and w · n × t where v does, on the tube and on both caps.
TEST(hermite_branch, tangents_follow_the_texture) {
    support::random_source random(10);
    one_branch branch{{64, 3, branch_frame::slerp},
                      end_at({0, 0, 0}, {0, 0, 0, 1}, 0.5),
                      end_at({0, 2, 0}, {0, 0, 0, 1}, 0.5)};
    branch.b.path = 2;
    const auto list = branch.list(0, branch.kernel.strips());
    for (std::size_t k = 0; k < list.size(); k += 3) {
        // Positions are linear in u and v over a triangle: solve for their derivatives.
        const dvec3 e1 = dvec3(list[k + 1].position) - dvec3(list[k].position);
        const dvec3 e2 = dvec3(list[k + 2].position) - dvec3(list[k].position);
        const double u1 = list[k + 1].u - list[k].u, u2 = list[k + 2].u - list[k].u;
        const double v1 = list[k + 1].v - list[k].v, v2 = list[k + 2].v - list[k].v;
        const double area = u1 * v2 - u2 * v1;
        ASSERT_NE(area, 0);
        const dvec3 along_u = (e1 * v2 - e2 * v1) / area;
        const dvec3 along_v = (e2 * u1 - e1 * u2) / area;
        for (std::size_t i = k; i < k + 3; ++i) {
            const dvec3 t(list[i].tangent);
            const dvec3 b =
                glm::cross(dvec3(list[i].normal), t) * static_cast<double>(list[i].tangent.w);
            // A facet is up to half a side, 2.8 degrees, off the round surface.
            ASSERT_GT(glm::dot(t, glm::normalize(along_u)), 0.99);
            ASSERT_GT(glm::dot(b, glm::normalize(along_v)), 0.99);
        }
    }
}

TEST(hermite_branch, texture_goes_once_around_and_counts_metres_along) {
    support::random_source random(11);
    const one_branch branch = random_branch(random, 8, 5, branch_frame::slerp);
    const auto ring = branch.rings();
    for (std::uint32_t k = 0; k < 5; ++k) {
        for (std::uint32_t c = 0; c <= 8; ++c) {
            EXPECT_EQ(ring[k * 9 + c].u, static_cast<float>(c) / 8);
            EXPECT_NEAR(ring[k * 9 + c].v, 1.5 + 2 * k / 4.0, 1e-6);
        }
        EXPECT_EQ(ring[k * 9].position, ring[k * 9 + 8].position);
    }
}

// First and last ring belong to the ends alone, so that neighbours meet without a gap.
TEST(hermite_branch, end_rings_depend_on_that_end_alone) {
    support::random_source random(12);
    for (const branch_frame frame : both_frames) {
        for (int i = 0; i < 500; ++i) {
            const one_branch first = random_branch(random, 5, 4, frame);
            one_branch second = random_branch(random, 5, 6, frame);
            second.a = first.b;
            if (i % 2 == 1) {
                // The same rotation with the other sign, as a long way round is made a short one.
                second.b.orientation = -second.b.orientation;
            }
            const auto above = first.rings();
            const auto below = second.rings();
            for (std::uint32_t c = 0; c < 6; ++c) {
                const surface_vertex& a = above[3 * 6 + c];
                const surface_vertex& b = below[c];
                ASSERT_EQ(a.position, b.position);
                ASSERT_EQ(a.normal, b.normal);
                ASSERT_EQ(a.tangent, b.tangent);
                ASSERT_EQ(a.v, b.v);
            }
        }
    }
}

// Ends that are twisted against each other: the rings of a rotation-minimising frame turn evenly.
TEST(hermite_branch, twist_is_spread_evenly) {
    for (const double twist : {0.0, 0.5, -1.2, 2.5}) {
        one_branch branch{{3, 9, branch_frame::rotation_minimising},
                          end_at({0, 0, 0}, {0, 0, 0, 1}, 1),
                          end_at({0, 2, 0}, {0, std::sin(twist / 2), 0, std::cos(twist / 2)}, 1)};
        const auto ring = branch.rings();
        for (std::uint32_t k = 0; k < 9; ++k) {
            const dvec3 p(ring[k * 4].position); // the corner along x, turned about y
            EXPECT_NEAR(std::remainder(std::atan2(-p.z, p.x) - twist * k / 8, 2 * pi), 0, 1e-5)
                << twist << ' ' << k;
        }
    }
}

// A tenth of a millimetre of twig at the top of a tree: floats there are 2e-6 m apart.
TEST(hermite_branch, short_segments_turn_alike_wherever_they_are) {
    support::random_source random(14);
    for (const branch_frame frame : both_frames) {
        one_branch here = random_branch(random, 5, 8, frame);
        here.a.position = vec3(0);
        here.b.position = shared::quaternion_y(here.a.orientation) * 1e-4f;
        one_branch there = here;
        there.a.position += vec3(3, 30, -5);
        there.b.position += vec3(3, 30, -5);
        here.b.position = there.b.position - there.a.position; // as rounded there
        const auto near_by = here.rings();
        const auto far_off = there.rings();
        for (std::size_t i = 0; i < near_by.size(); ++i) {
            ASSERT_LE(glm::length(near_by[i].normal - far_off[i].normal), 1e-5f) << i;
            ASSERT_LE(glm::length(near_by[i].tangent - far_off[i].tangent), 1e-5f) << i;
        }
    }
}

TEST(hermite_branch, no_length_no_radius_no_turn) {
    support::random_source random(13);
    for (const branch_frame frame : both_frames) {
        one_branch branch = random_branch(random, 6, 5, frame);
        const auto expect_sound = [&](const char* what) {
            for (const surface_vertex& v : branch.list(0, branch.kernel.strips())) {
                for (int i = 0; i < 3; ++i) {
                    ASSERT_TRUE(std::isfinite(v.position[i])) << what;
                }
                ASSERT_NEAR(glm::length(v.normal), 1, 1e-5f) << what;
                ASSERT_NEAR(glm::length(vec3(v.tangent)), 1, 1e-5f) << what;
            }
        };
        const one_branch fine = branch;
        branch.a.radius = branch.b.radius = 0;
        expect_sound("no radius");
        branch = fine;
        branch.b.position = branch.a.position;
        expect_sound("no length");
        branch.a.radius = branch.b.radius = 0;
        expect_sound("neither");
        branch = fine;
        branch.b = branch.a;
        expect_sound("the same end twice");
        branch = fine;
        branch.b.orientation = -branch.a.orientation;
        expect_sound("no turn, the other sign");
        branch = fine;
        branch.a.orientation = {0, 0, 0, 1};
        branch.b.orientation = {1, 0, 0, 0};
        branch.b.position = branch.a.position + vec3(0, 1, 0);
        expect_sound("straight back");
    }
}
