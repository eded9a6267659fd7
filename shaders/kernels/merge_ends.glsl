// Device side of skybark::kernels::merge_ends.
#include "../skeletons/parameters.glsl"
#include "../shared/detail.glsl"
layout(std430, binding = 0) readonly buffer ends_buffer { branch_end ends[]; };
layout(std430, binding = 1) readonly buffer shares_buffer { uvec4 shares[]; };
layout(std430, binding = 2) readonly buffer chains_buffer { uvec4 chains[]; };
layout(std430, binding = 3) writeonly buffer merged_buffer { branch_end merged[]; };

void kernel_map(uint i) {
    uvec4 share = shares[i];
    uvec4 chain = chains[share.z];
    branch_end e = ends[i];
    float fraction = uintBitsToFloat(chain.w);
    if (fraction < 1.0 && i != chain.x && share.w % (2u * chain.z) == chain.z) {
        e = end_on_its_way(ends[i - chain.z], ends[min(i + chain.z, chain.x)], e, fraction);
    }
    merged[i] = e;
}
