#version 450
// map over consecutive ranges: one workgroup walks them in order, a barrier between two. Buffers
// are coherent, because what one range wrote the next one reads through another binding.
#define readonly coherent readonly
#define writeonly coherent writeonly
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 256) in;
#include KERNEL
layout(std430, binding = 11) readonly buffer skybark_ranges_buffer { uvec2 skybark_ranges[]; };

void main() {
    for (uint r = 0u; r < skybark_header.y; ++r) {
        uvec2 elements = skybark_ranges[skybark_header.x + r];
        for (uint i = gl_LocalInvocationID.x; i < elements.y; i += 256u) {
            kernel_map(elements.x + i);
        }
        memoryBarrierBuffer();
        barrier();
    }
}
