#pragma once
// scatter_source: what the sun's beam gives to the diffuse light of each cell.

#include <skybark/kernels/scatter_cells.hpp>

namespace skybark::kernels {

/// No buffers. Volumes: what of the beam is scattered, the beam at the cell's top, extinction,
/// resistance. Target 0: source, 1/m. Light that is scattered rather forwards goes on a little
/// before it is diffuse: it moves from each cell to the one below.
struct scatter_source {
    using buffers = buffer_list<>;
    static constexpr std::uint32_t volumes = 4;
    static constexpr std::uint32_t volume_targets = 1;

    float moment = 0; ///< 3 g' times the part of extinction that scatters, over the cell's height

    template <class Grids>
    void voxel(glm::ivec3 at, const Grids& grids) const {
        const glm::ivec3 above(at.x, at.y + 1, at.z);
        const float gained =
            above.y < grids.size(0).y ? moved(grids.load(1, at), at, above, grids) : 0.0f;
        const glm::ivec3 below(at.x, at.y - 1, at.z);
        const float lost = at.y > 0 ? moved(grids.load(1, below), at, below, grids) : 0.0f;
        grids.store(0, at, grids.load(0, at) + (gained - lost));
    }

  private:
    template <class Grids>
    [[nodiscard]] float moved(float beam, glm::ivec3 a, glm::ivec3 b, const Grids& grids) const {
        return shared::scatter_moment(moment, beam, grids.load(2, a), grids.load(2, b),
                                      grids.load(3, a), grids.load(3, b));
    }
};

} // namespace skybark::kernels
