#pragma once
// bundle_more: how many samples a further pass has: all, where a cell is crowded, or none.

#include <skybark/core/kernel.hpp>

namespace skybark::kernels {

/// Buffers: crowded: how many rows of bundle_crowds are; a count_record. Maps over one element.
struct bundle_more {
    using buffers = buffer_list<readonly<std::uint32_t>, writeonly<count_record>>;

    std::uint32_t samples = 0;

    void map(std::uint32_t i, std::span<const std::uint32_t> crowded,
             std::span<count_record> more) const {
        const std::uint32_t count = crowded[i] != 0 ? samples : 0;
        more[i].written = count;
        more[i].required = count;
    }
};
static_assert(sizeof(bundle_more) == 4);

} // namespace skybark::kernels
