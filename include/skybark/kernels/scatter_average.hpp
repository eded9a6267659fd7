#pragma once
// scatter_average: a volume on a grid with cells of twice the sides.

#include <skybark/kernels/scatter_cells.hpp>

namespace skybark::kernels {

/// No buffers. Volume 0, target 0: means of eight; where an odd grid ends, its last cells count
/// twice.
struct scatter_average {
    using buffers = buffer_list<>;
    static constexpr std::uint32_t volumes = 1;
    static constexpr std::uint32_t volume_targets = 1;

    template <class Grids>
    void voxel(glm::ivec3 at, const Grids& grids) const {
        const glm::ivec3 size = grids.size(0);
        const glm::ivec3 first = first_child(at, size);
        float sum = 0;
        for (int c = 0; c < 8; ++c) {
            sum += grids.load(0, held(child_of(first, c, size), size));
        }
        grids.store(0, at, 0.125f * sum);
    }
};

} // namespace skybark::kernels
