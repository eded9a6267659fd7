#pragma once
// bundle_crowds: whether cells have so many triangles that one pass over them is not enough.

#include <skybark/core/kernel.hpp>

namespace skybark::kernels {

/// Buffers: sorted keys; crowds: 1 where the i-th `stride` keys in a row are all the same. A cell
/// with twice as many triangles has such a row. Maps over rows.
struct bundle_crowds {
    using buffers = buffer_list<readonly<std::uint32_t>, writeonly<std::uint32_t>>;

    std::uint32_t stride = 1;

    void map(std::uint32_t i, std::span<const std::uint32_t> keys,
             std::span<std::uint32_t> crowds) const {
        const std::size_t first = std::size_t{i} * stride;
        crowds[i] = keys[first] == keys[first + stride - 1] ? 1 : 0;
    }
};
static_assert(sizeof(bundle_crowds) == 4);

} // namespace skybark::kernels
