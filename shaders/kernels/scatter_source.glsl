// Device side of skybark::kernels::scatter_source.
#define KERNEL_PARAMETERS float moment;
#define KERNEL_VOLUMES 4
#define KERNEL_TARGETS 1
#include "../skeletons/parameters.glsl"
#include "../shared/scatter.glsl"
#include "scatter_cells.glsl.inc"

float moved(float beam, ivec3 a, ivec3 b) {
    return scatter_moment(moment, beam, scatter_load(2, a), scatter_load(2, b), scatter_load(3, a),
                          scatter_load(3, b));
}

void kernel_voxel(ivec3 at) {
    ivec3 above = ivec3(at.x, at.y + 1, at.z);
    ivec3 below = ivec3(at.x, at.y - 1, at.z);
    float gained = above.y < scatter_size(0).y ? moved(scatter_load(1, at), at, above) : 0.0;
    float lost = at.y > 0 ? moved(scatter_load(1, below), at, below) : 0.0;
    imageStore(kernel_targets[0], at, vec4(scatter_load(0, at) + (gained - lost)));
}
