#pragma once
// branch_tip: the point in which the triangles meet that close a branch.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/join.hpp>

namespace skybark::kernels {

/// Buffers: tips, ends, the polygon's corners (`unit_polygon(sides)`), vertices. A tip is
/// 2 · (index of its end), + 1 where the branch starts there. `sides` vertices a tip, all at one
/// place: each is one triangle's, with the u of that triangle's middle. Maps over tips.
struct branch_tip {
    using buffers = buffer_list<readonly<std::uint32_t>, readonly<branch_end>, readonly<glm::vec4>,
                                writeonly<surface_vertex>>;

    std::uint32_t sides = 8; ///< of the polygon, at least 3

    void map(std::uint32_t i, std::span<const std::uint32_t> tips, std::span<const branch_end> ends,
             std::span<const glm::vec4> corners, std::span<surface_vertex> vertices) const {
        const bool base = tips[i] % 2 != 0;
        const shared::branch_ring ring = shared::branch_ring_at_end(ends[tips[i] / 2]);
        for (std::uint32_t c = 0; c < sides; ++c) {
            vertices[i * sides + c] = shared::tip_vertex(ring, corners[c], corners[c + 1], base);
        }
    }
};

} // namespace skybark::kernels
