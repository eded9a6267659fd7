// Device side of skybark::kernels::bundle_crowds.
#define KERNEL_PARAMETERS uint stride;
#include "../skeletons/parameters.glsl"
layout(std430, binding = 0) readonly buffer keys_buffer { uint keys[]; };
layout(std430, binding = 1) writeonly buffer crowds_buffer { uint crowds[]; };

void kernel_map(uint i) {
    uint first = i * stride;
    crowds[i] = keys[first] == keys[first + stride - 1u] ? 1u : 0u;
}
