// Device side of skybark::kernels::branch_detail.
#define KERNEL_PARAMETERS vec4 camera; float error; float thin; uint fewest_sides; uint sides;
#include "../skeletons/parameters.glsl"
#include "../shared/detail.glsl"
layout(std430, binding = 0) readonly buffer ends_buffer { branch_end ends[]; };
layout(std430, binding = 1) readonly buffer shares_buffer { uvec4 shares[]; };
layout(std430, binding = 2) writeonly buffer details_buffer { vec4 details[]; };

void kernel_map(uint i) {
    uvec4 s = shares[i];
    chain_share share = chain_share(uintBitsToFloat(s.x), uintBitsToFloat(s.y), s.z, s.w);
    end_detail d = detail_of_end(ends[i], share, camera, error, thin, fewest_sides, sides);
    details[i] = vec4(d.sides, d.scale, d.distance, d.errors);
}
