#include "vertex_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <numeric>
#include <tuple>

namespace skybark::tool {

namespace {

/// A corner of a triangle.
struct corner {
    glm::vec3 place{0};
    glm::vec3 normal{0};
    std::uint32_t number = 0; ///< 3 · triangle + 0, 1, 2
};

glm::vec3 place_of(const gather_triangle& t, std::uint32_t c) {
    return c == 0 ? t.a : c == 1 ? t.b : t.c;
}

/// Across the triangle, as long as twice its area.
glm::dvec3 area_of(const gather_triangle& t) {
    return glm::cross(glm::dvec3(t.b) - glm::dvec3(t.a), glm::dvec3(t.c) - glm::dvec3(t.a));
}

std::tuple<float, float, float> order_of(glm::vec3 v) { return {v.x, v.y, v.z}; }

/// Gives normals to the corners of one place that have none.
void smooth(std::span<corner> here, std::span<const gather_triangle> triangles,
            std::span<const glm::vec3> given) {
    constexpr double same_surface = 0.8660254; // cos 30°
    constexpr std::size_t most = 256;          // of which every pair is looked at
    std::vector<glm::dvec3> areas;
    for (const corner& c : here) {
        areas.push_back(given[c.number] == glm::vec3(0) ? area_of(triangles[c.number / 3])
                                                        : glm::dvec3(0));
    }
    for (std::size_t i = 0; i < here.size(); ++i) {
        const double own = glm::length(areas[i]);
        if (own == 0) {
            here[i].normal = given[here[i].number];
            continue;
        }
        glm::dvec3 sum = here.size() > most ? areas[i] : glm::dvec3(0);
        for (std::size_t k = 0; k < here.size() && here.size() <= most; ++k) {
            if (glm::dot(areas[i], areas[k]) >= same_surface * own * glm::length(areas[k])) {
                sum += areas[k];
            }
        }
        here[i].normal = glm::vec3(glm::normalize(sum));
    }
}

} // namespace

vertex_points find_vertices(std::span<const gather_triangle> triangles,
                            std::span<const glm::vec3> normals, float lift) {
    std::vector<corner> corners(3 * triangles.size());
    for (std::uint32_t i = 0; i < corners.size(); ++i) {
        // 0 is added, so that −0 is the same place.
        corners[i] = {place_of(triangles[i / 3], i % 3) + glm::vec3(0), glm::vec3(0), i};
    }
    const auto by_place = [](const corner& a, const corner& b) {
        return order_of(a.place) < order_of(b.place);
    };
    std::stable_sort(corners.begin(), corners.end(), by_place);
    for (std::size_t first = 0, last = 0; first < corners.size(); first = last) {
        while (last < corners.size() && corners[last].place == corners[first].place) {
            ++last;
        }
        const auto here = std::span(corners).subspan(first, last - first);
        smooth(here, triangles, normals);
        std::stable_sort(here.begin(), here.end(), [](const corner& a, const corner& b) {
            return order_of(a.normal) < order_of(b.normal);
        });
    }
    // Points in the order in which the scene's triangles name them first.
    constexpr std::uint32_t none = 0xffffffffu;
    std::vector<std::uint32_t> group(corners.size(), none); // of each corner, its group's leader
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const corner& c = corners[i];
        const bool same =
            i > 0 && c.place == corners[i - 1].place && c.normal == corners[i - 1].normal;
        group[c.number] = same ? group[corners[i - 1].number] : c.number;
    }
    std::vector<glm::vec3> normal_of(corners.size());
    for (const corner& c : corners) {
        normal_of[c.number] = c.normal;
    }
    vertex_points found;
    std::vector<std::uint32_t> point_of(corners.size(), none);
    std::vector<glm::dvec4> middles; // summed, and how many
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        glm::uvec3 points(none);
        for (std::uint32_t c = 0; c < 3; ++c) {
            const std::uint32_t i = 3 * t + c;
            if (normal_of[i] == glm::vec3(0)) {
                continue;
            }
            std::uint32_t& point = point_of[group[i]];
            if (point == none) {
                point = static_cast<std::uint32_t>(found.samples.size());
                gather_sample s;
                s.position = place_of(triangles[t], c);
                s.normal = normal_of[i];
                found.samples.push_back(s);
                middles.emplace_back(0);
            }
            points[static_cast<glm::length_t>(c)] = point;
            const glm::dvec3 middle = (glm::dvec3(triangles[t].a) + glm::dvec3(triangles[t].b) +
                                       glm::dvec3(triangles[t].c)) /
                                      3.0;
            middles[point] += glm::dvec4(middle, 1);
        }
        if (points.x != none && points.y != none && points.z != none) {
            found.triangles.push_back(points);
        }
    }
    for (std::size_t i = 0; i < found.samples.size(); ++i) {
        const glm::dvec3 place(found.samples[i].position);
        const glm::dvec3 inwards = glm::dvec3(middles[i]) / middles[i].w - place;
        const double way = glm::length(inwards);
        found.places.push_back(found.samples[i].position);
        if (way > 0) {
            const double step =
                std::min(std::max(2.0 * static_cast<double>(lift), 1e-4 * way), way / 3);
            found.samples[i].position = glm::vec3(place + inwards * (step / way));
        }
    }
    return found;
}

} // namespace skybark::tool
