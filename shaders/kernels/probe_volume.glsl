// Device side of skybark::kernels::probe_volume.
#define KERNEL_PARAMETERS float first;
#define KERNEL_VOLUMES 2
#define KERNEL_TARGETS 1
#include "../skeletons/parameters.glsl"
struct probe_place {
    vec4 place;
    ivec4 cell;
};
layout(std430, binding = 0) readonly buffer places_buffer { probe_place places[]; };
layout(std430, binding = 1) writeonly buffer values_buffer { vec4 values[]; };
layout(std430, binding = 2) writeonly buffer sizes_buffer { ivec4 sizes[]; };

void kernel_map(uint i) {
    vec3 place = places[i].place.xyz;
    ivec4 cell = places[i].cell;
    values[i] = vec4(textureLod(kernel_volumes[0], place, 0.0).x,
                     textureLod(kernel_volumes[1], place, 0.0).x,
                     texelFetch(kernel_volumes[0], cell.xyz, 0).x,
                     texelFetch(kernel_volumes[1], cell.xyz, 0).x);
    sizes[i] = ivec4(i % 2u == 0u ? textureSize(kernel_volumes[0], 0)
                                  : textureSize(kernel_volumes[1], 0), 0);
    if (cell.w != 0) {
        imageStore(kernel_targets[0], cell.xyz, vec4(float(i) + first));
    }
}
