#pragma once
// Closed forms of the light that a point on a plane gets from an even emitter: the share of π L.
// Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-3, B-5, B-12, B-28.

#include <cmath>

namespace skybark::support {

inline constexpr double pi = 3.14159265358979323846;

/// A rectangle of a × b parallel to the plane at height c, one corner above the point.
[[nodiscard]] inline double share_of_corner(double a, double b, double c) {
    const double x = a / c;
    const double y = b / c;
    const double p = std::sqrt(1 + x * x);
    const double q = std::sqrt(1 + y * y);
    return (x / p * std::atan(y / p) + y / q * std::atan(x / q)) / (2 * pi);
}

/// The unit square at height 1 over a unit square, from its point (x, y).
[[nodiscard]] inline double share_of_parallel_square(double x, double y) {
    return share_of_corner(x, y, 1) + share_of_corner(1 - x, y, 1) + share_of_corner(x, 1 - y, 1) +
           share_of_corner(1 - x, 1 - y, 1);
}

/// A unit square that stands on an edge of a unit square, from its point at `away` from that edge
/// and `along` it.
[[nodiscard]] inline double share_of_standing_square(double away, double along) {
    const auto half = [&](double width) { // from its foot, sideways
        const double far = std::sqrt(away * away + 1);
        return (std::atan(width / away) - away / far * std::atan(width / far)) / (2 * pi);
    };
    return half(along) + half(1 - along);
}

/// A disk of this radius, parallel, its middle at this height above the point.
[[nodiscard]] inline double share_of_disk(double radius, double height) {
    return radius * radius / (radius * radius + height * height);
}

/// A sphere wholly above the plane, its middle `height` above it and `sideways` from the point.
[[nodiscard]] inline double share_of_sphere(double radius, double height, double sideways) {
    return radius * radius * height / std::pow(sideways * sideways + height * height, 1.5);
}

} // namespace skybark::support
