// Device side of skybark::kernels::light_at_points.
#define KERNEL_VOLUMES 2
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS light_grid grid; uint octaves; float octave_weight; float octave_attenuation; float diffuse; uint stride;
#include "../skeletons/parameters.glsl"
#include "../shared/light_at_points.glsl"
layout(std430, binding = 0) readonly buffer places_buffer { vec4 places[]; };
layout(std430, binding = 1) writeonly buffer found_buffer { vec4 found[]; };

ivec3 size_of(int n) {
    return n == 0 ? textureSize(kernel_volumes[0], 0) : textureSize(kernel_volumes[1], 0);
}

float voxel_at(int n, ivec3 at) {
    ivec3 inside = clamp(at, ivec3(0), size_of(n) - ivec3(1));
    return n == 0 ? texelFetch(kernel_volumes[0], inside, 0).x
                  : texelFetch(kernel_volumes[1], inside, 0).x;
}

float value_at(int n, vec3 cells, vec3 ends) {
    if (!(cells.x >= 0.0 && cells.x <= ends.x && cells.z >= 0.0 && cells.z <= ends.z &&
          cells.y <= ends.y)) {
        return 0.0;
    }
    vec3 from = vec3(cells.x - 0.5, max(cells.y - 0.5, 0.0), cells.z - 0.5);
    vec3 first = floor(from);
    vec3 part = from - first;
    ivec3 at = ivec3(first);
    float low = bilinear(voxel_at(n, at), voxel_at(n, at + ivec3(1, 0, 0)),
                         voxel_at(n, at + ivec3(0, 0, 1)), voxel_at(n, at + ivec3(1, 0, 1)),
                         part.x, part.z);
    float high = bilinear(voxel_at(n, at + ivec3(0, 1, 0)), voxel_at(n, at + ivec3(1, 1, 0)),
                          voxel_at(n, at + ivec3(0, 1, 1)), voxel_at(n, at + ivec3(1, 1, 1)),
                          part.x, part.z);
    return low + (high - low) * part.y;
}

float scattered_at(vec3 cells, vec3 size) {
    vec3 inside = clamp(cells, vec3(0.0), size);
    vec3 beyond = (cells - inside) * grid.voxel.xyz;
    vec3 half_size = 0.5 * size * grid.voxel.xyz;
    float radius = max(max(half_size.x, half_size.y), half_size.z);
    float away = sqrt(beyond.x * beyond.x + beyond.y * beyond.y + beyond.z * beyond.z);
    return value_at(1, inside * diffuse, size * diffuse) * scattered_part(away, radius);
}

void kernel_map(uint i) {
    vec3 cells = cells_of(grid, places[i * stride].xyz);
    vec3 size = vec3(size_of(0));
    float attenuation = value_at(0, cells, size);
    float light = octaves_light(attenuation, octaves, octave_weight, octave_attenuation);
    float scattered = diffuse > 0.0 ? scattered_at(cells, size) : 0.0;
    found[i] = vec4(attenuation, light + scattered, scattered, 0.0);
}
