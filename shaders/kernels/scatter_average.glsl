// Device side of skybark::kernels::scatter_average.
#define KERNEL_PARAMETERS uint axes;
#define KERNEL_VOLUMES 1
#define KERNEL_TARGETS 1
#include "../skeletons/parameters.glsl"
#include "scatter_cells.glsl.inc"

void kernel_voxel(ivec3 at) {
    ivec3 size = scatter_size(0);
    ivec3 halved = halved_axes(axes, size);
    ivec3 first = first_child(at, halved);
    float sum = 0.0;
    for (int c = 0; c < 8; ++c) {
        sum += 1.0 / scatter_load(0, held(child_of(first, c, halved), size));
    }
    imageStore(kernel_targets[0], at, vec4(8.0 / sum));
}
