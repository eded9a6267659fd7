// Device side of skybark::kernels::gather_light.
#include "../shared/records.glsl"
#include "seen_light.glsl.inc"

void kernel_map(uint i) {
    vec3 normal = samples[i].normal;
    vec4 seen = light_seen(hits[i], normal);
    sums[first + i] = light_sum(before[first + i], seen, weight_of_sample(samples[i], direction));
}
