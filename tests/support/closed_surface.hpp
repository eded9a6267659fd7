#pragma once
// Whether triangles close a volume, and which one.

#include <skybark/core/records.hpp>

#include <array>
#include <cstdint>
#include <cstring>
#include <glm/geometric.hpp>
#include <map>
#include <span>
#include <unordered_map>
#include <vector>

namespace skybark::support {

/// Six times the signed volume over six: positive where triangles are counter-clockwise seen from
/// outside. Relative to the first vertex, so that far-off meshes lose no digits.
[[nodiscard]] inline double signed_volume(std::span<const surface_vertex> vertices,
                                          std::span<const std::uint32_t> indices) {
    double six = 0;
    const auto at = [&](std::size_t k) {
        return glm::dvec3(vertices[indices[k]].position) -
               glm::dvec3(vertices[indices[0]].position);
    };
    for (std::size_t k = 0; k + 2 < indices.size(); k += 3) {
        six += glm::dot(at(k), glm::cross(at(k + 1), at(k + 2)));
    }
    return six / 6;
}

[[nodiscard]] inline double surface_area(std::span<const surface_vertex> vertices,
                                         std::span<const std::uint32_t> indices) {
    double sum = 0;
    for (std::size_t k = 0; k + 2 < indices.size(); k += 3) {
        const glm::dvec3 p(vertices[indices[k]].position);
        sum += glm::length(glm::cross(glm::dvec3(vertices[indices[k + 1]].position) - p,
                                      glm::dvec3(vertices[indices[k + 2]].position) - p)) /
               2;
    }
    return sum;
}

/// Numbers vertices so that equal positions have equal numbers. Bits decide, but for −0.
[[nodiscard]] inline std::vector<std::uint32_t> weld(std::span<const surface_vertex> vertices) {
    struct hash {
        std::size_t operator()(const std::array<std::uint32_t, 3>& key) const {
            std::uint64_t h = 0;
            for (const std::uint32_t word : key) {
                h = (h ^ word) * 0x9e3779b97f4a7c15ull;
                h ^= h >> 29;
            }
            return static_cast<std::size_t>(h);
        }
    };
    std::unordered_map<std::array<std::uint32_t, 3>, std::uint32_t, hash> numbers;
    std::vector<std::uint32_t> welded(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const glm::vec3 p = vertices[i].position + 0.0f;
        std::array<std::uint32_t, 3> key;
        std::memcpy(key.data(), &p, sizeof key);
        welded[i] = numbers.try_emplace(key, static_cast<std::uint32_t>(i)).first->second;
    }
    return welded;
}

/// What is wrong with a surface that should be closed: edges that are not run once each way.
/// Triangles whose corners are not three different places are left out.
struct edge_count {
    std::size_t edges = 0;
    std::size_t open = 0; ///< not exactly once in each direction
    std::size_t degenerate_triangles = 0;
};

[[nodiscard]] inline edge_count count_edges(std::span<const std::uint32_t> welded,
                                            std::span<const std::uint32_t> indices) {
    struct directions {
        int forth = 0;
        int back = 0;
    };
    std::unordered_map<std::uint64_t, directions> edges;
    edge_count count;
    for (std::size_t k = 0; k + 2 < indices.size(); k += 3) {
        const std::uint32_t v[3] = {welded[indices[k]], welded[indices[k + 1]],
                                    welded[indices[k + 2]]};
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
            ++count.degenerate_triangles;
            continue;
        }
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t a = v[i];
            const std::uint32_t b = v[(i + 1) % 3];
            directions& d = edges[std::uint64_t{std::min(a, b)} << 32 | std::max(a, b)];
            ++(a < b ? d.forth : d.back);
        }
    }
    count.edges = edges.size();
    for (const auto& [key, d] : edges) {
        count.open += d.forth != 1 || d.back != 1 ? 1 : 0;
    }
    return count;
}

} // namespace skybark::support
