// Device side of skybark::kernels::scatter_limit.
#define KERNEL_PARAMETERS vec4 sides; float transport; float spreading; float assumed;
#define KERNEL_VOLUMES 2
#define KERNEL_TARGETS 1
#include "../skeletons/parameters.glsl"
#include "../shared/scatter.glsl"
#include "scatter_cells.glsl.inc"

float sideways(ivec3 at) {
    ivec3 last = scatter_size(0) - 1;
    int left = max(at.x - 1, 0);
    int right = min(at.x + 1, last.x);
    int back = max(at.z - 1, 0);
    int front = min(at.z + 1, last.z);
    float to_left = scatter_load(0, ivec3(left, at.y, at.z));
    float to_right = scatter_load(0, ivec3(right, at.y, at.z));
    float to_back = scatter_load(0, ivec3(at.x, at.y, back));
    float to_front = scatter_load(0, ivec3(at.x, at.y, front));
    float x = (to_right - to_left) / (float(max(right - left, 1)) * sides.x);
    float z = (to_front - to_back) / (float(max(front - back, 1)) * sides.z);
    float around = 0.25 * ((to_left + to_right) + (to_back + to_front));
    float here = max(max(scatter_load(0, at), around), 1e-12);
    return sqrt(x * x + z * z) / here;
}

void kernel_voxel(ivec3 at) {
    float across = assumed;
    if (assumed < 0.0) {
        across = sideways(at);
    }
    imageStore(kernel_targets[0], at,
               vec4(scatter_resistance(transport * scatter_load(1, at), sides.w, spreading, across)));
}
