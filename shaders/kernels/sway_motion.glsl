// Device side of skybark::kernels::sway_motion.
#define KERNEL_PARAMETERS float seconds;
#include "../skeletons/parameters.glsl"
#include "../shared/sway.glsl"
layout(std430, binding = 0) readonly buffer joints_buffer { sway_joint joints[]; };
layout(std430, binding = 1) readonly buffer energies_buffer { sway_energy energies[]; };
layout(std430, binding = 2) readonly buffer gains_buffer { sway_gain gains[]; };
layout(std430, binding = 3) readonly buffer before_buffer { sway_state before[]; };
layout(std430, binding = 4) readonly buffer parents_buffer { sway_state parents[]; };
layout(std430, binding = 5) writeonly buffer states_buffer { sway_state states[]; };
layout(std430, binding = 6) writeonly buffer poses_buffer { segment_pose poses[]; };
layout(std430, binding = 7) writeonly buffer velocities_buffer { vec4 velocities[]; };

void kernel_map(uint i) {
    sway_joint joint = joints[i];
    sway_state was = before[i];
    sway_state now = sway_stepped(joint, gains[i], was, before[joint.parent].rotation,
                                  parents[joint.parent], sway_rule_of(joint, seconds),
                                  energies[joint.root], seconds);
    states[i] = now;
    poses[i] = sway_pose(joint, now);
    velocities[i] = sway_velocity(joint, was.rotation, now);
}
