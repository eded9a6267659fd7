#pragma once
// sway_moments: the way up of one step towards the equilibrium of loaded branches.

#include <skybark/core/kernel.hpp>
#include <skybark/kernels/sway_records.hpp>

namespace skybark::kernels {

/// Buffers: joints, loads, states, moments of the children, moments (the same buffer), gains. Maps
/// over the levels from the last to the first. `states` ends with the ground.
struct sway_moments {
    using buffers = buffer_list<readonly<shared::sway_joint>, readonly<segment_load>,
                                readonly<shared::sway_state>, readonly<shared::sway_moment>,
                                writeonly<shared::sway_moment>, writeonly<shared::sway_gain>>;

    void map(std::uint32_t i, std::span<const shared::sway_joint> joints,
             std::span<const segment_load> loads, std::span<const shared::sway_state> states,
             std::span<const shared::sway_moment> carried, std::span<shared::sway_moment> carry,
             std::span<shared::sway_gain> gains) const {
        const shared::sway_joint& joint = joints[i];
        const shared::sway_state& state = states[i];
        shared::sway_moment sum = shared::sway_pull(joint, state.rotation, loads[i]);
        for (std::uint32_t c = joint.first_child; c < joint.first_child + joint.child_count; ++c) {
            sum = shared::sway_moment_sum(sum, carried[c]);
        }
        const shared::sway_balanced balanced = shared::sway_balance(
            joint, sum, state.rotation, state.bend, states[joint.parent].rotation);
        carry[i] = balanced.carry;
        gains[i] = balanced.gain;
    }
};

} // namespace skybark::kernels
