#pragma once
// sway_motion: the way down of one dynamic step of swaying branches.

#include <skybark/core/kernel.hpp>
#include <skybark/kernels/sway_records.hpp>

namespace skybark::kernels {

/// Buffers: joints, energies of the trees, gains, states before the step, states after it (bound
/// twice: parents, own), poses, velocities of the middles (m/s, mean over the step).
/// Maps over the levels from the first to the last. Both buffers of states end with the ground.
struct sway_motion {
    float seconds = 0; ///< s, the length of the step, above 0

    using buffers = buffer_list<readonly<shared::sway_joint>, readonly<shared::sway_energy>,
                                readonly<shared::sway_gain>, readonly<shared::sway_state>,
                                readonly<shared::sway_state>, writeonly<shared::sway_state>,
                                writeonly<segment_pose>, writeonly<glm::vec4>>;

    void map(std::uint32_t i, std::span<const shared::sway_joint> joints,
             std::span<const shared::sway_energy> energies,
             std::span<const shared::sway_gain> gains, std::span<const shared::sway_state> before,
             std::span<const shared::sway_state> parents, std::span<shared::sway_state> states,
             std::span<segment_pose> poses, std::span<glm::vec4> velocities) const {
        const shared::sway_joint& joint = joints[i];
        const shared::sway_state& was = before[i];
        const shared::sway_state now = shared::sway_stepped(
            joint, gains[i], was, before[joint.parent].rotation, parents[joint.parent],
            shared::sway_rule_of(joint, seconds), energies[joint.root], seconds);
        states[i] = now;
        poses[i] = shared::sway_pose(joint, now);
        velocities[i] = shared::sway_velocity(joint, was.rotation, now);
    }
};

} // namespace skybark::kernels
