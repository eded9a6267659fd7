#pragma once
// merge_ends: the ends of chains whose segments are drawn as one, on their way to being left out.

#include <skybark/kernels/merge_chains.hpp>

namespace skybark::kernels {

/// Buffers: ends, their shares, the chains' detail, the ends that are drawn. Maps over ends.
struct merge_ends {
    using buffers = buffer_list<readonly<branch_end>, readonly<chain_share>, readonly<chain_detail>,
                                writeonly<branch_end>>;

    void map(std::uint32_t i, std::span<const branch_end> ends, std::span<const chain_share> shares,
             std::span<const chain_detail> chains, std::span<branch_end> merged) const {
        const chain_share& share = shares[i];
        const chain_detail& chain = chains[share.chain];
        const std::uint32_t stride = chain.stride;
        merged[i] = ends[i];
        if (chain.fraction < 1 && i != chain.last && share.place % (2 * stride) == stride) {
            merged[i] = shared::end_on_its_way(
                ends[i - stride], ends[std::min(i + stride, chain.last)], ends[i], chain.fraction);
        }
    }
};

} // namespace skybark::kernels
