// Device side of skybark::kernels::sway_inertia.
#define KERNEL_PARAMETERS float seconds;
#include "../skeletons/parameters.glsl"
#include "../shared/sway.glsl"
layout(std430, binding = 0) readonly buffer joints_buffer { sway_joint joints[]; };
layout(std430, binding = 1) readonly buffer loads_buffer { segment_load loads[]; };
layout(std430, binding = 2) readonly buffer states_buffer { sway_state states[]; };
layout(std430, binding = 3) readonly buffer energies_buffer { sway_energy energies[]; };
layout(std430, binding = 4) readonly buffer carried_buffer { sway_carry carried[]; };
layout(std430, binding = 5) writeonly buffer carry_buffer { sway_carry carry[]; };
layout(std430, binding = 6) writeonly buffer gains_buffer { sway_gain gains[]; };

void kernel_map(uint i) {
    sway_joint joint = joints[i];
    sway_state state = states[i];
    sway_rule rule = sway_rule_of(joint, seconds);
    sway_carry sum =
        sway_body(joint, state, loads[i], rule, energies[joint.root].scale, seconds);
    for (uint c = joint.first_child; c < joint.first_child + joint.child_count; ++c) {
        sum = sway_sum(sum, carried[c]);
    }
    sway_parted parted = sway_part(joint, sum, rule, state.rotation, state.bend,
                                   states[joint.parent].rotation);
    carry[i] = parted.carry;
    gains[i] = parted.gain;
}
