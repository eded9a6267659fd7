#pragma once
// density_grid: a box of the world with a density in each voxel.

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace skybark::io {

/// Voxel (i, j, k) reaches from low + voxel · (i, j, k) to one voxel further.
struct density_grid {
    glm::vec3 low{0};           ///< m, the box's lowest corner
    glm::vec3 voxel{1};         ///< m, the sides of a voxel, > 0
    glm::uvec3 voxels{0};       ///< how many along x, y and z
    std::vector<float> density; ///< ≥ 0; x runs fastest, then y, then z

    [[nodiscard]] glm::vec3 sides() const { return voxel * glm::vec3(voxels); }
};

} // namespace skybark::io
