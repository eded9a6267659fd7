#pragma once
// shadow_polygon: adds a list of shadow polygons to the attenuation volume (Shimada et al. 2008,
// 4.2: the addition of logarithms in place of the product of eq. 7).

#include <skybark/kernels/shadow_slab.hpp>

namespace skybark::kernels {

/// Buffers: particles, and the triangles that `shadow_slab` expanded into. Elements are triangles;
/// those of even number stand for the rectangle that they begin.
struct shadow_polygon {
    using buffers = buffer_list<readonly<cloud_particle>, readonly<shadow_corner>>;

    particle_shade shade;

    [[nodiscard]] std::uint32_t slabs() const { return 1; }
    [[nodiscard]] std::uint32_t slab_count(std::uint32_t i, std::span<const cloud_particle>,
                                           std::span<const shadow_corner> corners) const {
        return i % 2 == 0 && corners[3 * i].x != corners[3 * i + 1].x ? 1 : 0;
    }
    [[nodiscard]] voxel_slab slab(std::uint32_t i, std::uint32_t, std::span<const cloud_particle>,
                                  std::span<const shadow_corner> corners) const {
        const shadow_corner& low = corners[3 * i];
        const shadow_corner& high = corners[3 * i + 5];
        return {{static_cast<std::int32_t>(std::ceil(low.x - 0.5f)),
                 static_cast<std::int32_t>(std::ceil(low.y - 0.5f))},
                {static_cast<std::int32_t>(std::ceil(high.x - 0.5f)),
                 static_cast<std::int32_t>(std::ceil(high.y - 0.5f))},
                static_cast<std::int32_t>(low.slice)};
    }
    [[nodiscard]] float lateral(std::uint32_t i, std::int32_t x, std::int32_t z,
                                std::span<const cloud_particle> particles,
                                std::span<const shadow_corner> corners) const {
        const cloud_particle& p = particles[particle_of(i, corners)];
        return shade.lateral(p, shade.place(p), x, z);
    }
    [[nodiscard]] float row(std::uint32_t i, std::int32_t y,
                            std::span<const cloud_particle> particles,
                            std::span<const shadow_corner> corners) const {
        return shade.part_above(shade.place(particles[particle_of(i, corners)]), y);
    }
    [[nodiscard]] std::int32_t amount(float lateral, float row, float) const {
        return shared::quanta(lateral * row);
    }

  private:
    [[nodiscard]] static std::uint32_t particle_of(std::uint32_t i,
                                                   std::span<const shadow_corner> corners) {
        return static_cast<std::uint32_t>(corners[3 * i].particle);
    }
};

} // namespace skybark::kernels
