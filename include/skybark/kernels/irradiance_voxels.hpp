#pragma once
// irradiance_voxels: light from all around at the points of a grid, into the volume that it is
// looked up in.

#include <skybark/core/kernel.hpp>

namespace skybark::kernels {

/// Buffers: harmonics, six vec4s a point, x first: red, green and blue of the half space above it,
/// and of that below. Volume target: x · 12 y · z voxels, coefficient k of the point (x, y, z) at
/// (x, k · points_y + y, z): four each of red, green and blue. Maps over the voxels.
struct irradiance_voxels {
    using buffers = buffer_list<readonly<glm::vec4>>;
    static constexpr std::uint32_t volume_targets = 1;

    std::int32_t points_x = 1;
    std::int32_t points_y = 1;

    template <class Grids>
    void voxel(glm::ivec3 at, const Grids& grids, std::span<const glm::vec4> harmonics) const {
        const std::int32_t k = at.y / points_y;
        const std::int32_t y = at.y - k * points_y;
        const std::int32_t point = (at.z * points_y + y) * points_x + at.x;
        const std::int32_t above = 6 * point + k / 4;
        const glm::vec4 all = harmonics[static_cast<std::uint32_t>(above)] +
                              harmonics[static_cast<std::uint32_t>(above + 3)];
        grids.store(0, at, all[k % 4]);
    }
};
static_assert(sizeof(irradiance_voxels) == 8);

} // namespace skybark::kernels
