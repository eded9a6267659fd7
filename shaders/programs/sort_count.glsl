// How many pairs of each block have which digit; see sort.glsl.
#include "sort.glsl"
layout(std430, binding = 8) writeonly buffer counts_buffer { uint counts[]; };
layout(std430, binding = 9) readonly buffer keys_buffer { uint keys[]; };

void main() {
    clear_counters();
    uint end = end_of_pairs();
    for (uint i = first_pair(); i < end; ++i) {
        ++counters[counter_of(keys[i])];
    }
    barrier();
    uint block = block_of_group();
    uint digit = gl_LocalInvocationID.x;
    if (digit < digits && block < skybark_header.z) {
        uint sum = 0u;
        for (uint lane = 0u; lane < lanes; ++lane) {
            sum += counters[lane * pitch + digit];
        }
        counts[digit * skybark_header.z + block] = sum;
    }
}
