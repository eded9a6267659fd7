// Device side of skybark::kernels::scatter_coarsen.
#define KERNEL_PARAMETERS uint axes;
#define KERNEL_VOLUMES 3
#define KERNEL_TARGETS 3
#include "../skeletons/parameters.glsl"
#include "scatter_cells.glsl.inc"

void kernel_voxel(ivec3 at) {
    ivec3 size = scatter_size(0);
    ivec3 halved = halved_axes(axes, size);
    ivec3 first = first_child(at, halved);
    float extinction = 0.0;
    float scattered = 0.0;
    float beam = 0.0;
    for (int c = 0; c < 8; ++c) {
        ivec3 child = child_of(first, c, halved);
        bool inside = within(child, size);
        extinction += inside ? scatter_load(0, child) : 0.0;
        scattered += inside ? scatter_load(1, child) : 0.0;
        if ((c & 2) != 0) {
            beam += inside ? scatter_load(2, child) : 1.0;
        }
    }
    imageStore(kernel_targets[0], at, vec4(0.125 * extinction));
    imageStore(kernel_targets[1], at, vec4(0.125 * scattered));
    imageStore(kernel_targets[2], at, vec4(0.25 * beam));
}
