// A block of 4096 words becomes its running sum, each word's own value left out; the block's sum
// goes aside. Additions stop at 2^32 - 1, which keeps them associative. Values are read through one
// binding and written through another, of the same buffer: a word's reader is its writer.
layout(local_size_x = 256) in;
#include "../skeletons/parameters.glsl"
layout(std430, binding = 8) writeonly buffer out_buffer { uint values_out[]; };
layout(std430, binding = 9) readonly buffer in_buffer { uint values_in[]; };
layout(std430, binding = 10) writeonly buffer sums_buffer { uint sums[]; };
const uint each = 16u;
shared uint shared_sums[2][256];

uint add(uint a, uint b) {
    uint carry;
    uint sum = uaddCarry(a, b, carry);
    return carry != 0u ? 0xffffffffu : sum;
}

void main() {
    uint block = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint lane = gl_LocalInvocationID.x;
    uint start = (block * 256u + lane) * each;
    uint values[each];
    uint sum = 0u;
    for (uint j = 0u; j < each; ++j) {
        values[j] = start + j < skybark_header.y ? values_in[start + j] : 0u;
        sum = add(sum, values[j]);
    }
    shared_sums[0][lane] = sum;
    barrier();
    uint now = 0u;
    for (uint step = 1u; step < 256u; step *= 2u) {
        uint here = shared_sums[now][lane];
        shared_sums[1u - now][lane] = lane >= step ? add(here, shared_sums[now][lane - step]) : here;
        now = 1u - now;
        barrier();
    }
    uint running = lane > 0u ? shared_sums[now][lane - 1u] : 0u;
    for (uint j = 0u; j < each; ++j) {
        if (start + j < skybark_header.y) {
            values_out[start + j] = running;
        }
        running = add(running, values[j]);
    }
    if (lane == 255u && block * 4096u < max(skybark_header.y, 1u)) {
        sums[block] = running;
    }
}
