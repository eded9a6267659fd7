// Device side of skybark::kernels::bundle_more.
#define KERNEL_PARAMETERS uint samples;
#include "../skeletons/parameters.glsl"
layout(std430, binding = 0) readonly buffer crowded_buffer { uint crowded[]; };
layout(std430, binding = 1) writeonly buffer more_buffer { uvec4 more[]; };

void kernel_map(uint i) {
    uint count = crowded[i] != 0u ? samples : 0u;
    more[i] = uvec4(count, count, 0u, 0u);
}
