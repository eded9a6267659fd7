// Device side of skybark::kernels::irradiance_voxels.
#define KERNEL_PARAMETERS vec4 tilt; int points_x; int points_y;
#define KERNEL_TARGETS 1
#include "../skeletons/parameters.glsl"
layout(std430, binding = 0) readonly buffer harmonics_buffer { vec4 harmonics[]; };

void kernel_voxel(ivec3 at) {
    int k = at.y / points_y;
    int y = at.y - k * points_y;
    int point = (at.z * points_y + y) * points_x + at.x;
    int at_above = 6 * point + k / 4;
    vec4 above = harmonics[at_above];
    vec4 below = harmonics[at_above + 3];
    precise vec4 all = (above + below) - tilt * (above.x - below.x);
    imageStore(kernel_targets[0], at, vec4(all[k % 4]));
}
