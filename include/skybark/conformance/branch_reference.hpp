#pragma once
// What kernels::hermite_branch should make of a segment, in double precision and from the equations
// alone (Akagi and Kitajima, section 2.2; Wang, Jüttler, Zheng and Liu 2008). It shares nothing
// with the kernel but the records.

#include <skybark/core/records.hpp>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <vector>

namespace skybark::conformance::reference {

using glm::dvec3;
using glm::dvec4;

inline constexpr double pi = 3.14159265358979323846;

/// v turned by the unit quaternion q (x, y, z, w): v + 2 w (u × v) + 2 u × (u × v).
[[nodiscard]] inline dvec3 turned(dvec4 q, dvec3 v) {
    q /= std::sqrt(glm::dot(q, q));
    const dvec3 u(q);
    const dvec3 t = 2.0 * glm::cross(u, v);
    return v + q.w * t + glm::cross(u, t);
}

/// sin((1 − t) θ) / sin θ · a + sin(t θ) / sin θ · b along the short arc (equation 2, mended).
[[nodiscard]] inline dvec4 slerp(dvec4 a, dvec4 b, double t) {
    double cosine = glm::dot(a, b);
    if (cosine < 0) {
        b = -b;
        cosine = -cosine;
    }
    const double angle = std::acos(std::fmin(1, cosine));
    if (angle < 1e-6) {
        return glm::mix(a, b, t);
    }
    return (std::sin((1 - t) * angle) * a + std::sin(t * angle) * b) / std::sin(angle);
}

/// A cubic with ends p1, p2 and derivatives n1, n2 there (equation 1, both along the growth).
struct curve {
    dvec3 p1, n1, p2, n2;

    [[nodiscard]] dvec3 at(double t) const {
        const double t2 = t * t;
        const double t3 = t2 * t;
        return (2 * t3 - 3 * t2 + 1) * p1 + (t3 - 2 * t2 + t) * n1 + (3 * t2 - 2 * t3) * p2 +
               (t3 - t2) * n2;
    }
    [[nodiscard]] dvec3 direction(double t) const {
        const double t2 = t * t;
        const dvec3 d =
            (6 * t2 - 6 * t) * (p1 - p2) + (3 * t2 - 4 * t + 1) * n1 + (3 * t2 - 2 * t) * n2;
        const double length = glm::length(d);
        return length > 0 ? d / length : n1;
    }
};

[[nodiscard]] inline curve curve_of(const branch_end& a, const branch_end& b) {
    const dvec3 p1(a.position);
    const dvec3 p2(b.position);
    const double chord = glm::length(p2 - p1);
    return {p1, chord * turned(dvec4(a.orientation), {0, 1, 0}), p2,
            chord * turned(dvec4(b.orientation), {0, 1, 0})};
}

/// A ring of the surface: centre and frame, y along the growth.
struct ring {
    dvec3 centre, x, y, z;
    double radius, path, slope;
};

/// v mirrored in the plane that n is normal to.
[[nodiscard]] inline dvec3 mirrored(dvec3 v, dvec3 n) {
    const double n2 = glm::dot(n, n);
    return n2 > 0 ? v - 2 * glm::dot(n, v) / n2 * n : v;
}

/// Carries x along the curve from t = 0 to 1 in `steps` steps of double reflection; the axes at
/// each step, first to last.
[[nodiscard]] inline std::vector<dvec3> carried(const curve& c, dvec3 x, std::uint32_t steps) {
    std::vector<dvec3> axes{x};
    for (std::uint32_t i = 0; i < steps; ++i) {
        const double t0 = double(i) / steps;
        const double t1 = double(i + 1) / steps;
        const dvec3 first = c.at(t1) - c.at(t0);
        const dvec3 tangent = mirrored(c.direction(t0), first);
        x = mirrored(mirrored(x, first), c.direction(t1) - tangent);
        axes.push_back(x);
    }
    return axes;
}

[[nodiscard]] inline ring ring_at(const branch_end& a, const branch_end& b, std::uint32_t k,
                                  std::uint32_t last, bool rotation_minimising,
                                  std::uint32_t steps_between = 1) {
    const double t = double(k) / last;
    const curve c = curve_of(a, b);
    const dvec4 q = slerp(dvec4(a.orientation), dvec4(b.orientation), t);
    ring r{c.at(t),
           turned(q, {1, 0, 0}),
           turned(q, {0, 1, 0}),
           turned(q, {0, 0, 1}),
           glm::mix(double{a.radius}, double{b.radius}, t),
           glm::mix(double{a.path}, double{b.path}, t),
           glm::mix(double{a.slope}, double{b.slope}, t)};
    if (!rotation_minimising || k == 0 || k == last) {
        return r;
    }
    // The twist left over at the end is spread evenly.
    const auto axes = carried(c, turned(dvec4(a.orientation), {1, 0, 0}), last * steps_between);
    const dvec3 wanted = turned(dvec4(b.orientation), {1, 0, 0});
    const dvec3 arrived = axes.back();
    const double twist = std::atan2(glm::dot(glm::cross(arrived, wanted), c.direction(1)),
                                    glm::dot(arrived, wanted));
    const dvec3 x = axes[std::size_t{k} * steps_between];
    r.y = c.direction(t);
    const double angle = twist * t;
    r.x = std::cos(angle) * x + std::sin(angle) * glm::cross(r.y, x);
    r.x = glm::normalize(r.x - glm::dot(r.x, r.y) * r.y);
    r.z = glm::cross(r.x, r.y);
    return r;
}

/// A vertex in double precision.
struct vertex {
    dvec3 position, normal, tangent;
    double u, v, handedness;
};

/// The vertex at angle 2π corner / sides, counter-clockwise seen from the tip.
[[nodiscard]] inline vertex side_vertex(const ring& r, std::uint32_t corner, std::uint32_t sides) {
    const double angle = 2 * pi * corner / sides;
    const dvec3 outward = std::cos(angle) * r.x - std::sin(angle) * r.z;
    const dvec3 around = -std::sin(angle) * r.x - std::cos(angle) * r.z;
    return {r.centre + r.radius * outward,
            glm::normalize(outward - r.slope * r.y),
            around,
            double(corner) / sides,
            r.path,
            1};
}

/// Vertex i of the strip that closes the end of a branch, or its start (`base`): zigzag over the
/// polygon, counter-clockwise seen from outside.
[[nodiscard]] inline vertex cap_vertex(const branch_end& end, std::uint32_t i, std::uint32_t sides,
                                       bool base) {
    const dvec4 q(end.orientation);
    const ring r{dvec3(end.position),
                 turned(q, {1, 0, 0}),
                 turned(q, {0, 1, 0}),
                 turned(q, {0, 0, 1}),
                 end.radius,
                 end.path,
                 0};
    const int step = i % 2 == 1 ? static_cast<int>(i + 1) / 2 : -static_cast<int>(i) / 2;
    const int n = static_cast<int>(sides);
    const double angle = 2 * pi * (((base ? -step : step) + n) % n) / n;
    vertex out = side_vertex(r, 0, sides);
    out.position = r.centre + r.radius * (std::cos(angle) * r.x - std::sin(angle) * r.z);
    out.normal = base ? -r.y : r.y;
    out.tangent = r.x;
    out.handedness = base ? -1 : 1;
    out.u = 0.5 + 0.5 * std::cos(angle);
    out.v = r.path + r.radius * std::sin(angle);
    return out;
}

} // namespace skybark::conformance::reference
