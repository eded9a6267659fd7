#pragma once
// Cases: the kernels that mesh branches, against a double-precision reference of their own.
//
// Tolerances: positions 1e-5 of the segment's size, directions 1e-3 rad, texture coordinates 1e-5.

#include <skybark/conformance/branch_reference.hpp>
#include <skybark/conformance/context.hpp>
#include <skybark/kernels/branch_cap.hpp>
#include <skybark/kernels/hermite_branch.hpp>

namespace skybark::conformance {

/// Segments with their ends, and the polygon that the kernels take.
struct branch_input {
    std::vector<branch_segment> segments;
    std::vector<branch_end> ends;
    std::vector<glm::vec4> corners;
    std::uint32_t sides;
};

[[nodiscard]] inline std::vector<glm::vec4> polygon_corners(std::uint32_t sides) {
    std::vector<glm::vec4> corners;
    for (std::uint32_t i = 0; i <= sides; ++i) {
        const double angle = 2 * reference::pi * (i % sides) / sides;
        corners.emplace_back(std::cos(angle), std::sin(angle), double(i) / sides, 0);
    }
    return corners;
}

template <backend B>
[[nodiscard]] glm::dvec4 random_quaternion(context<B>& c, double most_angle) {
    const auto unit = [&] { return c.below(20001) / 10000.0 - 1; };
    glm::dvec3 axis{unit(), unit(), unit()};
    axis = glm::dot(axis, axis) > 0 ? glm::normalize(axis) : glm::dvec3{1, 0, 0};
    const double half = most_angle / 2 * std::fabs(unit());
    return glm::dvec4(std::sin(half) * axis, std::cos(half));
}

/// The rotation q after p.
[[nodiscard]] inline glm::dvec4 composed(const glm::dvec4& q, const glm::dvec4& p) {
    const glm::dvec3 u(q);
    const glm::dvec3 v(p);
    return glm::dvec4(q.w * v + p.w * u + glm::cross(u, v), q.w * p.w - glm::dot(u, v));
}

/// Segments that grow roughly along their ends' directions and turn by up to 80 degrees.
template <backend B>
[[nodiscard]] branch_input random_branches(context<B>& c, std::uint32_t count,
                                           std::uint32_t sides) {
    branch_input in{{}, {}, polygon_corners(sides), sides};
    for (std::uint32_t i = 0; i < count; ++i) {
        const glm::dvec4 q = random_quaternion(c, reference::pi);
        glm::dvec4 turn = composed(random_quaternion(c, 1.4), q);
        if (c.below(2) == 1) {
            turn = -turn; // the same rotation: the arc must still be the short one
        }
        const glm::dvec3 p{c.below(1000) / 100.0, c.below(1000) / 100.0, c.below(1000) / 100.0};
        const double length = 0.01 + c.below(300) / 100.0;
        const glm::dvec3 growth =
            reference::turned(q, {0, 1, 0}) + reference::turned(turn, {0, 1, 0});
        branch_end a;
        a.position = glm::vec3(p);
        a.orientation = glm::vec4(q);
        a.radius = static_cast<float>(length * (1 + c.below(20)) / 100);
        a.path = static_cast<float>(c.below(100)) / 8;
        a.slope = static_cast<float>(c.below(100)) / 500 - 0.1f;
        branch_end b = a;
        b.position = glm::vec3(p + length * glm::normalize(growth));
        b.orientation = glm::vec4(turn);
        b.radius = a.radius * static_cast<float>(c.below(101)) / 100;
        b.path = a.path + static_cast<float>(length);
        b.slope = static_cast<float>(c.below(100)) / 500 - 0.1f;
        const auto first = static_cast<std::uint32_t>(in.ends.size());
        in.segments.push_back({first, first + 1, c.below(4), 0});
        in.ends.push_back(a);
        in.ends.push_back(b);
    }
    return in;
}

/// Compares one quantity of all vertices each.
template <backend B>
class surface_check {
  public:
    explicit surface_check(const context<B>& c)
        : positions_(c.compare("coordinates of positions")),
          directions_(c.compare("coordinates of normals and tangents")),
          texture_(c.compare("texture coordinates")) {}

