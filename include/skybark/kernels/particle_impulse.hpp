#pragma once
// particle_impulse: what each voxel has to gain so that a running sum against the light gives the
// attenuation volume.
//
// The shadow column of the paper (Shimada et al. 2008, 3.3) is the running sum of one impulse at
// its top; with the erf profile the impulse is the particle's own depth along y. Either way the
// whole numbers add up to those that `shadow_polygon` adds row by row, so both give the same bits.

#include <skybark/kernels/particle_slices.hpp>

namespace skybark::kernels {

/// Buffer: particles. A slab a layer that the particle cuts, as wide as the particle is there.
struct particle_impulse {
    using buffers = buffer_list<readonly<cloud_particle>>;

    particle_shade shade;

    [[nodiscard]] std::uint32_t slabs() const { return shade.slices; }

    [[nodiscard]] std::uint32_t slab_count(std::uint32_t i,
                                           std::span<const cloud_particle> particles) const {
        return shade.slice_count(shade.place(particles[i]));
    }

    [[nodiscard]] voxel_slab slab(std::uint32_t i, std::uint32_t s,
                                  std::span<const cloud_particle> particles) const {
        const cloud_particle& p = particles[i];
        const particle_shade::placed at = shade.place(p);
        const std::int32_t z = shade.first_slice(at) + static_cast<std::int32_t>(s);
        const float dz = (static_cast<float>(z) + 0.5f - at.centre.z) * shade.grid.voxel.z;
        const float reach = shared::holdable(
            std::sqrt(std::max(p.radius * p.radius - dz * dz, 0.0f)) / shade.grid.voxel.x);
        const int top = shared::top_row(at.centre.y, at.radius.y);
        const int bottom =
            shade.profile == 0 ? top : std::min(top, shared::bottom_row(at.centre.y, at.radius.y));
        // Half a voxel less would do, but for rounding; beyond the radius nothing is added.
        return {{static_cast<std::int32_t>(std::floor(at.centre.x - reach)), bottom},
                {static_cast<std::int32_t>(std::floor(at.centre.x + reach)) + 1, top + 1},
                z};
    }

    [[nodiscard]] float lateral(std::uint32_t i, std::int32_t x, std::int32_t z,
                                std::span<const cloud_particle> particles) const {
        return shade.lateral(particles[i], shade.place(particles[i]), x, z);
    }

    [[nodiscard]] float row(std::uint32_t i, std::int32_t y,
                            std::span<const cloud_particle> particles) const {
        return shade.part_above(shade.place(particles[i]), y);
    }

    /// Each row's quanta are rounded by themselves, as `shadow_polygon` rounds them.
    [[nodiscard]] std::int32_t amount(float lateral, float row, float above) const {
        return shared::quanta(lateral * row) - shared::quanta(lateral * above);
    }
};

} // namespace skybark::kernels
