// Device side of skybark::kernels::probe_peel.
#define KERNEL_PARAMETERS vec4 scale; vec4 shift;
#include "../skeletons/parameters.glsl"
layout(std430, binding = 0) readonly buffer corners_buffer { vec4 corners[]; };

vec4 kernel_corner(uint index) {
    vec4 p = corners[index];
    precise float x = p.x * scale.x + shift.x;
    precise float y = p.y * scale.y + shift.y;
    precise float z = p.z * scale.z + shift.z;
    return vec4(x, y, z, 1.0);
}
