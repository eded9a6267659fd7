// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 60335632bf73cefb9450067ad7402ee0760be027f3d41217d23375d4989f242f
#pragma once

#include <string_view>

namespace skybark::opengl {

inline constexpr std::string_view scan_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
layout(local_size_x = 256) in;
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
)glsl", 2812};

} // namespace skybark::opengl
