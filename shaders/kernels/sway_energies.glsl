// Device side of skybark::kernels::sway_energies.
#include "../skeletons/parameters.glsl"
#include "../shared/sway.glsl"
layout(std430, binding = 0) readonly buffer joints_buffer { sway_joint joints[]; };
layout(std430, binding = 1) readonly buffer states_buffer { sway_state states[]; };
layout(std430, binding = 2) readonly buffer carried_buffer { sway_energy carried[]; };
layout(std430, binding = 3) writeonly buffer energies_buffer { sway_energy energies[]; };

void kernel_map(uint i) {
    sway_joint joint = joints[i];
    sway_energy sum = sway_energy_of(states[i]);
    for (uint c = joint.first_child; c < joint.first_child + joint.child_count; ++c) {
        sum = sway_energy_sum(sum, carried[c]);
    }
    sum.scale = joint.root == i ? sway_scale(sum) : 1.0f;
    energies[i] = sum;
}
