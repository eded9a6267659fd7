#pragma once
// sway_bends: joints turn as their gains say, without inertia, and branches follow.

#include <skybark/core/kernel.hpp>
#include <skybark/kernels/sway_records.hpp>

namespace skybark::kernels {

/// Buffers: joints, gains, states before, states after (bound twice: parents, own), poses,
/// velocities (all zero). Maps over the levels from the first to the last. Both buffers of states
/// end with the ground.
struct sway_bends {
    using buffers =
        buffer_list<readonly<shared::sway_joint>, readonly<shared::sway_gain>,
                    readonly<shared::sway_state>, readonly<shared::sway_state>,
                    writeonly<shared::sway_state>, writeonly<segment_pose>, writeonly<glm::vec4>>;

    void map(std::uint32_t i, std::span<const shared::sway_joint> joints,
             std::span<const shared::sway_gain> gains, std::span<const shared::sway_state> before,
             std::span<const shared::sway_state> parents, std::span<shared::sway_state> states,
             std::span<segment_pose> poses, std::span<glm::vec4> velocities) const {
        const shared::sway_joint& joint = joints[i];
        const shared::sway_state now = shared::sway_turned(
            joint, gains[i], before[i], before[joint.parent].rotation, parents[joint.parent]);
        states[i] = now;
        poses[i] = shared::sway_pose(joint, now);
        velocities[i] = glm::vec4(0.0f, 0.0f, 0.0f, 0.0f);
    }
};

} // namespace skybark::kernels
