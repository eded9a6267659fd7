// Device side of skybark::kernels::merge_chains.
#define KERNEL_PARAMETERS vec4 camera; float error;
#include "../skeletons/parameters.glsl"
#include "../shared/detail.glsl"
layout(std430, binding = 0) readonly buffer chains_buffer { uvec4 chains[]; };
layout(std430, binding = 1) readonly buffer ends_buffer { branch_end ends[]; };
layout(std430, binding = 2) writeonly buffer details_buffer { uvec4 details[]; };

float nearest_end(uint first, uint last) {
    float least = 1e30;
    for (uint i = first; i <= last; ++i) {
        vec3 away = ends[i].position - camera.xyz;
        least = min(least, dot3(away, away));
    }
    return max(sqrt(least), 1e-6);
}

// The longest way of the ends that pieces of twice the length leave out.
float longest_way(uint first, uint last, uint stride) {
    float most = 0.0;
    for (uint i = first + stride; i < last; i += 2u * stride) {
        most = max(most, way_between(ends[i - stride], ends[min(i + stride, last)], ends[i]));
    }
    return most;
}

void kernel_map(uint i) {
    uvec4 chain = chains[i];
    uint first = chain.x;
    uint last = chain.y;
    uint stride = 1u;
    float fraction = 1.0;
    if (error > 0.0 && last - first > 1u) {
        float scale = camera.w / (nearest_end(first, last) * error);
        float off = 0.0;
        bool more = true;
        while (more && stride < last - first) {
            off = max(2.0 * off, longest_way(first, last, stride) * scale);
            more = off <= 1.0;
            if (more) {
                stride = 2u * stride;
            }
        }
        fraction = !more && off < 2.0 ? off - 1.0 : 1.0;
    }
    details[i] = uvec4(last, chain.z, stride, floatBitsToUint(fraction));
}
