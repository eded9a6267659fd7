// Device side of skybark::kernels::sway_moments.
#include "../skeletons/parameters.glsl"
#include "../shared/sway.glsl"
layout(std430, binding = 0) readonly buffer joints_buffer { sway_joint joints[]; };
layout(std430, binding = 1) readonly buffer loads_buffer { segment_load loads[]; };
layout(std430, binding = 2) readonly buffer states_buffer { sway_state states[]; };
layout(std430, binding = 3) readonly buffer carried_buffer { sway_moment carried[]; };
layout(std430, binding = 4) writeonly buffer carry_buffer { sway_moment carry[]; };
layout(std430, binding = 5) writeonly buffer gains_buffer { sway_gain gains[]; };

void kernel_map(uint i) {
    sway_joint joint = joints[i];
    sway_state state = states[i];
    sway_moment sum = sway_pull(joint, state.rotation, loads[i]);
    for (uint c = joint.first_child; c < joint.first_child + joint.child_count; ++c) {
        sum = sway_moment_sum(sum, carried[c]);
    }
    sway_balanced balanced = sway_balance(joint, sum, state.rotation, state.bend,
                                          states[joint.parent].rotation);
    carry[i] = balanced.carry;
    gains[i] = balanced.gain;
}
