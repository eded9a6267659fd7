#pragma once
// scatter_coarsen: the matter and the beam of a grid with cells of twice the sides.

#include <skybark/kernels/scatter_cells.hpp>

namespace skybark::kernels {

/// No buffers. Volumes and targets: extinction, what of the beam is scattered, the beam at the top
/// of the cell. Beside and above the finer grid is nothing, and there the beam is whole.
struct scatter_coarsen {
    using buffers = buffer_list<>;
    static constexpr std::uint32_t volumes = 3;
    static constexpr std::uint32_t volume_targets = 3;

    std::uint32_t axes = all_axes; ///< that the coarser grid halves

    template <class Grids>
    void voxel(glm::ivec3 at, const Grids& grids) const {
        const glm::ivec3 size = grids.size(0);
        const glm::ivec3 halved = halved_axes(axes, size);
        const glm::ivec3 first = first_child(at, halved);
        float extinction = 0;
        float scattered = 0;
        float beam = 0;
        for (int c = 0; c < 8; ++c) {
            const glm::ivec3 child = child_of(first, c, halved);
            const bool inside = within(child, size);
            extinction += inside ? grids.load(0, child) : 0.0f;
            scattered += inside ? grids.load(1, child) : 0.0f;
            if ((c & 2) != 0) {
                beam += inside ? grids.load(2, child) : 1.0f;
            }
        }
        grids.store(0, at, 0.125f * extinction);
        grids.store(1, at, 0.125f * scattered);
        grids.store(2, at, 0.25f * beam);
    }
};

} // namespace skybark::kernels
