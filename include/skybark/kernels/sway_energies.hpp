#pragma once
// sway_energies: kinetic energies of swaying trees, and the scale of their rates.

#include <skybark/core/kernel.hpp>
#include <skybark/kernels/sway_records.hpp>

namespace skybark::kernels {

/// Buffers: joints, states, energies (bound twice: children's, own). Maps over the levels from the
/// last to the first.
struct sway_energies {
    using buffers = buffer_list<readonly<shared::sway_joint>, readonly<shared::sway_state>,
                                readonly<shared::sway_energy>, writeonly<shared::sway_energy>>;

    void map(std::uint32_t i, std::span<const shared::sway_joint> joints,
             std::span<const shared::sway_state> states,
             std::span<const shared::sway_energy> carried,
             std::span<shared::sway_energy> energies) const {
        const shared::sway_joint& joint = joints[i];
        shared::sway_energy sum = shared::sway_energy_of(states[i]);
        for (std::uint32_t c = joint.first_child; c < joint.first_child + joint.child_count; ++c) {
            sum = shared::sway_energy_sum(sum, carried[c]);
        }
        sum.scale = joint.root == i ? shared::sway_scale(sum) : 1.0f;
        energies[i] = sum;
    }
};

} // namespace skybark::kernels
