// Device side of skybark::kernels::sway_forces.
#include "../skeletons/parameters.glsl"
#include "../shared/sway.glsl"
layout(std430, binding = 0) readonly buffer joints_buffer { sway_joint joints[]; };
layout(std430, binding = 1) readonly buffer loads_buffer { segment_load loads[]; };
layout(std430, binding = 2) readonly buffer states_buffer { sway_state states[]; };
layout(std430, binding = 3) readonly buffer carried_buffer { vec4 carried[]; };
layout(std430, binding = 4) writeonly buffer carry_buffer { vec4 carry[]; };
layout(std430, binding = 5) writeonly buffer gains_buffer { sway_gain gains[]; };

void kernel_map(uint i) {
    sway_joint joint = joints[i];
    sway_state state = states[i];
    vec4 sum = vec4(loads[i].force, 0.0f);
    for (uint c = joint.first_child; c < joint.first_child + joint.child_count; ++c) {
        sum = sum + carried[c];
    }
    carry[i] = sum;
    gains[i] = sway_paper_gain(joint, vec3(sum.x, sum.y, sum.z), state.rotation, state.bend);
}