    void vertex(const surface_vertex& actual, const reference::vertex& e, double size) {
        for (int k = 0; k < 3; ++k) {
            positions_.close_to(double{actual.position[k]}, e.position[k], 1e-5 * size);
            directions_.close_to(double{actual.normal[k]}, e.normal[k], 1e-3);
            directions_.close_to(double{actual.tangent[k]}, e.tangent[k], 1e-3);
        }
        directions_.close_to(double{actual.tangent.w}, e.handedness, 0);
        texture_.close_to(actual.u, e.u, 1e-5);
        texture_.close_to(actual.v, e.v, 1e-5 * size);
    }
    void spare(const surface_vertex& actual) {
        const surface_vertex zeros{};
        positions_.same(std::memcmp(&actual, &zeros, sizeof zeros), 0);
    }

  private:
    comparison positions_, directions_, texture_;
};

[[nodiscard]] inline double size_of(const branch_end& a, const branch_end& b) {
    const auto longest = [](const branch_end& e) {
        const glm::vec3 p = glm::abs(e.position);
        return double{std::max({p.x, p.y, p.z, e.radius, e.path})};
    };
    return std::max({1e-3, longest(a), longest(b)});
}

template <backend B>
struct branch_buffers {
    guarded<B> segments, ends, corners;

    [[nodiscard]] bindings<B, kernels::hermite_branch> views() const {
        return {segments.view(), ends.view(), corners.view()};
    }
};
template <backend B>
[[nodiscard]] branch_buffers<B> put_branches(const context<B>& c, const branch_input& in) {
    return {c.put(in.segments), c.put(in.ends), c.put(in.corners)};
}

template <backend B>
[[nodiscard]] std::vector<surface_vertex> ring_vertices(const context<B>& c, const branch_input& in,
                                                        const kernels::hermite_branch& kernel) {
    const auto count = static_cast<std::uint32_t>(in.segments.size());
    const auto buffers = put_branches(c, in);
    const auto out = c.template room<surface_vertex>(std::uint64_t{count} * kernel.ring_vertices());
    c.run([&](auto& r) { r.expand_rings(kernel, buffers.views(), range{0, count}, out.view()); });
    return c.template get<surface_vertex>(out);
}

template <backend B>
void branch_rings(context<B>& c, const branch_input& in, std::uint32_t rings,
                  kernels::branch_frame frame) {
    const auto actual = ring_vertices(c, in, {in.sides, rings, frame});
    const bool minimising = frame == kernels::branch_frame::rotation_minimising;
    surface_check check(c);
    std::size_t at = 0;
    for (const branch_segment& segment : in.segments) {
        const branch_end& a = in.ends[segment.start];
        const branch_end& b = in.ends[segment.end];
        for (std::uint32_t k = 0; k < rings; ++k) {
            const auto ring = reference::ring_at(a, b, k, rings - 1, minimising);
            for (std::uint32_t corner = 0; corner <= in.sides; ++corner) {
                check.vertex(actual[at++], reference::side_vertex(ring, corner, in.sides),
                             size_of(a, b));
            }
        }
    }
}

/// Many rings against a frame carried in 64 times finer steps: the method is what it says it is.
template <backend B>
void branch_frame_twists_least(context<B>& c) {
    const branch_input in = random_branches(c, 10, 5);
    constexpr std::uint32_t rings = 33;
    const auto actual =
        ring_vertices(c, in, {5, rings, kernels::branch_frame::rotation_minimising});
    surface_check check(c);
    std::size_t at = 0;
    for (const branch_segment& segment : in.segments) {
        const branch_end& a = in.ends[segment.start];
        const branch_end& b = in.ends[segment.end];
        for (std::uint32_t k = 0; k < rings; ++k) {
            const auto ring = reference::ring_at(a, b, k, rings - 1, true, 64);
            for (std::uint32_t corner = 0; corner <= 5; ++corner) {
                // 1e-5 of the size would be 1e-4 rad at these radii: leave it to the directions.
                check.vertex(actual[at++], reference::side_vertex(ring, corner, 5),
                             30 * size_of(a, b));
            }
        }
    }
}

template <backend B>
[[nodiscard]] std::vector<surface_vertex> branch_list(const context<B>& c, const branch_input& in,
                                                      const kernels::hermite_branch& kernel,
                                                      padding policy, std::uint64_t triangles) {
    const auto count = static_cast<std::uint32_t>(in.segments.size());
    const auto buffers = put_branches(c, in);
    const auto out = c.template room<surface_vertex>(3 * triangles);
    const auto written = c.template room<count_record>(1);
    c.run([&](auto& r) {
        r.expand(kernel, buffers.views(), range{0, count},
                 triangle_list<B>{out.view(), written.view(), policy});
    });
    c.expect_count(written, triangles, triangles);
    return c.template get<surface_vertex>(out);
}

[[nodiscard]] inline std::uint64_t caps_of(const branch_input& in) {
    std::uint64_t caps = 0;
    for (const branch_segment& segment : in.segments) {
        caps += (segment.caps & 1u) + (segment.caps >> 1 & 1u);
    }
    return caps;
}

[[nodiscard]] inline std::uint64_t branch_triangles(const branch_input& in, std::uint32_t rings,
                                                    padding policy) {
    const std::uint64_t tube = 2 * std::uint64_t{in.sides} * (rings - 1);
    return policy == padding::degenerate ? in.segments.size() * (rings + 1) * 2 * in.sides
                                         : in.segments.size() * tube + caps_of(in) * (in.sides - 2);
}

template <backend B>
void branch_triangle_list(context<B>& c, const branch_input& in, std::uint32_t rings,
                          kernels::branch_frame frame, padding policy) {
    const auto actual =
        branch_list(c, in, {in.sides, rings, frame}, policy, branch_triangles(in, rings, policy));
    const bool minimising = frame == kernels::branch_frame::rotation_minimising;
    const bool spare = policy == padding::degenerate;
    surface_check check(c);
    std::size_t at = 0;
    for (const branch_segment& segment : in.segments) {
        const branch_end& a = in.ends[segment.start];
        const branch_end& b = in.ends[segment.end];
        const double size = size_of(a, b);
        const auto triangles = [&](std::uint32_t n, auto&& vertex) {
            for (std::uint32_t t = 0; t < n; ++t) {
                check.vertex(actual[at++], vertex(t + t % 2), size);
                check.vertex(actual[at++], vertex(t + 1 - t % 2), size);
                check.vertex(actual[at++], vertex(t + 2), size);
            }
            for (std::uint32_t i = 3 * n; spare && i < 6 * in.sides; ++i) {
                check.spare(actual[at++]);
            }
        };
        const auto cap = [&](bool base) {
            const bool there = (segment.caps & (base ? cap_start : cap_end)) != 0;
            triangles(there ? in.sides - 2 : 0, [&](std::uint32_t i) {
                return reference::cap_vertex(base ? a : b, i, in.sides, base);
            });
        };
        cap(true);
        for (std::uint32_t gap = 0; gap + 1 < rings; ++gap) {
            const auto lower = reference::ring_at(a, b, gap, rings - 1, minimising);
            const auto upper = reference::ring_at(a, b, gap + 1, rings - 1, minimising);
            triangles(2 * in.sides, [&](std::uint32_t i) {
                return reference::side_vertex(i % 2 == 0 ? upper : lower, i / 2, in.sides);
            });
        }
        cap(false);
    }
}

/// A straight segment with both caps is closed and faces outwards: its signed volume is that of a
/// frustum of the polygon.
template <backend B>
void branch_volume(context<B>& c, padding policy) {
    branch_end a;
    a.position = {3, 1, 2};
    a.radius = 0.5f;
    branch_end b = a;
    b.position.y = 5;
    b.radius = 0.25f;
    const branch_input in{{{0, 1, cap_start | cap_end, 0}}, {a, b}, polygon_corners(9), 9};
    const auto list = branch_list(c, in, {9, 5, kernels::branch_frame::slerp}, policy,
                                  branch_triangles(in, 5, policy));
    double volume = 0;
    for (std::size_t t = 0; t + 2 < list.size(); t += 3) {
        const glm::dvec3 p(list[t].position);
        volume += glm::dot(p, glm::cross(glm::dvec3(list[t + 1].position),
                                         glm::dvec3(list[t + 2].position))) /
                  6;
    }
    const double polygon = 9.0 / 2 * std::sin(2 * reference::pi / 9);
    const double expected = polygon * 4 / 3 * (0.25 + 0.125 + 0.0625);
    comparison check = c.compare("volume of a closed branch");
    check.close_to(volume, expected, 1e-4);
}

/// Neighbours share a ring's vertices bit for bit.
template <backend B>
void branch_joints(context<B>& c, kernels::branch_frame frame) {
    branch_input in = random_branches(c, 40, 8);
    in.segments.clear();
    for (std::uint32_t i = 0; i + 1 < in.ends.size(); ++i) {
        in.segments.push_back({i, i + 1, 0, 0});
    }
    const auto actual = ring_vertices(c, in, {8, 4, frame});
    comparison check = c.compare("coordinates of joints");
    for (std::size_t i = 0; i + 1 < in.segments.size(); ++i) {
        for (std::size_t corner = 0; corner < 9; ++corner) {
            const surface_vertex& above = actual[(i * 4 + 3) * 9 + corner];
            const surface_vertex& below = actual[(i + 1) * 4 * 9 + corner];
            for (int k = 0; k < 3; ++k) {
                check.same(above.position[k], below.position[k]);
                check.same(above.normal[k], below.normal[k]);
            }
        }
    }
}

template <backend B>
void branch_caps(context<B>& c) {
    const branch_input in = random_branches(c, 60, 7);
    std::vector<std::uint32_t> caps;
    for (std::uint32_t i = 0; i < in.ends.size(); ++i) {
        caps.push_back(2 * i + (i % 2 == 0 ? 1 : 0));
    }
    const auto caps_in = c.put(caps);
    const auto buffers = put_branches(c, in);
    const auto out = c.template room<surface_vertex>(caps.size() * 7);
    c.run([&](auto& r) {
        r.expand_rings(kernels::branch_cap{7},
                       {caps_in.view(), buffers.ends.view(), buffers.corners.view()},
                       range{0, static_cast<std::uint32_t>(caps.size())}, out.view());
    });
    const auto actual = c.template get<surface_vertex>(out);
    surface_check check(c);
    for (std::size_t i = 0; i < caps.size(); ++i) {
        const branch_end& end = in.ends[i];
        for (std::uint32_t j = 0; j < 7; ++j) {
            check.vertex(actual[i * 7 + j], reference::cap_vertex(end, j, 7, i % 2 == 0),
                         size_of(end, end));
        }
    }
}

/// No length, no radius, no turn, a half turn's worth of sign: finite everywhere.
template <backend B>
void branch_degenerate(context<B>& c, kernels::branch_frame frame) {
    branch_input in = random_branches(c, 6, 6);
    in.ends[1].position = in.ends[0].position;
    in.ends[3].orientation = in.ends[2].orientation;
    in.ends[5].orientation = -in.ends[4].orientation;
    in.ends[6].radius = in.ends[7].radius = 0;
    in.ends[9] = in.ends[8];
    const auto actual = ring_vertices(c, in, {6, 5, frame});
    comparison check = c.compare("coordinates that are finite");
    for (const surface_vertex& v : actual) {
        for (int k = 0; k < 3; ++k) {
            check.within(double{v.position[k]}, -1e3, 1e3);
            check.within(double{v.normal[k]}, -1.01, 1.01);
            check.within(double{v.tangent[k]}, -1.01, 1.01);
        }
    }
}

template <backend B>
void add_branch_cases(cases<B>& to) {
    using C = context<B>;
    using kernels::branch_frame;
    const auto add = [&](std::string name, std::function<void(C&)> body) {
        to.push_back({"branch", std::move(name), std::move(body)});
    };
    for (const branch_frame frame : {branch_frame::slerp, branch_frame::rotation_minimising}) {
        const std::string of = frame == branch_frame::slerp ? "slerp" : "rotation_minimising";
        if constexpr (expands_rings<B, kernels::hermite_branch>) {
            add("rings_" + of, [frame](C& c) {
                branch_rings(c, random_branches(c, 65, 8), 4, frame);
                branch_rings(c, random_branches(c, 17, 3), 2, frame);
                branch_rings(c, random_branches(c, 9, 12), 33, frame);
            });
            add("joints_" + of, [frame](C& c) { branch_joints(c, frame); });
            add("degenerate_" + of, [frame](C& c) { branch_degenerate(c, frame); });
        }
        if constexpr (expands<B, kernels::hermite_branch>) {
            add("list_degenerate_" + of, [frame](C& c) {
                branch_triangle_list(c, random_branches(c, 65, 8), 4, frame, padding::degenerate);
                branch_triangle_list(c, random_branches(c, 9, 3), 2, frame, padding::degenerate);
            });
            add("list_compact_" + of, [frame](C& c) {
                branch_triangle_list(c, random_branches(c, 65, 8), 4, frame, padding::compact);
                branch_triangle_list(c, random_branches(c, 9, 3), 2, frame, padding::compact);
            });
        }
    }
    if constexpr (expands_rings<B, kernels::hermite_branch>) {
        add("frame_twists_least", branch_frame_twists_least<B>);
    }
    if constexpr (expands<B, kernels::hermite_branch>) {
        add("volume_degenerate", [](C& c) { branch_volume(c, padding::degenerate); });
        add("volume_compact", [](C& c) { branch_volume(c, padding::compact); });
    }
    if constexpr (expands_rings<B, kernels::branch_cap>) {
        add("caps", branch_caps<B>);
    }
}

} // namespace skybark::conformance
