// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 79e9272e3f86c62d9d58f43938faab013758fb35241a1a2abbb6ada311d94392
#pragma once

#include <skybark/kernels/probe_slabs.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::probe_slabs> {
    static constexpr std::string_view accumulate_comp = R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 64) in;
#define KERNEL_PARAMETERS uint most; int per_x; int per_z; int factor;
#ifdef SKYBARK_VULKAN
layout(push_constant) uniform skybark_block {
#define SKYBARK_VERTEX_INDEX gl_VertexIndex
#define SKYBARK_IMAGE_BINDING 16
#define SKYBARK_VOLUME_BINDING 17
#define SKYBARK_TARGET_BINDING 18
#define SKYBARK_SUMS_BINDING 19
#else
layout(std140, binding = 0) uniform skybark_block {
#define SKYBARK_VERTEX_INDEX gl_VertexID
#define SKYBARK_IMAGE_BINDING 0
#define SKYBARK_VOLUME_BINDING 8
#define SKYBARK_TARGET_BINDING 0
#define SKYBARK_SUMS_BINDING 4
#endif
    uvec4 skybark_header;
#ifdef KERNEL_PARAMETERS
    KERNEL_PARAMETERS
#endif
};
struct voxel_slab {
    ivec2 low;
    ivec2 high;
    int slice;
};
#ifdef SKYBARK_EXPAND
vec4 vertex_out[VERTEX_VEC4S];
void emit_vertex();
#endif
#ifdef SKYBARK_VERTEX_STAGE
layout(location = 0) out vec4 varying_out[KERNEL_VARYINGS];
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
layout(location = 0) in vec4 varying_in[KERNEL_VARYINGS];
layout(location = 0) out vec4 color_out;
#endif
#if defined(KERNEL_IMAGES) && defined(SKYBARK_FRAGMENT_STAGE)
layout(binding = SKYBARK_IMAGE_BINDING) uniform sampler2D kernel_images[KERNEL_IMAGES];
#endif
#if defined(KERNEL_VOLUMES) && (defined(SKYBARK_FRAGMENT_STAGE) || defined(SKYBARK_COMPUTE_STAGE))
layout(binding = SKYBARK_VOLUME_BINDING) uniform sampler3D kernel_volumes[KERNEL_VOLUMES];
#endif
#if defined(KERNEL_TARGETS) && defined(SKYBARK_COMPUTE_STAGE)
layout(binding = SKYBARK_TARGET_BINDING, r32f) writeonly uniform image3D kernel_targets[KERNEL_TARGETS];
#endif
struct probe_box {
    ivec4 low;
    ivec4 high;
};
layout(std430, binding = 0) readonly buffer boxes_buffer { probe_box boxes[]; };
uint kernel_slabs() { return most; }
uint kernel_slab_count(uint i) { return min(uint(max(boxes[i].high.z - boxes[i].low.z, 0)), most); }
voxel_slab kernel_slab(uint i, uint s) {
    probe_box box = boxes[i];
    int by = int(s);
    return voxel_slab(ivec2(box.low.x + by, box.low.y), ivec2(box.high.x, box.high.y - by),
                      box.low.z + by);
}
float kernel_lateral(uint i, int x, int z) {
    return float(boxes[i].low.w + per_x * x + per_z * z);
}
int kernel_amount(uint i, float lateral, int y) {
    return (int(lateral) + boxes[i].high.w * y) * factor;
}
layout(std430, binding = 10) readonly buffer skybark_length_buffer { uint skybark_length[]; };
uint skybark_elements() {
    return (skybark_header.w & 1u) != 0u ? min(skybark_header.y, skybark_length[0])
                                         : skybark_header.y;
}
layout(binding = SKYBARK_SUMS_BINDING, r32i) uniform iimage3D skybark_sums;
void skybark_add(uint i, uint s, uint lane, ivec3 size) {
    voxel_slab slab = kernel_slab(i, s);
    if (slab.slice < 0 || slab.slice >= size.z) {
        return;
    }
    ivec2 low = clamp(slab.low, ivec2(0), size.xy);
    ivec2 high = min(slab.high, size.xy);
    for (int x = low.x + int(lane); x < high.x; x += int(skybark_header.z)) {
        float lateral = kernel_lateral(i, x, slab.slice);
        for (int y = low.y; y < high.y; ++y) {
            int amount = kernel_amount(i, lateral, y);
            if (amount != 0) { // an atomic addition is dear
                imageAtomicAdd(skybark_sums, ivec3(x, y, slab.slice), amount);
            }
        }
    }
}
void main() {
    uint each = skybark_header.w >> 16;
    uint parts = (kernel_slabs() + each - 1u) / each;
    uint id = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
              gl_LocalInvocationID.x;
    uint work = id / skybark_header.z;
    uint lane = id - work * skybark_header.z;
    uint k = work / parts;
    if (k >= skybark_elements()) {
        return;
    }
    uint i = skybark_header.x + k;
    uint first = (work - k * parts) * each;
    uint last = min(first + each, kernel_slab_count(i));
    ivec3 size = imageSize(skybark_sums);
    for (uint s = first; s < last; ++s) {
        skybark_add(i, s, lane, size);
    }
}
)glsl";
};

} // namespace skybark::opengl
