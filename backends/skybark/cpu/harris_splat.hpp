#pragma once
// harris_splat on the CPU: what the pixels of a particle have in common is made once, and rows end
// where the particle does. Pixel for pixel the kernel's own formula, and its bits.

#include <skybark/cpu/program.hpp>
#include <skybark/kernels/harris_splat.hpp>

#include <algorithm>
#include <cmath>

namespace skybark::cpu {

template <>
struct program<kernels::harris_splat> : plain_program<kernels::harris_splat> {
    using kernel_type = kernels::harris_splat;

    static void map(const kernel_type& k, range elements, std::span<const cloud_particle> particles,
                    std::span<const std::uint32_t> order, std::span<const float> before,
                    std::span<float> after) {
        if (elements.first != 0 || elements.count != k.side * k.side) {
            plain_program<kernel_type>::map(k, elements, particles, order, before, after);
            return;
        }
        const cloud_particle& p = particles[order[k.k]];
#if defined(__GNUC__) && defined(__x86_64__)
        if (__builtin_cpu_supports("sse4.1")) {
            return splat_rounding(k, p, before, after);
        }
#endif
        splat(k, p, before, after);
    }

  private:
    [[gnu::always_inline]] static inline void splat(const kernel_type& k, const cloud_particle& p,
                                                    std::span<const float> before,
                                                    std::span<float> after) {
        const glm::vec3 cells = shared::cells_of(k.grid, p.position);
        const light_grid& grid = k.grid;
        const int top = first(cells.z, p.radius / grid.voxel.z);
        const int left = first(cells.x, p.radius / grid.voxel.x);
        const int bottom = std::min(top + static_cast<int>(k.side), static_cast<int>(k.rows));
        const int right = std::min(left + static_cast<int>(k.side), static_cast<int>(k.columns));
        for (int z = std::max(top, 0); z < bottom; ++z) {
            const float dz = (static_cast<float>(z) + 0.5f - cells.z) * grid.voxel.z;
            const auto row = static_cast<std::size_t>(z) * k.columns;
            // Beyond this nothing is left; a pixel more is harmless.
            const float half =
                std::sqrt(std::max(p.radius * p.radius - dz * dz, 0.0f)) / grid.voxel.x;
            const int begin = std::max({left, 0, static_cast<int>(cells.x - half) - 1});
            const int end = std::min(right, static_cast<int>(cells.x + half) + 2);
            for (int x = begin; x < end; ++x) {
                const float dx = (static_cast<float>(x) + 0.5f - cells.x) * grid.voxel.x;
                const float depth =
                    shared::particle_attenuation(p, dx * dx + dz * dz, k.sigmas, 0, 0);
                if (depth > 0) {
                    const auto at = row + static_cast<std::size_t>(x);
                    after[at] = shared::exp_minus(depth) * before[at] +
                                p.albedo * depth * k.forward * k.incoming;
                }
            }
        }
    }

#if defined(__GNUC__) && defined(__x86_64__)
    /// The same where rounding down is an instruction and not a call.
    [[gnu::target("sse4.1")]] static void splat_rounding(const kernel_type& k,
                                                         const cloud_particle& p,
                                                         std::span<const float> before,
                                                         std::span<float> after) {
        splat(k, p, before, after);
    }
#endif

    [[nodiscard]] static int first(float centre, float radius) {
        return static_cast<int>(std::ceil(centre - radius - 0.5f));
    }
};

} // namespace skybark::cpu
