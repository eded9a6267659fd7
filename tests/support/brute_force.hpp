#pragma once
// Light by tracing every ray against every triangle, in double precision: what gathers are held to.

#include <scenes/surface_list.hpp>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <span>
#include <vector>

namespace skybark::support {

struct traced_hit {
    double distance = std::numeric_limits<double>::infinity();
    std::size_t triangle = 0;
    bool back = false;
    double u = 0; ///< weight of the triangle's b
    double v = 0; ///< … and of its c

    [[nodiscard]] bool missed() const { return std::isinf(distance); }
};

/// Says whether a triangle has a hole at a place of it.
using hole_test = std::function<bool(std::size_t triangle, double u, double v)>;

/// The first triangle along a ray, by Möller and Trumbore's solution (1997).
[[nodiscard]] inline traced_hit trace(std::span<const gather_triangle> triangles, glm::dvec3 origin,
                                      glm::dvec3 direction, const hole_test& hole = {}) {
    traced_hit best;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const glm::dvec3 a(triangles[i].a);
        const glm::dvec3 ab = glm::dvec3(triangles[i].b) - a;
        const glm::dvec3 ac = glm::dvec3(triangles[i].c) - a;
        const glm::dvec3 p = glm::cross(direction, ac);
        const double scale = glm::dot(ab, p);
        if (scale == 0 || std::isnan(scale)) {
            continue;
        }
        const glm::dvec3 s = origin - a;
        const double u = glm::dot(s, p) / scale;
        const glm::dvec3 q = glm::cross(s, ab);
        const double v = glm::dot(direction, q) / scale;
        const double t = glm::dot(ac, q) / scale;
        if (u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < best.distance &&
            !(hole && hole(i, u, v))) {
            best = {t, i, scale < 0, u, v};
        }
    }
    return best;
}

/// Axes of a spherical Fibonacci set on the half sphere (Swinbank and Purser 2006).
[[nodiscard]] inline std::vector<glm::dvec3> fibonacci_axes(int count) {
    std::vector<glm::dvec3> axes;
    for (int i = 0; i < count; ++i) {
        const double z = (i + 0.5) / count;
        const double turn = 2 * 3.14159265358979323846 * std::fmod(i * 0.6180339887498949, 1.0);
        const double out = std::sqrt(1 - z * z);
        // Turned, so that no axis lies along an edge of an upright box.
        const double x = out * std::cos(turn);
        const double y = out * std::sin(turn);
        axes.emplace_back(0.8 * x - 0.48 * y + 0.36 * z, 0.6 * x + 0.64 * y - 0.48 * z,
                          0.6 * y + 0.8 * z);
    }
    return axes;
}

/// Radiance seen where a ray met something, or (missed) along its direction.
using seen_radiance = std::function<glm::dvec3(const traced_hit&, glm::dvec3 direction)>;

/// Irradiance at a sample: π Σ L c / Σ c over these axes.
[[nodiscard]] inline glm::dvec3 traced_irradiance(std::span<const gather_triangle> triangles,
                                                  const gather_sample& at, double lift,
                                                  std::span<const glm::dvec3> axes,
                                                  const seen_radiance& seen,
                                                  const hole_test& hole = {}) {
    const glm::dvec3 normal(at.normal);
    glm::dvec3 sum(0);
    double all = 0;
    for (const glm::dvec3& axis : axes) {
        const double along = glm::dot(normal, axis);
        const glm::dvec3 direction = along >= 0 ? axis : -axis;
        const traced_hit hit =
            trace(triangles, glm::dvec3(at.position) + lift * normal, direction, hole);
        sum += std::abs(along) * seen(hit, direction);
        all += std::abs(along);
    }
    return 3.14159265358979323846 * sum / all;
}

} // namespace skybark::support
