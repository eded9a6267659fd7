#pragma once
// scatter_restrict: what the equation of a grid still lacks, as the source of a coarser one.

#include <skybark/kernels/scatter_cells.hpp>

namespace skybark::kernels {

/// No buffers. Volumes, of the finer grid: fluence, resistance, extinction, source. Target 0: the
/// mean over eight cells of what the source has left over, nothing where an odd grid has ended.
struct scatter_restrict {
    using buffers = buffer_list<>;
    static constexpr std::uint32_t volumes = 4;
    static constexpr std::uint32_t volume_targets = 1;

    scatter_equation equation;     ///< of the finer grid
    std::uint32_t axes = all_axes; ///< that the coarser one halves

    template <class Grids>
    void voxel(glm::ivec3 at, const Grids& grids) const {
        const glm::ivec3 size = grids.size(0);
        const glm::ivec3 halved = halved_axes(axes, size);
        const glm::ivec3 first = first_child(at, halved);
        float left = 0;
        for (int c = 0; c < 8; ++c) {
            const glm::ivec3 child = child_of(first, c, halved);
            if (within(child, size)) {
                const shared::scatter_balance sum = equation.balance(child, false, grids);
                left += sum.gain - sum.loss * grids.load(0, child);
            }
        }
        grids.store(0, at, 0.125f * left);
    }
};

} // namespace skybark::kernels
