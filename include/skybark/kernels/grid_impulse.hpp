#pragma once
// grid_impulse: what each voxel of the light's grid takes out of the light, for a cloud that is
// given as a dense grid of extinction.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/attenuation.hpp>

namespace skybark::kernels {

/// No buffers. Volume 0: extinction in a box of the world. Target 0: attenuation along y through
/// each voxel, the mean of samples³ places in it.
struct grid_impulse {
    using buffers = buffer_list<>;
    static constexpr std::uint32_t volumes = 1;
    static constexpr std::uint32_t volume_targets = 1;

    light_grid grid;
    glm::vec4 low{0}; ///< xyz: the corner of the density grid, m; w: 1/m that a density of 1 means
    glm::vec4 inverse{1}; ///< xyz: one over its sides, 1/m; w: samples along each axis of a voxel

    template <class Grids>
    void voxel(glm::ivec3 at, const Grids& grids) const {
        const auto samples = static_cast<std::int32_t>(inverse.w);
        float sum = 0;
        for (std::int32_t k = 0; k < samples * samples * samples; ++k) {
            const glm::vec3 part(static_cast<float>(k % samples),
                                 static_cast<float>(k / samples % samples),
                                 static_cast<float>(k / (samples * samples)));
            const glm::vec3 cells =
                glm::vec3(at) + (part + glm::vec3(0.5f)) / static_cast<float>(samples);
            const glm::vec3 place =
                (shared::place_of(grid, cells) - glm::vec3(low)) * glm::vec3(inverse);
            sum += inside(place) ? grids.sample(0, place) : 0.0f;
        }
        grids.store(0, at,
                    sum * low.w * grid.voxel.y / static_cast<float>(samples * samples * samples));
    }

  private:
    [[nodiscard]] static bool inside(glm::vec3 p) {
        return p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1 && p.z >= 0 && p.z <= 1;
    }
};
static_assert(sizeof(grid_impulse) == 112);

} // namespace skybark::kernels
