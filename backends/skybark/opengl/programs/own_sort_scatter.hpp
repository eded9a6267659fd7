// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 a446b756b949d17107150b7fbc0299d4378ce554f625ede85e333f325678ce32
#pragma once

#include <string_view>

namespace skybark::opengl {

inline constexpr std::string_view sort_scatter_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
layout(local_size_x = 64) in;
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
layout(std430, binding = 10) readonly buffer skybark_length_buffer { uint skybark_length[]; };
uint skybark_elements() {
return (skybark_header.w & 1u) != 0u ? min(skybark_header.y, skybark_length[0])
: skybark_header.y;
}
const uint lanes = 64u;
const uint each = 16u;
const uint digits = 16u;
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
if (digit < digits && block < skybark_header.z) {
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
)glsl", 3444};

} // namespace skybark::opengl
