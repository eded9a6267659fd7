#include <io/cut_polygon.hpp>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace skybark::io {

namespace {

using triangle_list = std::vector<std::array<std::uint32_t, 3>>;

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// Twice the area of a, b, c: positive where they go round counter-clockwise.
double turn(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) { return cross(b - a, c - a); }

/// The corners in the plane across Newell's normal, counter-clockwise.
std::vector<glm::dvec2> flattened(std::span<const glm::vec3> corners) {
    glm::dvec3 normal(0);
    const glm::dvec3 first(corners[0]);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        normal += glm::cross(glm::dvec3(corners[i]) - first,
                             glm::dvec3(corners[(i + 1) % corners.size()]) - first);
    }
    const double length = glm::length(normal);
    normal = length > 0 ? normal / length : glm::dvec3(0, 0, 1);
    const glm::dvec3 axis = std::abs(normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 right = glm::normalize(glm::cross(axis, normal));
    const glm::dvec3 up = glm::cross(normal, right);
    std::vector<glm::dvec2> flat;
    flat.reserve(corners.size());
    for (const glm::vec3& corner : corners) {
        const glm::dvec3 p = glm::dvec3(corner) - first;
        flat.emplace_back(glm::dot(p, right), glm::dot(p, up));
    }
    return flat;
}

/// Whether a fan from corner 0 cuts it well: it turns left everywhere, and round once.
bool is_convex(const std::vector<glm::dvec2>& p) {
    const std::size_t n = p.size();
    for (std::size_t i = 0; i < n; ++i) {
        if (turn(p[i], p[(i + 1) % n], p[(i + 2) % n]) < 0 ||
            turn(p[0], p[i], p[(i + 1) % n]) < 0) {
            return false;
        }
    }
    return true;
}

bool holds(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 p) {
    return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

/// Whether the corner `at` of what is left can be cut off.
bool is_ear(const std::vector<glm::dvec2>& p, const std::vector<std::uint32_t>& left,
            std::size_t at) {
    const std::size_t n = left.size();
    const std::uint32_t a = left[(at + n - 1) % n];
    const std::uint32_t b = left[at];
    const std::uint32_t c = left[(at + 1) % n];
    if (turn(p[a], p[b], p[c]) <= 0) {
        return false;
    }
    for (const std::uint32_t i : left) {
        const bool corner = p[i] == p[a] || p[i] == p[b] || p[i] == p[c];
        if (!corner && holds(p[a], p[b], p[c], p[i])) {
            return false;
        }
    }
    return true;
}

triangle_list cut_ears(const std::vector<glm::dvec2>& p) {
    std::vector<std::uint32_t> left(p.size());
    for (std::uint32_t i = 0; i < left.size(); ++i) {
        left[i] = i;
    }
    triangle_list triangles;
    while (left.size() > 3) {
        std::size_t ear = 0; // where there is none, it crosses itself
        for (std::size_t i = 0; i < left.size(); ++i) {
            if (is_ear(p, left, i)) {
                ear = i;
                break;
            }
        }
        const std::size_t n = left.size();
        triangles.push_back({left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    triangles.push_back({left[0], left[1], left[2]});
    return triangles;
}

} // namespace

std::optional<triangle_list> cut_polygon(std::span<const glm::vec3> corners) {
    const auto count = static_cast<std::uint32_t>(corners.size());
    if (count == 3) {
        return triangle_list{{0, 1, 2}};
    }
    const std::vector<glm::dvec2> flat = flattened(corners);
    if (is_convex(flat)) {
        triangle_list triangles;
        for (std::uint32_t i = 2; i < count; ++i) {
            triangles.push_back({0, i - 1, i});
        }
        return triangles;
    }
    if (count > most_concave_corners) {
        return {};
    }
    return cut_ears(flat);
}

} // namespace skybark::io
