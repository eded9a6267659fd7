// Device side of skybark::kernels::sway_energies.
#define KERNEL_PARAMETERS float seconds;
#include "../skeletons/parameters.glsl"
#include "../shared/sway_tree.glsl"
layout(std430, binding = 0) readonly buffer joints_buffer { sway_joint joints[]; };
layout(std430, binding = 1) readonly buffer states_buffer { sway_state states[]; };
layout(std430, binding = 2) readonly buffer loads_buffer { segment_load loads[]; };
layout(std430, binding = 3) readonly buffer velocities_buffer { vec4 velocities[]; };
layout(std430, binding = 4) readonly buffer carried_buffer { sway_energy carried[]; };
layout(std430, binding = 5) writeonly buffer energies_buffer { sway_energy energies[]; };

void kernel_map(uint i) {
    sway_joint joint = joints[i];
    sway_energy sum = sway_energy_of(joint, states[i], loads[i], velocities[i], seconds);
    for (uint c = joint.first_child; c < joint.first_child + joint.child_count; ++c) {
        sum = sway_energy_sum(sum, carried[c]);
    }
    if (joint.root == i) {
        sum = sway_settled(sum, states[i].budget);
    }
    energies[i] = sum;
}
