#pragma once
// How much of what a point sees is a polygon.

#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace skybark::first_pass {

/// The form factor from a point that looks along `normal` (unit) to a triangle: the irradiance that
/// it gives, over π, at radiance 1, with nothing in between. In closed form (Lambert 1760): the sum
/// over the edges, of the angle under which each is seen times the cosine of the plane through it;
/// what lies behind the point's plane is cut off before. Either side of the triangle counts.
[[nodiscard]] inline double form_factor(glm::dvec3 point, glm::dvec3 normal,
                                        std::span<const glm::vec3, 3> corners) {
    glm::dvec3 seen[4];
    std::size_t count = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3 from = glm::dvec3(corners[i]) - point;
        const glm::dvec3 to = glm::dvec3(corners[(i + 1) % 3]) - point;
        const double a = glm::dot(normal, from);
        const double b = glm::dot(normal, to);
        if (a >= 0) {
            seen[count++] = from;
        }
        if ((a > 0 && b < 0) || (a < 0 && b > 0)) {
            seen[count++] = from + (a / (a - b)) * (to - from);
        }
    }
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec3 edge = glm::cross(seen[i], seen[(i + 1) % count]);
        const double sine = glm::length(edge);
        if (sine > 0) {
            sum += std::atan2(sine, glm::dot(seen[i], seen[(i + 1) % count])) *
                   glm::dot(normal, edge) / sine;
        }
    }
    return std::abs(sum) / (2 * 3.14159265358979323846);
}

} // namespace skybark::first_pass
