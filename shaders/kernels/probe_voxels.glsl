// Device side of skybark::kernels::probe_voxels.
#define KERNEL_PARAMETERS int extent_x; int extent_y; float shift;
#define KERNEL_VOLUMES 2
#define KERNEL_TARGETS 2
#include "../skeletons/parameters.glsl"
layout(std430, binding = 0) readonly buffer weights_buffer { vec4 weights[]; };
layout(std430, binding = 1) writeonly buffer numbers_buffer { uint numbers[]; };

float loaded(ivec3 at) {
    ivec3 size = textureSize(kernel_volumes[0], 0);
    bool inside = all(greaterThanEqual(at, ivec3(0))) && all(lessThan(at, size));
    return inside ? texelFetch(kernel_volumes[0], at, 0).x : 0.0;
}

void kernel_voxel(ivec3 at) {
    float sum = loaded(at);
    sum += loaded(at + ivec3(1, 0, 0)) + loaded(at - ivec3(1, 0, 0));
    sum += loaded(at + ivec3(0, 1, 0)) + loaded(at - ivec3(0, 1, 0));
    sum += loaded(at + ivec3(0, 0, 1)) + loaded(at - ivec3(0, 0, 1));
    imageStore(kernel_targets[0], at, vec4(weights[at.z].x * sum));
    vec3 place = (vec3(at) + 0.5 + shift) / vec3(textureSize(kernel_volumes[1], 0));
    imageStore(kernel_targets[1], at, vec4(textureLod(kernel_volumes[1], place, 0.0).x));
    int number = (at.z * extent_y + at.y) * extent_x + at.x;
    numbers[number] = uint(number) + (uint(textureSize(kernel_volumes[0], 0).x) << 24);
}
