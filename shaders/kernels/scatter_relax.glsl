// Device side of skybark::kernels::scatter_relax.
#define KERNEL_PARAMETERS \
    vec4 sides; float absorption; float weight; uint from_zero; float least;
#define KERNEL_VOLUMES 4
#define KERNEL_TARGETS 1
#include "../skeletons/parameters.glsl"
#include "../shared/scatter.glsl"
#include "scatter_cells.glsl.inc"
#include "scatter_equation.glsl.inc"

void kernel_voxel(ivec3 at) {
    scatter_balance sum = balance(at, from_zero != 0u);
    float phi = from_zero != 0u ? 0.0 : scatter_load(0, at);
    imageStore(kernel_targets[0], at, vec4(max(scatter_relaxed(sum, phi, weight), least)));
}
