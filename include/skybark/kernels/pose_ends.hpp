#pragma once
// pose_ends: the ends of branches move with the segments that carry them.
// Source: Akagi and Kitajima, section 2.5, step 4.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/pose.hpp>

namespace skybark::kernels {

/// Buffers: ends at rest, their carriers, poses of the segments, ends now. Maps over ends.
struct pose_ends {
    using buffers = buffer_list<readonly<branch_end>, readonly<end_carrier>, readonly<segment_pose>,
                                writeonly<branch_end>>;

    void map(std::uint32_t i, std::span<const branch_end> rest,
             std::span<const end_carrier> carriers, std::span<const segment_pose> poses,
             std::span<branch_end> now) const {
        const end_carrier& by = carriers[i];
        now[i] = shared::posed_end(rest[i], poses[by.moved_by], poses[by.turned_by].rotation,
                                   poses[by.and_by].rotation);
    }
};

} // namespace skybark::kernels
