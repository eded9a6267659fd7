#pragma once
// scatter_prolong: adds to the fluence of a grid what a coarser one has found.

#include <skybark/kernels/scatter_cells.hpp>

namespace skybark::kernels {

/// No buffers. Volumes: fluence, and fluence of a grid with cells of twice the sides. Target 0:
/// their sum, the second one trilinear.
struct scatter_prolong {
    using buffers = buffer_list<>;
    static constexpr std::uint32_t volumes = 2;
    static constexpr std::uint32_t volume_targets = 1;

    std::uint32_t from_zero = 0;   ///< 1: the finer fluence is not read and counts as 0
    std::uint32_t axes = all_axes; ///< that the coarser grid halves

    template <class Grids>
    void voxel(glm::ivec3 at, const Grids& grids) const {
        const glm::ivec3 last = grids.size(1) - 1;
        const glm::ivec3 halved = halved_axes(axes, grids.size(0));
        const glm::ivec3 nearer = glm::min(at / (1 + halved), last);
        const glm::ivec3 farther =
            glm::clamp(nearer + halved * (2 * (at - 2 * (at / 2)) - 1), glm::ivec3(0), last);
        const auto row = [&](int y, int z) {
            return 0.75f * grids.load(1, {nearer.x, y, z}) +
                   0.25f * grids.load(1, {farther.x, y, z});
        };
        const float sum =
            0.75f * (0.75f * row(nearer.y, nearer.z) + 0.25f * row(farther.y, nearer.z)) +
            0.25f * (0.75f * row(nearer.y, farther.z) + 0.25f * row(farther.y, farther.z));
        grids.store(0, at, from_zero != 0 ? sum : grids.load(0, at) + sum);
    }
};

} // namespace skybark::kernels
