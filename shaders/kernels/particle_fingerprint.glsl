// Device side of skybark::kernels::particle_fingerprint.
#include "../skeletons/parameters.glsl"
#include "../shared/puff.glsl"
layout(std430, binding = 0) readonly buffer particles_buffer { vec4 particles[]; };
layout(std430, binding = 1) writeonly buffer keys_buffer { uint keys[]; };
layout(std430, binding = 2) writeonly buffer order_buffer { uint order[]; };

void kernel_map(uint i) {
    vec4 ball = particles[2u * i];
    vec4 water = particles[2u * i + 1u];
    keys[i] = puff_fingerprint(ball.xyz, ball.w, water.x, water.y);
    order[i] = i;
}
