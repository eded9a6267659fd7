#pragma once
// light_at_points: what an attenuation volume says of single places: how much lies between them and
// the sun, and what light comes through.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/light_at_points.hpp>

#include <cmath>

namespace skybark::kernels {

/// Buffers: places (xyz, m); found: x: attenuation, y: light over that of the sun, z and w: 0. Maps
/// over places. Volume 0: attenuation.
///
/// Between the middles of eight voxels it is linear along each axis, by whole floats: what filters
/// of textures do has fewer digits on some devices. Above the box and beside it nothing is taken
/// out; below it, and within half a voxel of its bottom, the undermost layer goes on.
struct light_at_points {
    using buffers = buffer_list<readonly<glm::vec4>, writeonly<glm::vec4>>;
    static constexpr std::uint32_t volumes = 1;

    light_grid grid;
    /// 1: light is e^−attenuation. More: Wrenninge's octaves without their phase function, their
    /// mean by weight: Σ wⁱ e^(−bⁱ attenuation) / Σ wⁱ.
    std::uint32_t octaves = 1;
    float octave_weight = 0.5f;      ///< w
    float octave_attenuation = 0.5f; ///< b

    template <class Grids>
    void map(std::uint32_t i, const Grids& grids, std::span<const glm::vec4> places,
             std::span<glm::vec4> found) const {
        const glm::vec3 cells = shared::cells_of(grid, glm::vec3(places[i]));
        const float attenuation = attenuation_at(grids, cells);
        found[i] = glm::vec4(
            attenuation,
            shared::octaves_light(attenuation, octaves, octave_weight, octave_attenuation), 0.0f,
            0.0f);
    }

  private:
    template <class Grids>
    [[nodiscard]] static float attenuation_at(const Grids& grids, glm::vec3 cells) {
        const glm::ivec3 size = grids.size(0);
        if (!(cells.x >= 0.0f && cells.x <= static_cast<float>(size.x) && cells.z >= 0.0f &&
              cells.z <= static_cast<float>(size.z) && cells.y <= static_cast<float>(size.y))) {
            return 0.0f;
        }
        const glm::vec3 from(cells.x - 0.5f, glm::max(cells.y - 0.5f, 0.0f), cells.z - 0.5f);
        const glm::vec3 first(std::floor(from.x), std::floor(from.y), std::floor(from.z));
        const glm::vec3 part(from.x - first.x, from.y - first.y, from.z - first.z);
        const auto at = [&](int x, int y, int z) {
            return grids.load(
                0, glm::clamp(glm::ivec3(first) + glm::ivec3(x, y, z), glm::ivec3(0), size - 1));
        };
        const float low =
            shared::bilinear(at(0, 0, 0), at(1, 0, 0), at(0, 0, 1), at(1, 0, 1), part.x, part.z);
        const float high =
            shared::bilinear(at(0, 1, 0), at(1, 1, 0), at(0, 1, 1), at(1, 1, 1), part.x, part.z);
        return low + (high - low) * part.y;
    }
};
static_assert(sizeof(light_at_points) == 92);

} // namespace skybark::kernels
