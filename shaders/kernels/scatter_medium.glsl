// Device side of skybark::kernels::scatter_medium.
#define KERNEL_PARAMETERS float extinction; float kept; float scattered;
#define KERNEL_VOLUMES 1
#define KERNEL_TARGETS 3
#include "../skeletons/parameters.glsl"
#include "../shared/attenuation.glsl"
#include "scatter_cells.glsl.inc"

float attenuation(ivec3 at) {
    return within(at, scatter_size(0)) ? max(scatter_load(0, at), 0.0) : 0.0;
}
float face(ivec3 at) {
    return 0.5 * (attenuation(ivec3(at.x, max(at.y - 1, 0), at.z)) + attenuation(at));
}

void kernel_voxel(ivec3 at) {
    float depth = 0.0;
    float lost = 0.0;
    float beam = 0.0;
    for (int c = 0; c < 4; ++c) {
        int x = 2 * at.x + (c & 1);
        int z = 2 * at.z + (c >> 1);
        float top = face(ivec3(x, 2 * at.y + 2, z));
        float bottom = face(ivec3(x, 2 * at.y, z));
        float lit = exp_minus(kept * top);
        depth += max(bottom - top, 0.0);
        lost += max(lit - exp_minus(kept * bottom), 0.0);
        beam += lit;
    }
    imageStore(kernel_targets[0], at, vec4(extinction * depth));
    imageStore(kernel_targets[1], at, vec4(scattered * lost));
    imageStore(kernel_targets[2], at, vec4(0.25 * beam));
}
