#pragma once
// scatter_medium: what a cell of 2 × 2 × 2 voxels of an attenuation volume takes out of the sun's
// beam and scatters.

#include <skybark/kernels/scatter_cells.hpp>
#include <skybark/shared/attenuation.hpp>

namespace skybark::kernels {

/// No buffers. Volume 0: attenuation at the centres of voxels; none lies above and beside it, and
/// below it all goes on. Targets: extinction (1/m), what of the beam is scattered (1/m, of the
/// sun's irradiance), and the beam at the cell's top, each a mean over four columns. The beam's
/// source is what it loses between the cell's top and bottom, so that no light is lost to the grid.
struct scatter_medium {
    using buffers = buffer_list<>;
    static constexpr std::uint32_t volumes = 1;
    static constexpr std::uint32_t volume_targets = 3;

    float extinction = 1; ///< 1/m of a cell whose four columns attenuate by a sum of 1
    float kept = 1;       ///< the beam's depth over the attenuation in the volume
    float scattered = 1;  ///< 1/m of the sum of what four columns take out of the beam

    template <class Grids>
    void voxel(glm::ivec3 at, const Grids& grids) const {
        float depth = 0;
        float lost = 0;
        float beam = 0;
        for (int c = 0; c < 4; ++c) {
            const int x = 2 * at.x + (c & 1);
            const int z = 2 * at.z + (c >> 1);
            const float top = face({x, 2 * at.y + 2, z}, grids);
            const float bottom = face({x, 2 * at.y, z}, grids);
            const float lit = shared::exp_minus(kept * top);
            depth += glm::max(bottom - top, 0.0f);
            lost += glm::max(lit - shared::exp_minus(kept * bottom), 0.0f);
            beam += lit;
        }
        grids.store(0, at, extinction * depth);
        grids.store(1, at, scattered * lost);
        grids.store(2, at, 0.25f * beam);
    }

  private:
    /// Between the voxel and the one below it.
    template <class Grids>
    [[nodiscard]] static float face(glm::ivec3 at, const Grids& grids) {
        return 0.5f *
               (attenuation({at.x, glm::max(at.y - 1, 0), at.z}, grids) + attenuation(at, grids));
    }
    template <class Grids>
    [[nodiscard]] static float attenuation(glm::ivec3 at, const Grids& grids) {
        return within(at, grids.size(0)) ? glm::max(grids.load(0, at), 0.0f) : 0.0f;
    }
};

} // namespace skybark::kernels
