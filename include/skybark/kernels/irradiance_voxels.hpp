#pragma once
// irradiance_voxels: light from all around at the points of a grid, into the volume that it is
// looked up in.

#include <skybark/core/kernel.hpp>

namespace skybark::kernels {

/// Buffers: harmonics, six vec4s a point, x first: red, green and blue of the half space above it,
/// and of that below. Volume target: x · 12 y · z voxels, coefficient k of the point (x, y, z) at
/// (x, k · points_y + y, z): four each of red, green and blue, of both half spaces. Maps over the
/// voxels.
///
/// The directions m_i above that were gathered along are not quite even: an even half space would
/// get a first-order light of Σ m_i / D in place of n / 2. What is known to be off for the mean
/// light of each half is taken out (a control variate), so that such half spaces are exact.
struct irradiance_voxels {
    using buffers = buffer_list<readonly<glm::vec4>>;
    static constexpr std::uint32_t volume_targets = 1;

    glm::vec4 tilt{0}; ///< √3 (Σ m_i / D − n / 2), as coefficients lie: 0, y, z, x
    std::int32_t points_x = 1;
    std::int32_t points_y = 1;

    template <class Grids>
    void voxel(glm::ivec3 at, const Grids& grids, std::span<const glm::vec4> harmonics) const {
        const std::int32_t k = at.y / points_y;
        const std::int32_t y = at.y - k * points_y;
        const std::int32_t point = (at.z * points_y + y) * points_x + at.x;
        const auto at_above = static_cast<std::uint32_t>(6 * point + k / 4);
        const glm::vec4 above = harmonics[at_above];
        const glm::vec4 below = harmonics[at_above + 3];
        const glm::vec4 all = (above + below) - tilt * (above.x - below.x);
        grids.store(0, at, all[k % 4]);
    }
};
static_assert(sizeof(irradiance_voxels) == 24);

} // namespace skybark::kernels
