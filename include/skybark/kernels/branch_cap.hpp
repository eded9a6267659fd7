#pragma once
// branch_cap: the flat polygon that closes a branch at an end.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/branch.hpp>

namespace skybark::kernels {

/// Buffers: caps, ends, and the polygon's corners. A cap is 2 · (index of its end), + 1 where the
/// branch starts there and the cap looks back. `sides` vertices and sides − 2 triangles each.
struct branch_cap {
    using vertex = surface_vertex;
    using buffers = buffer_list<readonly<std::uint32_t>, readonly<branch_end>, readonly<glm::vec4>>;

    std::uint32_t sides = 8; ///< of the polygon, at least 3

    [[nodiscard]] std::uint32_t ring_vertices() const { return sides; }
    [[nodiscard]] std::uint32_t ring_triangles() const { return sides - 2; }
    [[nodiscard]] std::uint32_t ring_index(std::uint32_t k) const {
        const std::uint32_t t = k / 3;
        return t + (k % 3 < 2 && t % 2 == 1 ? 1 - k % 3 : k % 3);
    }

    template <class Sink>
    void ring(std::uint32_t i, std::uint32_t first, std::uint32_t count, Sink&& sink,
              std::span<const std::uint32_t> caps, std::span<const branch_end> ends,
              std::span<const glm::vec4> corners) const {
        const bool base = caps[i] % 2 != 0;
        const shared::branch_ring r = shared::branch_ring_at_end(ends[caps[i] / 2]);
        for (std::uint32_t j = first; j < first + count; ++j) {
            const std::uint32_t corner = shared::branch_cap_corner(j, sides, base);
            sink(shared::branch_cap_vertex(r, corners[corner], base));
        }
    }
};

} // namespace skybark::kernels
