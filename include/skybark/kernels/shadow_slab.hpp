#pragma once
// shadow_slab: the shadow polygons of the paper (Shimada et al. 2008, 3.3 and 4.1).
//
// A particle darkens a cylinder from itself downwards, away from the sun. Every layer of constant z
// cuts it in a rectangle, from a radius above the particle to the bottom of the volume. A particle
// has n_p of them; with degenerate padding it is given n_pmax, the spare ones degenerate.

#include <skybark/kernels/particle_slices.hpp>

namespace skybark::kernels {

/// A corner of a shadow polygon, in voxels, and whose it is. Zero bytes in a degenerate one.
struct shadow_corner {
    float x = 0;
    float y = 0;
    float slice = 0;    ///< the layer's number
    float particle = 0; ///< its number, below 2^24
};
static_assert(sizeof(shadow_corner) == 16);

/// Buffer: particles. To `expand`: a strip of two triangles a layer. To `accumulate`: the same
/// rectangles where they are drawn, without a list in between.
struct shadow_slab {
    using buffers = buffer_list<readonly<cloud_particle>>;
    using vertex = shadow_corner;

    particle_shade shade;

    [[nodiscard]] std::uint32_t strips() const { return shade.slices; }
    [[nodiscard]] std::uint32_t strip_triangles() const { return 2; }
    [[nodiscard]] std::uint32_t triangles(std::uint32_t i, std::uint32_t s,
                                          std::span<const cloud_particle> particles) const {
        return s < slab_count(i, particles) ? 2 : 0;
    }
    template <class Sink>
    void strip(std::uint32_t i, std::uint32_t s, std::uint32_t first, std::uint32_t count,
               Sink& sink, std::span<const cloud_particle> particles) const {
        const particle_shade::placed at = shade.place(particles[i]);
        const auto slice = static_cast<float>(shade.first_slice(at) + static_cast<std::int32_t>(s));
        for (std::uint32_t v = first; v < first + count; ++v) {
            sink(vertex{v % 2 == 0 ? at.centre.x - at.radius.x : at.centre.x + at.radius.x,
                        v < 2 ? 0.0f : at.centre.y + at.radius.y, slice, static_cast<float>(i)});
        }
    }

    [[nodiscard]] std::uint32_t slabs() const { return shade.slices; }
    [[nodiscard]] std::uint32_t slab_count(std::uint32_t i,
                                           std::span<const cloud_particle> particles) const {
        return shade.slice_count(shade.place(particles[i]));
    }
    [[nodiscard]] voxel_slab slab(std::uint32_t i, std::uint32_t s,
                                  std::span<const cloud_particle> particles) const {
        const particle_shade::placed at = shade.place(particles[i]);
        return {{static_cast<std::int32_t>(std::ceil(at.centre.x - at.radius.x - 0.5f)), 0},
                {static_cast<std::int32_t>(std::ceil(at.centre.x + at.radius.x - 0.5f)),
                 shared::top_row(at.centre.y, at.radius.y) + 1},
                shade.first_slice(at) + static_cast<std::int32_t>(s)};
    }
    [[nodiscard]] float lateral(std::uint32_t i, std::int32_t x, std::int32_t z,
                                std::span<const cloud_particle> particles) const {
        return shade.lateral(particles[i], shade.place(particles[i]), x, z);
    }
    [[nodiscard]] float row(std::uint32_t i, std::int32_t y,
                            std::span<const cloud_particle> particles) const {
        return shade.part_above(shade.place(particles[i]), y);
    }
    [[nodiscard]] std::int32_t amount(float lateral, float row, float) const {
        return shared::quanta(lateral * row);
    }
};

} // namespace skybark::kernels
