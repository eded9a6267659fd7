#pragma once
// sway_inertia: the way up of one dynamic step of swaying branches.

#include <skybark/core/kernel.hpp>
#include <skybark/kernels/sway_records.hpp>

namespace skybark::kernels {

/// Buffers: joints, loads, states, energies of the trees, carries of the children, carries, gains.
/// Maps over the levels from the last to the first. Carries are bound twice. `states` has one
/// record more than there are joints: the ground.
struct sway_inertia {
    float seconds = 0; ///< s, the length of the step, above 0

    using buffers = buffer_list<readonly<shared::sway_joint>, readonly<segment_load>,
                                readonly<shared::sway_state>, readonly<shared::sway_energy>,
                                readonly<shared::sway_carry>, writeonly<shared::sway_carry>,
                                writeonly<shared::sway_gain>>;

    void map(std::uint32_t i, std::span<const shared::sway_joint> joints,
             std::span<const segment_load> loads, std::span<const shared::sway_state> states,
             std::span<const shared::sway_energy> energies,
             std::span<const shared::sway_carry> carried, std::span<shared::sway_carry> carry,
             std::span<shared::sway_gain> gains) const {
        const shared::sway_joint& joint = joints[i];
        const shared::sway_state& state = states[i];
        const shared::sway_rule rule = shared::sway_rule_of(joint, seconds);
        shared::sway_carry sum =
            shared::sway_body(joint, state, loads[i], rule, energies[joint.root].scale, seconds);
        for (std::uint32_t c = joint.first_child; c < joint.first_child + joint.child_count; ++c) {
            sum = shared::sway_sum(sum, carried[c]);
        }
        const shared::sway_parted parted = shared::sway_part(
            joint, sum, rule, state.rotation, state.bend, states[joint.parent].rotation);
        carry[i] = parted.carry;
        gains[i] = parted.gain;
    }
};

} // namespace skybark::kernels
