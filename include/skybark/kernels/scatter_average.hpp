#pragma once
// scatter_average: resistances on a grid with cells of twice the sides.

#include <skybark/kernels/scatter_cells.hpp>

namespace skybark::kernels {

/// No buffers. Volume 0, target 0: one over the mean of one over eight, so that light finds on the
/// coarser grid the ways through empty space that it has on the finer one. (With a plain mean the
/// coarser grid asks for more than the finer one needs, and cycles diverge where thick matter lies
/// beside empty space.) Where an odd grid ends, its last cells count twice.
struct scatter_average {
    using buffers = buffer_list<>;
    static constexpr std::uint32_t volumes = 1;
    static constexpr std::uint32_t volume_targets = 1;

    std::uint32_t axes = all_axes; ///< that the coarser grid halves

    template <class Grids>
    void voxel(glm::ivec3 at, const Grids& grids) const {
        const glm::ivec3 size = grids.size(0);
        const glm::ivec3 halved = halved_axes(axes, size);
        const glm::ivec3 first = first_child(at, halved);
        float sum = 0;
        for (int c = 0; c < 8; ++c) {
            sum += 1.0f / grids.load(0, held(child_of(first, c, halved), size));
        }
        grids.store(0, at, 8.0f / sum);
    }
};

} // namespace skybark::kernels
