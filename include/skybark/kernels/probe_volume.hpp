#pragma once
// probe_volume: a map over records that exists to be checked. It reads two volumes and writes one.

#include <skybark/core/kernel.hpp>

namespace skybark::kernels {

/// Where to look, and where to write.
struct probe_place {
    glm::vec4 place{0}; ///< xyz: 0…1 is edge to edge
    glm::ivec4 cell{0}; ///< xyz: inside both volumes and the target; w: written where not 0
};
static_assert(sizeof(probe_place) == 32);

/// Buffers: places; values: samples of volumes 0 and 1, and what is loaded from their cell; sizes:
/// of volume 0 where i is even, else of volume 1. The target's cell gets i + first.
struct probe_volume {
    using buffers = buffer_list<readonly<probe_place>, writeonly<glm::vec4>, writeonly<glm::ivec4>>;
    static constexpr std::uint32_t volumes = 2;
    static constexpr std::uint32_t volume_targets = 1;

    float first = 0;

    template <class Grids>
    void map(std::uint32_t i, const Grids& grids, std::span<const probe_place> places,
             std::span<glm::vec4> values, std::span<glm::ivec4> sizes) const {
        const glm::vec3 place(places[i].place);
        const glm::ivec3 cell(places[i].cell);
        values[i] = {grids.sample(0, place), grids.sample(1, place), grids.load(0, cell),
                     grids.load(1, cell)};
        sizes[i] = glm::ivec4(i % 2 == 0 ? grids.size(0) : grids.size(1), 0);
        if (places[i].cell.w != 0) {
            grids.store(0, cell, static_cast<float>(i) + first);
        }
    }
};

} // namespace skybark::kernels
