#pragma once
// What the kernels that put particles into a light's grid have in common.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/attenuation.hpp>

#include <algorithm>
#include <cmath>

namespace skybark::kernels {

/// A light's grid and how particles darken it: the parameters of `particle_impulse`, `shadow_slab`
/// and `shadow_polygon`.
struct particle_shade {
    light_grid grid;
    float sigmas = 3;          ///< standard deviations in a particle's radius
    float forward = 0;         ///< see shared/attenuation.glsl
    std::uint32_t light = 0;   ///< 0 extinction, 1 continuum, 2 product
    std::uint32_t profile = 0; ///< 0 step, 1 erf
    std::uint32_t slices = 0;  ///< n_pmax: layers that a particle may cut
    std::uint32_t reserved[3] = {0, 0, 0};

    /// A particle in voxels.
    struct placed {
        glm::vec3 centre;
        glm::vec3 radius;
    };
    [[nodiscard]] placed place(const cloud_particle& p) const {
        return {shared::holdable_cells_of(grid, p.position),
                glm::vec3(shared::holdable(p.radius / grid.voxel.x),
                          shared::holdable(p.radius / grid.voxel.y),
                          shared::holdable(p.radius / grid.voxel.z))};
    }
    /// The first layer whose middle lies in the particle, and how many there are (n_p).
    [[nodiscard]] std::int32_t first_slice(const placed& p) const {
        return static_cast<std::int32_t>(std::ceil(p.centre.z - p.radius.z - 0.5f));
    }
    [[nodiscard]] std::uint32_t slice_count(const placed& p) const {
        const auto last = static_cast<std::int32_t>(std::floor(p.centre.z + p.radius.z - 0.5f));
        const std::int32_t count = last - first_slice(p) + 1;
        return count > 0 ? std::min(static_cast<std::uint32_t>(count), slices) : 0;
    }
    /// −ln G in quanta, on a line through the middle of column (x, z).
    [[nodiscard]] float lateral(const cloud_particle& p, const placed& at, std::int32_t x,
                                std::int32_t z) const {
        const float dx = (static_cast<float>(x) + 0.5f - at.centre.x) * grid.voxel.x;
        const float dz = (static_cast<float>(z) + 0.5f - at.centre.z) * grid.voxel.z;
        const float amount =
            shared::particle_attenuation(p, dx * dx + dz * dz, sigmas, light, forward);
        return shared::summable(amount / grid.voxel.w);
    }
    /// What part of a particle lies above the middle of row y.
    [[nodiscard]] float part_above(const placed& p, std::int32_t y) const {
        return shared::part_above(profile, y, p.centre.y, p.radius.y, sigmas);
    }
};
static_assert(sizeof(particle_shade) == 112);

} // namespace skybark::kernels
