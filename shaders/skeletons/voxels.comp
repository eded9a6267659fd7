#version 450
// map_voxels: one invocation a voxel of the extent header.xyz. The group counts are those of the
// extent divided by 8, 8 and 1, rounded up.
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 8, local_size_y = 8) in;
#include KERNEL

void main() {
    if (all(lessThan(gl_GlobalInvocationID, skybark_header.xyz))) {
        kernel_voxel(ivec3(gl_GlobalInvocationID));
    }
}
