#pragma once
// segment_rings: how many rings and sides a branch segment needs, from the detail of its ends.

#include <skybark/kernels/merge_chains.hpp>

namespace skybark::kernels {

/// Buffers: segments, ends, the ends' shares, the chains' and the ends' detail, the segments that
/// are drawn and their detail. Maps over segments.
///
/// Rings go by how far the curve is from its chords in pixels, where the segment comes nearest.
/// Of `gaps` all are kept, or those that dividing by prime factors, the smallest first, leaves.
struct segment_rings {
    using buffers = buffer_list<readonly<branch_segment>, readonly<branch_end>,
                                readonly<chain_share>, readonly<chain_detail>, readonly<end_detail>,
                                writeonly<branch_segment>, writeonly<segment_detail>>;

    float pixels_per_radian = 0;
    float error = 0;                ///< pixels that a surface may be off by; 0: full detail
    std::uint32_t fewest_sides = 4; ///< least_sides(sides)
    std::uint32_t sides = 8;        ///< of full detail
    std::uint32_t gaps = 3;         ///< of full detail: rings − 1

    void map(std::uint32_t i, std::span<const branch_segment> segments,
             std::span<const branch_end> ends, std::span<const chain_share> shares,
             std::span<const chain_detail> chains, std::span<const end_detail> details,
             std::span<branch_segment> merged, std::span<segment_detail> made_of) const {
        const branch_segment& own = segments[i];
        const chain_share& place = shares[own.start];
        const chain_detail& chain = chains[place.chain];
        merged[i] = own;
        made_of[i] = {0, 0, 0, 0};
        if (shared::is_merged_away(place, chain)) {
            return;
        }
        const branch_segment s = shared::merged_segment(own, chain);
        branch_end a = ends[s.start];
        branch_end b = ends[s.end];
        a.radius = a.radius * details[s.start].scale;
        b.radius = b.radius * details[s.end].scale;
        merged[i] = s;
        made_of[i] = shared::detail_of_segment(s, a, b, details[s.start], details[s.end],
                                               pixels_per_radian, error, fewest_sides, sides, gaps);
    }
};

} // namespace skybark::kernels
