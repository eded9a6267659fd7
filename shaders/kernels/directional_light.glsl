// Device side of skybark::kernels::directional_light.
#include "../shared/records.glsl"
#include "seen_light.glsl.inc"
layout(std430, binding = 6) readonly buffer moments_before_buffer { vec4 moments_before[]; };
layout(std430, binding = 7) writeonly buffer moments_buffer { vec4 moments[]; };

void kernel_map(uint i) {
    vec3 normal = samples[i].normal;
    float weight = weight_of_sample(samples[i], direction);
    vec4 seen = weight > 0.0 ? light_seen(hits[i], normal) : vec4(0.0);
    sums[first + i] = light_sum(before[first + i], seen, weight);
    float side = side_of(normal);
    moments[3u * i] = moment_sum(moments_before[3u * i], seen.x, direction, side);
    moments[3u * i + 1u] = moment_sum(moments_before[3u * i + 1u], seen.y, direction, side);
    moments[3u * i + 2u] = moment_sum(moments_before[3u * i + 2u], seen.z, direction, side);
}
