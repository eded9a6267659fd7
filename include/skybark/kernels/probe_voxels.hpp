#pragma once
// probe_voxels: a map over voxels that exists to be checked. It reads two volumes and writes two.

#include <skybark/core/kernel.hpp>

namespace skybark::kernels {

/// Volumes: 0 is loaded, 1 is sampled; the targets may have other sizes than they. Buffers: a
/// weight for each z, and a number for each voxel of the extent.
///  - Target 0 gets the weight of its z times the sum of the voxel of volume 0 and its neighbours
///    on both sides along the axes. Those beyond a border count as 0, and so does a voxel there.
///  - Target 1 gets a sample of volume 1 at (voxel + ½ + shift) / its own size.
///  - The number of the voxel is where it lies in the extent, x first, and the size of volume 0's
///    x side in the upper 8 bits.
struct probe_voxels {
    using buffers = buffer_list<readonly<glm::vec4>, writeonly<std::uint32_t>>;
    static constexpr std::uint32_t volumes = 2;
    static constexpr std::uint32_t volume_targets = 2;

    std::int32_t extent_x = 1;
    std::int32_t extent_y = 1;
    float shift = 0; ///< voxels of volume 1, along all axes

    template <class Grids>
    void voxel(glm::ivec3 at, const Grids& grids, std::span<const glm::vec4> weights,
               std::span<std::uint32_t> numbers) const {
        float sum = loaded(at, grids);
        sum += loaded(at + glm::ivec3(1, 0, 0), grids) + loaded(at - glm::ivec3(1, 0, 0), grids);
        sum += loaded(at + glm::ivec3(0, 1, 0), grids) + loaded(at - glm::ivec3(0, 1, 0), grids);
        sum += loaded(at + glm::ivec3(0, 0, 1), grids) + loaded(at - glm::ivec3(0, 0, 1), grids);
        grids.store(0, at, weights[static_cast<std::uint32_t>(at.z)].x * sum);
        const glm::vec3 place = (glm::vec3(at) + 0.5f + shift) / glm::vec3(grids.size(1));
        grids.store(1, at, grids.sample(1, place));
        const std::int32_t number = (at.z * extent_y + at.y) * extent_x + at.x;
        numbers[static_cast<std::uint32_t>(number)] =
            static_cast<std::uint32_t>(number) +
            (static_cast<std::uint32_t>(grids.size(0).x) << 24);
    }

  private:
    template <class Grids>
    [[nodiscard]] static float loaded(glm::ivec3 at, const Grids& grids) {
        const glm::ivec3 size = grids.size(0);
        const bool inside =
            at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < size.x && at.y < size.y && at.z < size.z;
        return inside ? grids.load(0, at) : 0.0f;
    }
};

} // namespace skybark::kernels
