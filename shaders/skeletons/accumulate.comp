#version 450
// accumulate: an invocation adds every header.z-th column of some slabs of one element: bits 16 to
// 31 of header.w are how many slabs, at least 1. Neighbouring invocations are neighbouring columns
// of the same slabs, then the next slabs, then the next element. So with `parts` = kernel_slabs()
// over the slabs of an invocation, rounded up, there are elements * parts * header.z invocations in
// groups of 64; more than 65,535 groups go into the second dimension.
//
// header.x: the first element, y: the number of elements, z: invocations that share a slab, w: bit
// 0: elements from the device's length on are left out. The volume of int32 is an image at
// SKYBARK_SUMS_BINDING.
//
// llvmpipe ends an invocation's loops after 65,535 turns altogether: where the device may be one,
// header.z grows until slabs * (columns / header.z) * (rows + 1) stay below that for slabs as large
// as the volume.
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 64) in;
#include KERNEL
layout(std430, binding = 10) readonly buffer skybark_length_buffer { uint skybark_length[]; };
layout(binding = SKYBARK_SUMS_BINDING, r32i) uniform iimage3D skybark_sums;

// Loops look at their end, not at their start, whether to go on: llvmpipe runs what is in a loop
// once more, for no invocation at all, where they look at the start.
void skybark_add(uint i, uint s, uint lane, ivec3 size) {
    voxel_slab slab = kernel_slab(i, s);
    ivec2 low = clamp(slab.low, ivec2(0), size.xy);
    ivec2 high = min(slab.high, size.xy);
    int x = low.x + int(lane);
    if (slab.slice < 0 || slab.slice >= size.z || x >= high.x || low.y >= high.y) {
        return;
    }
    do {
        float lateral = kernel_lateral(i, x, slab.slice);
        int y = low.y;
        do {
            int amount = kernel_amount(i, lateral, y);
            if (amount != 0) { // an atomic addition is dear
                imageAtomicAdd(skybark_sums, ivec3(x, y, slab.slice), amount);
            }
            ++y;
        } while (y < high.y);
        x += int(skybark_header.z);
    } while (x < high.x);
}

void main() {
    uint each = skybark_header.w >> 16;
    uint parts = (kernel_slabs() + each - 1u) / each;
    uint id = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
              gl_LocalInvocationID.x;
    uint work = id / skybark_header.z;
    uint lane = id - work * skybark_header.z;
    uint k = work / parts;
    uint i = skybark_header.x + k;
    bool counted = (skybark_header.w & 1u) != 0u;
    if (k >= skybark_header.y || (counted && i >= skybark_length[0])) {
        return;
    }
    uint s = (work - k * parts) * each;
    uint last = min(s + each, kernel_slab_count(i));
    if (s >= last) {
        return;
    }
    ivec3 size = imageSize(skybark_sums);
    do {
        skybark_add(i, s, lane, size);
        ++s;
    } while (s < last);
}
