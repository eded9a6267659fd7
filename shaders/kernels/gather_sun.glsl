// Device side of skybark::kernels::gather_sun.
#define KERNEL_PARAMETERS vec4 direction; vec4 irradiance; uint dimmed;
#include "../skeletons/parameters.glsl"
#include "../shared/gathered_light.glsl"
layout(std430, binding = 0) readonly buffer samples_buffer { gather_sample samples[]; };
layout(std430, binding = 1) readonly buffer hits_buffer { gather_hit hits[]; };
layout(std430, binding = 2) readonly buffer arriving_buffer { vec4 arriving[]; };
layout(std430, binding = 3) readonly buffer before_buffer { vec4 before[]; };
layout(std430, binding = 4) writeonly buffer direct_buffer { vec4 direct[]; };

void kernel_map(uint i) {
    vec3 n = samples[i].normal;
    precise float along = (n.x * direction.x + n.y * direction.y) + n.z * direction.z;
    bool lit = along > 0.0 && weight_of_sample(samples[i], direction) > 0.0 &&
               hits[i].surface == 0xffffffffu;
    float part = dimmed != 0u ? arriving[i].y : 1.0;
    precise float light = lit ? along * part : 0.0;
    precise vec4 sum = before[i] + irradiance * light;
    direct[i] = sum;
}
