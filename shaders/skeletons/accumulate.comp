#version 450
// accumulate: a group adds some slabs of one element, so that what the kernel knows of the element
// is the same for all its invocations: 16 of them, or as many as a constant says. Of these, header.z's
// lower half stand beside each other in a slab and go through its columns together; the others are
// at the next slabs.
//
// An element has `parts` groups in a row, for loops that are too long for one: as many as header.z's
// upper half says share a slab's columns, times kernel_slabs() over the upper half of header.w,
// rounded up, which is the number of slabs that a group goes through. More than 65,535 groups go
// into the second dimension. (llvmpipe ends an invocation's loops after 65,535 turns altogether.)
//
// header.x: the first element, y: the number of elements, w: bit 0: elements from the device's
// length on are left out; bit 1: a slab's lines of memory are read before they are added to; bits 2
// to 15: zero. The volume of int32 is an image at SKYBARK_SUMS_BINDING.
#define SKYBARK_COMPUTE_STAGE
#ifdef SKYBARK_VULKAN
layout(local_size_x_id = 0) in;
#else
layout(local_size_x = 16) in;
#endif
#include KERNEL
layout(std430, binding = 10) readonly buffer skybark_length_buffer { uint skybark_length[]; };
layout(binding = SKYBARK_SUMS_BINDING, r32i) uniform iimage3D skybark_sums;

// Reads the first and the last voxel of every step-th row, and with them the lines of memory that
// most slabs lie in. A processor waits for all of these at once, but for atomic additions one by
// one. Returns 0, which no compiler knows, and so none leaves the reads out.
int skybark_fetch(ivec2 low, ivec2 high, int slice, int row, int step) {
    int all = 0;
    for (int y = low.y + row; y < high.y; y += step) {
        all |= imageLoad(skybark_sums, ivec3(low.x, y, slice)).x;
        all |= imageLoad(skybark_sums, ivec3(high.x - 1, y, slice)).x;
    }
    return all & int(skybark_header.w & 0xfffcu);
}

// Every step-th column of a slab, from the one of this number on.
void skybark_add(uint i, uint s, int column, int step, ivec3 size) {
    voxel_slab slab = kernel_slab(i, s);
    if (slab.slice < 0 || slab.slice >= size.z) {
        return;
    }
    ivec2 low = clamp(slab.low, ivec2(0), size.xy);
    ivec2 high = min(slab.high, size.xy);
    int first = low.x + column;
    if ((skybark_header.w & 2u) != 0u && low.x < high.x && high.y - low.y > 1) {
        first += skybark_fetch(low, high, slab.slice, column, step);
    }
    for (int x = first; x < high.x; x += step) {
        float lateral = kernel_lateral(i, x, slab.slice);
        float row = kernel_row(i, low.y);
        for (int y = low.y; y < high.y; ++y) {
            float above = kernel_row(i, y + 1);
            int amount = kernel_amount(lateral, row, above);
            if (amount != 0) { // an atomic addition is dear
                imageAtomicAdd(skybark_sums, ivec3(x, y, slab.slice), amount);
            }
            row = above;
        }
    }
}

void main() {
    uint lanes = skybark_header.z & 0xffffu;
    uint sharing = skybark_header.z >> 16;
    uint each = skybark_header.w >> 16;
    uint parts = (kernel_slabs() + each - 1u) / each * sharing;
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint k = group / parts;
    uint i = skybark_header.x + k;
    bool counted = (skybark_header.w & 1u) != 0u;
    if (k >= skybark_header.y || (counted && i >= skybark_length[0])) {
        return;
    }
    uint part = group - k * parts;
    uint slot = gl_LocalInvocationID.x / lanes;
    uint column = part % sharing * lanes + gl_LocalInvocationID.x - slot * lanes;
    uint first = part / sharing * each;
    uint last = min(first + each, kernel_slab_count(i));
    ivec3 size = imageSize(skybark_sums);
    for (uint s = first + slot; s < last; s += gl_WorkGroupSize.x / lanes) {
        skybark_add(i, s, int(column), int(lanes * sharing), size);
    }
}
