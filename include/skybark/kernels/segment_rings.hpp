#pragma once
// segment_rings: how many rings and sides a branch segment needs, from the detail of its ends.

#include <skybark/kernels/branch_detail.hpp>

namespace skybark::kernels {

/// Buffers: segments, ends, the ends' detail, the segments' detail. Maps over segments.
///
/// Rings go by how far the curve is from its chords in pixels, where the segment comes nearest.
/// Of `gaps` all are kept, or those that dividing by prime factors, the smallest first, leaves.
struct segment_rings {
    using buffers = buffer_list<readonly<branch_segment>, readonly<branch_end>,
                                readonly<end_detail>, writeonly<segment_detail>>;

    float pixels_per_radian = 0;
    float error = 0;                ///< pixels that a surface may be off by; 0: full detail
    std::uint32_t fewest_sides = 4; ///< least_sides(sides)
    std::uint32_t sides = 8;        ///< of full detail
    std::uint32_t gaps = 3;         ///< of full detail: rings − 1

    void map(std::uint32_t i, std::span<const branch_segment> segments,
             std::span<const branch_end> ends, std::span<const end_detail> details,
             std::span<segment_detail> made_of) const {
        const branch_segment& s = segments[i];
        branch_end a = ends[s.start];
        branch_end b = ends[s.end];
        a.radius = a.radius * details[s.start].scale;
        b.radius = b.radius * details[s.end].scale;
        made_of[i] = shared::detail_of_segment(s, a, b, details[s.start], details[s.end],
                                               pixels_per_radian, error, fewest_sides, sides, gaps);
    }
};

} // namespace skybark::kernels
