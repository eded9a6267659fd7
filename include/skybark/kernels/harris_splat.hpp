#pragma once
// harris_splat: draws one particle over the light buffer of Harris's light pass (Harris and Lastra
// 2001, "Real-Time Cloud Rendering"; Shimada et al. 2008, eq. 1-4).

#include <skybark/core/kernel.hpp>
#include <skybark/shared/attenuation.hpp>

namespace skybark::kernels {

/// What comes through the k-th particle, and what it scatters forward of the light that was read
/// back for it. An element is a pixel of a square around the particle. Buffers: particles; their
/// order; the light buffer, before and after (one buffer may be both). An albedo that is no number
/// or below 0 counts as 0, one above 1 as 1.
struct harris_splat {
    using buffers = buffer_list<readonly<cloud_particle>, readonly<std::uint32_t>, readonly<float>,
                                writeonly<float>>;

    light_grid grid; ///< its x and z are the buffer's columns and rows
    float sigmas = 3;
    float forward = 0;  ///< the phase function straight on, 1 over the sphere
    float incoming = 1; ///< I_k, read back
    std::uint32_t k = 0;
    std::uint32_t columns = 0;
    std::uint32_t rows = 0;
    std::uint32_t side = 0; ///< of the square, pixels

    void map(std::uint32_t pixel, std::span<const cloud_particle> particles,
             std::span<const std::uint32_t> order, std::span<const float> before,
             std::span<float> after) const {
        const cloud_particle& p = particles[order[k]];
        const glm::vec3 cells = shared::holdable_cells_of(grid, p.position);
        const std::int32_t x = first(cells.x, shared::holdable(p.radius / grid.voxel.x)) +
                               static_cast<std::int32_t>(pixel % side);
        const std::int32_t z = first(cells.z, shared::holdable(p.radius / grid.voxel.z)) +
                               static_cast<std::int32_t>(pixel / side);
        if (x < 0 || z < 0 || x >= static_cast<std::int32_t>(columns) ||
            z >= static_cast<std::int32_t>(rows)) {
            return;
        }
        const float dx = (static_cast<float>(x) + 0.5f - cells.x) * grid.voxel.x;
        const float dz = (static_cast<float>(z) + 0.5f - cells.z) * grid.voxel.z;
        const float depth = shared::particle_attenuation(p, dx * dx + dz * dz, sigmas, 0, 0);
        if (depth > 0) {
            const std::uint32_t at =
                static_cast<std::uint32_t>(z) * columns + static_cast<std::uint32_t>(x);
            after[at] = shared::exp_minus(depth) * before[at] +
                        shared::bounded(p.albedo, 1.0f) * depth * forward * incoming;
        }
    }

  private:
    /// The first pixel whose middle may lie in the particle.
    [[nodiscard]] static std::int32_t first(float centre, float radius) {
        return static_cast<std::int32_t>(glm::ceil(centre - radius - 0.5f));
    }
};
static_assert(sizeof(harris_splat) <= max_kernel_bytes);

} // namespace skybark::kernels
