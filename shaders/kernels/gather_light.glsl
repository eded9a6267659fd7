// Device side of skybark::kernels::gather_light.
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS vec4 direction; vec4 sky_along; vec4 sky_against; uint first;
#include "../skeletons/parameters.glsl"
#include "../shared/bundle.glsl"
#include "../shared/gathered_light.glsl"
layout(std430, binding = 0) readonly buffer samples_buffer { gather_sample samples[]; };
layout(std430, binding = 1) readonly buffer hits_buffer { gather_hit hits[]; };
layout(std430, binding = 2) readonly buffer tables_buffer { patch_table tables[]; };
layout(std430, binding = 3) readonly buffer radiance_buffer { vec4 radiance[]; };
layout(std430, binding = 4) readonly buffer before_buffer { vec4 before[]; };
layout(std430, binding = 5) writeonly buffer sums_buffer { vec4 sums[]; };

float side_of(vec3 normal) {
    precise float along =
        (normal.x * direction.x + normal.y * direction.y) + normal.z * direction.z;
    return along >= 0.0 ? 1.0 : -1.0;
}

vec4 light_seen(gather_hit hit, vec3 normal) {
    if (hit.surface == 0xffffffffu) {
        return side_of(normal) > 0.0 ? sky_along : sky_against;
    }
    patch_table table = tables[hit.surface / 2u];
    uint patches = hit.surface % 2u == 0u ? table.front : table.back;
    if (patches == 0xffffffffu) {
        return vec4(0.0);
    }
    return radiance[patches + patch_at(table.rows, hit.u, hit.v)];
}

void kernel_map(uint i) {
    vec3 normal = samples[i].normal;
    vec4 seen = light_seen(hits[i], normal);
    sums[first + i] = light_sum(before[first + i], seen, weight_of_sample(samples[i], direction));
}
