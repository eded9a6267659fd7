#pragma once
// sway_energies: energies of swaying trees, and what follows from them for their rates.

#include <skybark/core/kernel.hpp>
#include <skybark/kernels/sway_records.hpp>
#include <skybark/shared/sway_tree.hpp>

namespace skybark::kernels {

/// Buffers: joints, states, loads, velocities of the middles over the step, energies (bound twice:
/// children's, own). Maps over the levels from the last to the first.
struct sway_energies {
    float seconds = 0; ///< s, the length of the step

    using buffers = buffer_list<readonly<shared::sway_joint>, readonly<shared::sway_state>,
                                readonly<segment_load>, readonly<glm::vec4>,
                                readonly<shared::sway_energy>, writeonly<shared::sway_energy>>;

    void map(std::uint32_t i, std::span<const shared::sway_joint> joints,
             std::span<const shared::sway_state> states, std::span<const segment_load> loads,
             std::span<const glm::vec4> velocities, std::span<const shared::sway_energy> carried,
             std::span<shared::sway_energy> energies) const {
        const shared::sway_joint& joint = joints[i];
        shared::sway_energy sum =
            shared::sway_energy_of(joint, states[i], loads[i], velocities[i], seconds);
        for (std::uint32_t c = joint.first_child; c < joint.first_child + joint.child_count; ++c) {
            sum = shared::sway_energy_sum(sum, carried[c]);
        }
        if (joint.root == i) {
            sum = shared::sway_settled(sum, states[i].budget);
        }
        energies[i] = sum;
    }
};

} // namespace skybark::kernels
