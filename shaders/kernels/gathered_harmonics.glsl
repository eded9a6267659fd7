// Device side of skybark::kernels::gathered_harmonics.
#define KERNEL_PARAMETERS float each;
#include "../skeletons/parameters.glsl"
#include "../shared/gathered_light.glsl"
layout(std430, binding = 0) readonly buffer moments_buffer { vec4 moments[]; };
layout(std430, binding = 1) writeonly buffer found_buffer { vec4 found[]; };

void kernel_map(uint i) {
    for (uint k = 3u * i; k < 3u * i + 3u; ++k) {
        found[k] = harmonics_of(moments[k], each);
    }
}
