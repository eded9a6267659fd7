#pragma once
// probe_rings: an expansion into rings that exists to be checked.

#include <skybark/core/kernel.hpp>

namespace skybark::kernels {

struct probe_ring_vertex {
    glm::vec4 place{0}; ///< element, vertex of the element, payload x and y
};
static_assert(sizeof(probe_ring_vertex) == 16);

/// Buffers: a payload an element. Its triangles are a fan around vertex 0.
struct probe_rings {
    using vertex = probe_ring_vertex;
    using buffers = buffer_list<readonly<glm::vec4>>;

    std::uint32_t around = 3; ///< vertices an element, at least 3

    [[nodiscard]] std::uint32_t ring_vertices() const { return around; }
    [[nodiscard]] std::uint32_t ring_triangles() const { return around - 2; }
    [[nodiscard]] std::uint32_t ring_index(std::uint32_t k) const {
        return k % 3 == 0 ? 0 : k / 3 + k % 3;
    }

    template <class Sink>
    void ring(std::uint32_t i, std::uint32_t first, std::uint32_t count, Sink&& sink,
              std::span<const glm::vec4> payloads) const {
        for (std::uint32_t j = first; j < first + count; ++j) {
            sink(vertex{
                {static_cast<float>(i), static_cast<float>(j), payloads[i].x, payloads[i].y}});
        }
    }
};

} // namespace skybark::kernels
