#pragma once
// harris_splat on the CPU: what the pixels of a particle have in common is made once, rows end
// where the particle does, and the depths of a row are made eight at a time where there is AVX2.
// The operations and their order are the kernel's own, and so are the bits.

#include <skybark/cpu/eight.hpp>
#include <skybark/cpu/program.hpp>
#include <skybark/kernels/harris_splat.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace skybark::cpu {

template <>
struct program<kernels::harris_splat> : plain_program<kernels::harris_splat> {
    using kernel_type = kernels::harris_splat;

    static void map(const kernel_type& k, range elements, std::span<const cloud_particle> particles,
                    std::span<const std::uint32_t> order, std::span<const float> before,
                    std::span<float> after) {
        if (elements.first != 0 || elements.count != k.side * k.side || k.side > most_columns) {
            plain_program<kernel_type>::map(k, elements, particles, order, before, after);
            return;
        }
        const cloud_particle& p = particles[order[k.k]];
        const glm::vec3 cells = shared::holdable_cells_of(k.grid, p.position);
        const light_grid& grid = k.grid;
        const int top = first(cells.z, shared::holdable(p.radius / grid.voxel.z));
        const int left = first(cells.x, shared::holdable(p.radius / grid.voxel.x));
        const int bottom = std::min(top + static_cast<int>(k.side), static_cast<int>(k.rows));
        const int right = std::min(left + static_cast<int>(k.side), static_cast<int>(k.columns));
        const float albedo = shared::bounded(p.albedo, 1.0f);
        std::array<float, most_columns + 8> depths;
        for (int z = std::max(top, 0); z < bottom; ++z) {
            const float dz = (static_cast<float>(z) + 0.5f - cells.z) * grid.voxel.z;
            // Beyond this nothing is left; a pixel more is harmless.
            const float half = shared::holdable(
                std::sqrt(std::max(p.radius * p.radius - dz * dz, 0.0f)) / grid.voxel.x);
            const int begin = std::max({left, 0, static_cast<int>(cells.x - half) - 1});
            const int end = std::min(right, static_cast<int>(cells.x + half) + 2);
            find_depths(k, p, cells.x, dz, begin, end, depths.data());
            for (int x = begin; x < end; ++x) {
                const float depth = depths[static_cast<std::size_t>(x - begin)];
                if (depth > 0) {
                    const auto at =
                        static_cast<std::size_t>(z) * k.columns + static_cast<std::size_t>(x);
                    after[at] = shared::exp_minus(depth) * before[at] +
                                albedo * depth * k.forward * k.incoming;
                }
            }
        }
    }

  private:
    static constexpr std::uint32_t most_columns = 504;

    [[nodiscard]] static int first(float centre, float radius) {
        return static_cast<int>(std::ceil(centre - radius - 0.5f));
    }

    /// Optical depths at the middles of the pixels [begin, end) of a row that passes the particle's
    /// centre at `dz` metres; up to seven more are written.
    static void find_depths(const kernel_type& k, const cloud_particle& p, float centre, float dz,
                            int begin, int end, float* depths) {
#if defined(SKYBARK_HAS_EIGHT)
        if (__builtin_cpu_supports("avx2")) {
            return find_depths_by_eights(k, p, centre, dz, begin, end, depths);
        }
#endif
        for (int x = begin; x < end; ++x) {
            const float dx = (static_cast<float>(x) + 0.5f - centre) * k.grid.voxel.x;
            depths[x - begin] = shared::particle_attenuation(p, dx * dx + dz * dz, k.sigmas, 0, 0);
        }
    }

#if defined(SKYBARK_HAS_EIGHT)
    [[gnu::target("avx2")]] static void find_depths_by_eights(const kernel_type& k,
                                                              const cloud_particle& p, float centre,
                                                              float dz, int begin, int end,
                                                              float* depths) {
        using namespace eight;
        const f8 r2 = splat<f8>(p.radius * p.radius);
        const f8 steepness = splat<f8>(0.5f * k.sigmas * k.sigmas);
        const f8 depth = splat<f8>(shared::bounded(p.optical_depth, 1e6f));
        const f8 lanes = _mm256_setr_ps(0, 1, 2, 3, 4, 5, 6, 7);
        for (int x = begin; x < end; x += 8) {
            const f8 column = plus(splat<f8>(static_cast<float>(x)), lanes);
            const f8 dx = times(minus(plus(column, splat<f8>(0.5f)), splat<f8>(centre)),
                                splat<f8>(k.grid.voxel.x));
            const f8 d2 = plus(times(dx, dx), splat<f8>(dz * dz));
            const f8 tau = times(depth, exp_minus(over(times(steepness, d2), r2)));
            _mm256_storeu_ps(depths + (x - begin), _mm256_and_ps(less(d2, r2), tau));
        }
    }
#endif
};

} // namespace skybark::cpu
