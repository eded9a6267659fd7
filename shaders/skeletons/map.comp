#version 450
// map: one invocation an element. More than 65,535 groups go into the second dimension.
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 64) in;
#include KERNEL
#include "length.glsl"

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i < skybark_elements()) {
        kernel_map(skybark_header.x + i);
    }
}
