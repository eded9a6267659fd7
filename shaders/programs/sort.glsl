// A stable sort of pairs by 4 bits of their keys, from the bit header.x on; eight of these, from
// the lowest bits to the highest, sort by 32 (radix sort, least significant digit first).
//
//     sort_count    counts[digit * header.z + block]: the pairs of a block with that digit
//     scan          of those 16 * header.z words: where each block's pairs of a digit go
//     sort_scatter  the pairs go there
//
// A block is 1024 pairs and a group of 64 invocations, each with 16 pairs in a row; groups beyond
// 65,535 go into the second dimension. header.y: the number of pairs or their upper limit, z: the
// number of blocks (header.y / 1024, rounded up), w: bit 0: the length is on the device, in the
// first word at binding 10. Blocks beyond it count nothing.
//
// Bindings: sort_count: 8 counts out, 9 keys in. sort_scatter: 0 keys out, 1 values out, 2 keys in,
// 3 values in, 9 the scanned counts.
layout(local_size_x = 64) in;
#include "../skeletons/parameters.glsl"
#include "../skeletons/length.glsl"
const uint lanes = 64u;
const uint each = 16u;
const uint digits = 16u;
// A row of counters for each invocation. An odd pitch keeps rows in different banks.
const uint pitch = 17u;
shared uint counters[64u * 17u];

uint block_of_group() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }

uint first_pair() { return (block_of_group() * lanes + gl_LocalInvocationID.x) * each; }

uint end_of_pairs() { return min(first_pair() + each, skybark_elements()); }

uint counter_of(uint key) {
    return gl_LocalInvocationID.x * pitch + ((key >> skybark_header.x) & (digits - 1u));
}

void clear_counters() {
    for (uint digit = 0u; digit < digits; ++digit) {
        counters[gl_LocalInvocationID.x * pitch + digit] = 0u;
    }
}
