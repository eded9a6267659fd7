#pragma once
// sway_forces: the way up of the paper's sway, which sums forces without their levers.
// Source: Akagi and Kitajima, section 2.5, steps 2 and 3.

#include <skybark/core/kernel.hpp>
#include <skybark/kernels/sway_records.hpp>

namespace skybark::kernels {

/// Buffers: joints (whose stiffness is the paper's), loads, states, forces of the children, forces
/// (the same buffer), gains. Maps over the levels from the last to the first.
struct sway_forces {
    using buffers = buffer_list<readonly<shared::sway_joint>, readonly<segment_load>,
                                readonly<shared::sway_state>, readonly<glm::vec4>,
                                writeonly<glm::vec4>, writeonly<shared::sway_gain>>;

    void map(std::uint32_t i, std::span<const shared::sway_joint> joints,
             std::span<const segment_load> loads, std::span<const shared::sway_state> states,
             std::span<const glm::vec4> carried, std::span<glm::vec4> carry,
             std::span<shared::sway_gain> gains) const {
        const shared::sway_joint& joint = joints[i];
        const shared::sway_state& state = states[i];
        glm::vec4 sum = glm::vec4(loads[i].force, 0.0f);
        for (std::uint32_t c = joint.first_child; c < joint.first_child + joint.child_count; ++c) {
            sum = sum + carried[c];
        }
        carry[i] = sum;
        gains[i] = shared::sway_paper_gain(joint, glm::vec3(sum.x, sum.y, sum.z), state.rotation,
                                           state.bend);
    }
};

} // namespace skybark::kernels
