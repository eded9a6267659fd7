// Adds to each block of 4096 words the sum of the blocks before it; see scan.glsl. header.y: the
// number of words. A group for every 256 words.
layout(local_size_x = 256) in;
#include "../skeletons/parameters.glsl"
layout(std430, binding = 8) writeonly buffer out_buffer { uint values_out[]; };
layout(std430, binding = 9) readonly buffer in_buffer { uint values_in[]; };
layout(std430, binding = 10) readonly buffer sums_buffer { uint sums[]; };

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 256u +
             gl_LocalInvocationID.x;
    if (i < skybark_header.y) {
        uint carry;
        uint sum = uaddCarry(values_in[i], sums[i / 4096u], carry);
        values_out[i] = carry != 0u ? 0xffffffffu : sum;
    }
}
