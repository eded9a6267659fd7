// Device side of skybark::kernels::scatter_restrict.
#define KERNEL_PARAMETERS vec4 sides; float absorption; uint axes;
#define KERNEL_VOLUMES 4
#define KERNEL_TARGETS 1
#include "../skeletons/parameters.glsl"
#include "../shared/scatter.glsl"
#include "scatter_cells.glsl.inc"
#include "scatter_equation.glsl.inc"

void kernel_voxel(ivec3 at) {
    ivec3 size = scatter_size(0);
    ivec3 halved = halved_axes(axes, size);
    ivec3 first = first_child(at, halved);
    float left = 0.0;
    for (int c = 0; c < 8; ++c) {
        ivec3 child = child_of(first, c, halved);
        if (within(child, size)) {
            scatter_balance sum = balance(child, false);
            left += sum.gain - sum.loss * scatter_load(0, child);
        }
    }
    imageStore(kernel_targets[0], at, vec4(0.125 * left));
}
