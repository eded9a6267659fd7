// The pairs of each block go to where the scanned counts say; see sort.glsl. Of equal digits those
// of the lower invocation go first, and of one invocation the earlier: their order is kept.
#include "sort.glsl"
layout(std430, binding = 0) writeonly buffer keys_out_buffer { uint keys_out[]; };
layout(std430, binding = 1) writeonly buffer values_out_buffer { uint values_out[]; };
layout(std430, binding = 2) readonly buffer keys_in_buffer { uint keys_in[]; };
layout(std430, binding = 3) readonly buffer values_in_buffer { uint values_in[]; };
layout(std430, binding = 9) readonly buffer offsets_buffer { uint offsets[]; };

void main() {
    clear_counters();
    uint end = end_of_pairs();
    for (uint i = first_pair(); i < end; ++i) {
        ++counters[counter_of(keys_in[i])];
    }
    barrier();
    uint block = block_of_group();
    uint digit = gl_LocalInvocationID.x;
    if (digit < digits && block < skybark_header.z) { // counts become places
        uint place = offsets[digit * skybark_header.z + block];
        for (uint lane = 0u; lane < lanes; ++lane) {
            uint count = counters[lane * pitch + digit];
            counters[lane * pitch + digit] = place;
            place += count;
        }
    }
    barrier();
    for (uint i = first_pair(); i < end; ++i) {
        uint key = keys_in[i];
        uint place = counters[counter_of(key)]++;
        keys_out[place] = key;
        values_out[place] = values_in[i];
    }
}
