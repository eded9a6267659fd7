#pragma once
// scatter_relax: diffuse light moves on from cell to cell, one step.

#include <skybark/kernels/scatter_cells.hpp>

namespace skybark::kernels {

/// No buffers. Volumes: fluence, resistance, extinction, source. Target 0: fluence.
struct scatter_relax {
    using buffers = buffer_list<>;
    static constexpr std::uint32_t volumes = 4;
    static constexpr std::uint32_t volume_targets = 1;

    scatter_equation equation;
    float weight = 1;            ///< of the step
    std::uint32_t from_zero = 0; ///< 1: the fluence is not read and counts as 0
    float least = 0;             ///< what is below becomes this

    template <class Grids>
    void voxel(glm::ivec3 at, const Grids& grids) const {
        const shared::scatter_balance sum = equation.balance(at, from_zero != 0, grids);
        const float phi = from_zero != 0 ? 0.0f : grids.load(0, at);
        grids.store(0, at, glm::max(shared::scatter_relaxed(sum, phi, weight), least));
    }
};

} // namespace skybark::kernels
