// Device side of skybark::kernels::gathered_irradiance.
#define KERNEL_PARAMETERS uint samples; uint replicates;
#include "../skeletons/parameters.glsl"
#include "../shared/gathered_light.glsl"
layout(std430, binding = 0) readonly buffer sums_buffer { vec4 sums[]; };
layout(std430, binding = 1) readonly buffer direct_buffer { vec4 direct[]; };
layout(std430, binding = 2) writeonly buffer found_buffer { vec4 found[]; };

void kernel_map(uint i) {
    const float pi = 3.14159265;
    vec4 all = vec4(0.0);
    for (uint j = 0u; j < replicates; ++j) {
        all += sums[j * samples + i];
    }
    if (!(all.w > 0.0)) {
        found[i] = vec4(direct[i].xyz, 1e30);
        return;
    }
    float mean = luminance_of(all) / all.w;
    float squares = 0.0;
    for (uint j = 0u; j < replicates; ++j) {
        vec4 one = sums[j * samples + i];
        float apart = luminance_of(one) - mean * one.w;
        squares += apart * apart;
    }
    float n = float(replicates);
    float scale = pi / all.w;
    found[i] = vec4(all.xyz * scale + direct[i].xyz, scale * sqrt(squares * n / (n - 1.0)));
}
