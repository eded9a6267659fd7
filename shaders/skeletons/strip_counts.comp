#version 450
// Before a compact expansion: the number of triangles of each element, 0 beyond the length that
// only the device knows. header.y is the upper limit, and all of it is written.
layout(local_size_x = 64) in;
#include KERNEL
#include "length.glsl"
layout(std430, binding = 9) writeonly buffer skybark_counts_buffer { uint skybark_counts[]; };
void emit_vertex() {}

void main() {
    uint k = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (k >= skybark_header.y) {
        return;
    }
    uint sum = 0u;
    if (k < skybark_elements()) {
        uint strips = kernel_strips();
        for (uint strip = 0u; strip < strips; ++strip) {
            sum += kernel_triangles(skybark_header.x + k, strip);
        }
    }
    skybark_counts[k] = sum;
}
