// Device side of skybark::kernels::scatter_prolong.
#define KERNEL_PARAMETERS uint from_zero; uint axes;
#define KERNEL_VOLUMES 2
#define KERNEL_TARGETS 1
#include "../skeletons/parameters.glsl"
#include "scatter_cells.glsl.inc"

float row(int near, int far, int y, int z) {
    return 0.75 * scatter_load(1, ivec3(near, y, z)) + 0.25 * scatter_load(1, ivec3(far, y, z));
}

void kernel_voxel(ivec3 at) {
    ivec3 last = scatter_size(1) - 1;
    ivec3 halved = halved_axes(axes, scatter_size(0));
    ivec3 near = min(at / (1 + halved), last);
    ivec3 far = clamp(near + halved * (2 * (at - 2 * (at / 2)) - 1), ivec3(0), last);
    float sum = 0.75 * (0.75 * row(near.x, far.x, near.y, near.z) + 0.25 * row(near.x, far.x, far.y, near.z)) +
                0.25 * (0.75 * row(near.x, far.x, near.y, far.z) + 0.25 * row(near.x, far.x, far.y, far.z));
    if (from_zero == 0u) {
        sum = scatter_load(0, at) + sum;
    }
    imageStore(kernel_targets[0], at, vec4(sum));
}
