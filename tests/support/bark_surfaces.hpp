#pragma once
// Surfaces to put bark on, as host meshes and in a device's buffers.

#include <skybark/core/backend.hpp>
#include <skybark/trees/branch_mesh.hpp>

#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

namespace skybark::support {

/// A mesh of one part, as bark_mesh takes it.
template <backend B>
struct one_part_mesh {
    struct part {
        typename B::buffer vertices;
        typename B::buffer indices;
        std::uint32_t index_count = 0;
    };
    std::vector<part> all;

    [[nodiscard]] std::span<const part> parts() const { return all; }
    [[nodiscard]] draw_geometry<B> geometry(const part& p) const {
        return {view<B>(p.indices), 0, p.index_count, 0, {}};
    }

    static one_part_mesh make(B& device, const trees::host_mesh& mesh) {
        auto vertices = make_buffer<B, surface_vertex>(device, mesh.vertices);
        auto indices = make_buffer<B, std::uint32_t>(device, mesh.indices);
        if (!vertices || !indices) {
            throw std::runtime_error("No buffer for a test's mesh.");
        }
        one_part_mesh made;
        made.all.push_back({std::move(*vertices), std::move(*indices),
                            static_cast<std::uint32_t>(mesh.indices.size())});
        return made;
    }
};

/// A closed, bent and tapered stem: rings with a seam (u runs from 0 to 1, its ends at one place),
/// and a fan at each end to a pole without a texture direction. About 1 m wide and 3 m long.
[[nodiscard]] inline trees::host_mesh closed_stem(std::uint32_t sides, std::uint32_t rings) {
    trees::host_mesh mesh;
    constexpr double two_pi = 6.283185307179586;
    for (std::uint32_t k = 0; k < rings; ++k) {
        const double t = double(k) / (rings - 1);
        const glm::dvec3 centre(0.4 * std::sin(2 * t), 3 * t, 0.2 * t * t);
        const double radius = 0.5 - 0.35 * t + 0.05 * std::sin(9 * t);
        for (std::uint32_t i = 0; i <= sides; ++i) {
            const double angle = two_pi * (i % sides) / sides + 0.7 * t;
            const glm::dvec3 out(std::cos(angle), 0.1, -std::sin(angle));
            surface_vertex v;
            v.position = glm::vec3(centre + radius * out);
            v.normal = glm::vec3(glm::normalize(out));
            v.u = static_cast<float>(double(i) / sides);
            v.v = static_cast<float>(3.1 * t);
            v.tangent = glm::vec4(static_cast<float>(-std::sin(angle)), 0,
                                  static_cast<float>(-std::cos(angle)), 1);
            mesh.vertices.push_back(v);
        }
    }
    for (std::uint32_t k = 0; k + 1 < rings; ++k) {
        for (std::uint32_t i = 0; i < sides; ++i) {
            const std::uint32_t lower = k * (sides + 1) + i;
            const std::uint32_t upper = lower + sides + 1;
            mesh.indices.insert(mesh.indices.end(),
                                {upper, lower, upper + 1, upper + 1, lower, lower + 1});
        }
    }
    for (const bool top : {false, true}) {
        const std::uint32_t ring = top ? (rings - 1) * (sides + 1) : 0;
        surface_vertex pole;
        pole.normal = {0, top ? 1 : -1, 0};
        pole.v = mesh.vertices[ring].v;
        for (std::uint32_t i = 0; i < sides; ++i) {
            pole.position += mesh.vertices[ring + i].position / static_cast<float>(sides);
        }
        pole.position.y += top ? 0.1f : -0.1f;
        const auto number = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(pole);
        for (std::uint32_t i = 0; i < sides; ++i) {
            const std::uint32_t a = ring + (top ? i : i + 1);
            const std::uint32_t b = ring + (top ? i + 1 : i);
            mesh.indices.insert(mesh.indices.end(), {a, b, number});
        }
    }
    return mesh;
}

/// The longest edge of a mesh's triangles, m.
[[nodiscard]] inline double longest_edge(const trees::host_mesh& mesh) {
    double longest = 0;
    for (std::size_t k = 0; k < mesh.indices.size(); ++k) {
        const std::size_t n = k % 3 == 2 ? k - 2 : k + 1;
        longest =
            std::max(longest, glm::distance(glm::dvec3(mesh.vertices[mesh.indices[k]].position),
                                            glm::dvec3(mesh.vertices[mesh.indices[n]].position)));
    }
    return longest;
}

} // namespace skybark::support
