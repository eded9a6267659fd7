// Device side of skybark::kernels::billboard_depth.
#define KERNEL_PARAMETERS vec4 eye;
#include "../skeletons/parameters.glsl"
#include "../shared/cloud_lighting.glsl"
layout(std430, binding = 0) readonly buffer particles_buffer { vec4 particles[]; };
layout(std430, binding = 1) readonly buffer order_buffer { uint order[]; };
layout(std430, binding = 2) writeonly buffer keys_buffer { uint keys[]; };

void kernel_map(uint i) {
    vec3 d = particles[2u * order[i]].xyz - eye.xyz;
    keys[i] = farther_first(d.x * d.x + d.y * d.y + d.z * d.z);
}
