// Device side of skybark::kernels::wave_wind.
#define KERNEL_PARAMETERS vec4 mean; uint groups;
#include "../skeletons/parameters.glsl"
#include "../shared/wind.glsl"
layout(std430, binding = 0) readonly buffer places_buffer { vec4 places[]; };
layout(std430, binding = 1) readonly buffer waves_buffer { wind_waves waves[]; };
layout(std430, binding = 2) readonly buffer phases_buffer { vec4 phases[]; };
layout(std430, binding = 3) writeonly buffer air_buffer { vec4 air[]; };

void kernel_map(uint i) {
    vec4 place = places[i];
    wind_sums sum = wind_sums(vec4(0.0f), vec4(0.0f), vec4(0.0f));
    for (uint g = 0u; g < groups; ++g) {
        sum = wind_add(sum, waves[g], phases[g], place);
    }
    air[i] = wind_total(sum, mean, place.w);
}
