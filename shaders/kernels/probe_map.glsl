// Device side of skybark::kernels::probe_map.
#define KERNEL_PARAMETERS uint factor; uint offset; float scale; float bias;
#include "../skeletons/parameters.glsl"
layout(std430, binding = 0) readonly buffer numbers_buffer { uint numbers[]; };
layout(std430, binding = 1) readonly buffer vectors_buffer { vec4 vectors[]; };
layout(std430, binding = 2) writeonly buffer numbers_out_buffer { uint numbers_out[]; };
layout(std430, binding = 3) writeonly buffer vectors_out_buffer { vec4 vectors_out[]; };

void kernel_map(uint i) {
    numbers_out[i] = numbers[i] * factor + offset + i;
    vectors_out[i] = vectors[i] * scale + bias;
}
