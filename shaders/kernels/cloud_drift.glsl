// Device side of skybark::kernels::cloud_drift.
#define KERNEL_PARAMETERS vec4 box; vec4 moved;
#include "../skeletons/parameters.glsl"
#include "../shared/drift.glsl"
layout(std430, binding = 0) readonly buffer rest_buffer { vec4 rest[]; };
layout(std430, binding = 1) readonly buffer middle_buffer { vec4 middles[]; };
layout(std430, binding = 2) writeonly buffer particles_buffer { vec4 particles[]; };

void kernel_map(uint i) {
    vec4 ball = rest[2u * i];
    vec4 water = rest[2u * i + 1u];
    vec4 middle = middles[i];
    float x = drift_shift(middle.x, moved.x, box.x, box.z, box.w);
    float z = drift_shift(middle.z, moved.y, box.y, box.z, box.w);
    precise float at_x = middle.x + x - box.x;
    precise float at_z = middle.z + z - box.y;
    precise float ball_x = ball.x + x;
    precise float ball_z = ball.z + z;
    precise float depth = water.x * drift_weight(at_x, at_z, moved.z, moved.w);
    particles[2u * i] = vec4(ball_x, ball.y, ball_z, ball.w);
    particles[2u * i + 1u] = vec4(depth, water.y, water.z, water.w);
}
