#pragma once
// light_at_points: what an attenuation volume says of single places: how much lies between them and
// the sun, and what light comes through; and light that a cloud has scattered, where it is known.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/light_at_points.hpp>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace skybark::kernels {

/// Buffers: places (xyz of every `stride`-th vec4, m); found: x: attenuation, y: light over that of
/// the sun, z: the part of it that was scattered more than once, w: 0. Maps over places. Volumes:
/// attenuation; diffuse fluence over the sun's irradiance, or any where `diffuse` is 0.
///
/// Between the middles of eight voxels it is linear along each axis, by whole floats: what filters
/// of textures do has fewer digits on some devices. Above the box and beside it nothing is taken
/// out; below it, and within half a voxel of its bottom, the undermost layer goes on. What was
/// scattered is, outside of the box, that of the nearest place on it, in the measure in which a
/// ball as large as the box is seen from there: an estimate, which is continuous and fades with the
/// square of the distance.
struct light_at_points {
    using buffers = buffer_list<readonly<glm::vec4>, writeonly<glm::vec4>>;
    static constexpr std::uint32_t volumes = 2;

    light_grid grid; ///< of the attenuation
    /// 0 and 1: light is e^−attenuation. More: Wrenninge's octaves without their phase function,
    /// their mean by weight: Σ wⁱ e^(−bⁱ attenuation) / Σ wⁱ.
    std::uint32_t octaves = 1;
    float octave_weight = 0.5f;      ///< w
    float octave_attenuation = 0.5f; ///< b
    float diffuse = 0;        ///< cells of the fluence in a voxel of the attenuation; 0: no fluence
    std::uint32_t stride = 1; ///< vec4s from a place to the next; of gather_samples 2

    template <class Grids>
    void map(std::uint32_t i, const Grids& grids, std::span<const glm::vec4> places,
             std::span<glm::vec4> found) const {
        const glm::vec3 cells = shared::cells_of(grid, glm::vec3(places[std::size_t{i} * stride]));
        const float attenuation = value_at(grids, 0, cells, glm::vec3(grids.size(0)));
        const float light =
            shared::octaves_light(attenuation, octaves, octave_weight, octave_attenuation);
        const float scattered = diffuse > 0.0f ? scattered_at(grids, cells) : 0.0f;
        found[i] = glm::vec4(attenuation, light + scattered, scattered, 0.0f);
    }

  private:
    template <class Grids>
    [[nodiscard]] float scattered_at(const Grids& grids, glm::vec3 cells) const {
        const glm::vec3 size(grids.size(0));
        const glm::vec3 inside = glm::clamp(cells, glm::vec3(0), size);
        const glm::vec3 beyond = (cells - inside) * glm::vec3(grid.voxel);
        const glm::vec3 half_size = 0.5f * size * glm::vec3(grid.voxel);
        const float radius = std::max(std::max(half_size.x, half_size.y), half_size.z);
        const float away =
            std::sqrt(beyond.x * beyond.x + beyond.y * beyond.y + beyond.z * beyond.z);
        return value_at(grids, 1, inside * diffuse, size * diffuse) *
               shared::scattered_part(away, radius);
    }

    /// Of volume `n`, whose cells end at `ends`; 0 above and beside.
    template <class Grids>
    [[nodiscard]] static float value_at(const Grids& grids, std::uint32_t n, glm::vec3 cells,
                                        glm::vec3 ends) {
        if (!(cells.x >= 0.0f && cells.x <= ends.x && cells.z >= 0.0f && cells.z <= ends.z &&
              cells.y <= ends.y)) {
            return 0.0f;
        }
        const glm::ivec3 last = grids.size(n) - 1;
        const glm::vec3 from(cells.x - 0.5f, glm::max(cells.y - 0.5f, 0.0f), cells.z - 0.5f);
        const glm::vec3 first(std::floor(from.x), std::floor(from.y), std::floor(from.z));
        const glm::vec3 part(from.x - first.x, from.y - first.y, from.z - first.z);
        const auto at = [&](int x, int y, int z) {
            return grids.load(
                n, glm::clamp(glm::ivec3(first) + glm::ivec3(x, y, z), glm::ivec3(0), last));
        };
        const float low =
            shared::bilinear(at(0, 0, 0), at(1, 0, 0), at(0, 0, 1), at(1, 0, 1), part.x, part.z);
        const float high =
            shared::bilinear(at(0, 1, 0), at(1, 1, 0), at(0, 1, 1), at(1, 1, 1), part.x, part.z);
        return low + (high - low) * part.y;
    }
};
static_assert(sizeof(light_at_points) == 100);

} // namespace skybark::kernels
