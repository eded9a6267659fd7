#pragma once
// bundle_count: how many triangles each cell of a bundle's grids has.

#include <skybark/core/kernel.hpp>

namespace skybark::kernels {

/// Buffers: runs (begin, end), counts. Maps over cells.
struct bundle_count {
    using buffers = buffer_list<readonly<glm::uvec2>, writeonly<std::uint32_t>>;

    void map(std::uint32_t i, std::span<const glm::uvec2> runs,
             std::span<std::uint32_t> counts) const {
        counts[i] = runs[i].y - runs[i].x;
    }
};

} // namespace skybark::kernels
