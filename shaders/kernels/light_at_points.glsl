// Device side of skybark::kernels::light_at_points.
#define KERNEL_VOLUMES 1
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS light_grid grid; uint octaves; float octave_weight; float octave_attenuation;
#include "../skeletons/parameters.glsl"
#include "../shared/light_at_points.glsl"
layout(std430, binding = 0) readonly buffer places_buffer { vec4 places[]; };
layout(std430, binding = 1) writeonly buffer found_buffer { vec4 found[]; };

float voxel_at(ivec3 at, ivec3 size) {
    return texelFetch(kernel_volumes[0], clamp(at, ivec3(0), size - ivec3(1)), 0).x;
}

float attenuation_at(vec3 cells) {
    ivec3 size = textureSize(kernel_volumes[0], 0);
    if (!(cells.x >= 0.0 && cells.x <= float(size.x) && cells.z >= 0.0 &&
          cells.z <= float(size.z) && cells.y <= float(size.y))) {
        return 0.0;
    }
    vec3 from = vec3(cells.x - 0.5, max(cells.y - 0.5, 0.0), cells.z - 0.5);
    vec3 first = floor(from);
    vec3 part = from - first;
    ivec3 at = ivec3(first);
    float low = bilinear(voxel_at(at, size), voxel_at(at + ivec3(1, 0, 0), size),
                         voxel_at(at + ivec3(0, 0, 1), size), voxel_at(at + ivec3(1, 0, 1), size),
                         part.x, part.z);
    float high = bilinear(voxel_at(at + ivec3(0, 1, 0), size), voxel_at(at + ivec3(1, 1, 0), size),
                          voxel_at(at + ivec3(0, 1, 1), size), voxel_at(at + ivec3(1, 1, 1), size),
                          part.x, part.z);
    return low + (high - low) * part.y;
}

void kernel_map(uint i) {
    float attenuation = attenuation_at(cells_of(grid, places[i].xyz));
    found[i] = vec4(attenuation,
                    octaves_light(attenuation, octaves, octave_weight, octave_attenuation), 0.0,
                    0.0);
}
