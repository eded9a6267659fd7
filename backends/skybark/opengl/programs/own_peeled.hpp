// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 447971e10c440c78d8095f3b3e54ea0ba9b7541627b0f98d70969f6f3d214a67
#pragma once

#include <string_view>

namespace skybark::opengl {

inline constexpr std::string_view peeled_comp{R"glsl(#version 450
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
layout(binding = SKYBARK_IMAGE_BINDING) uniform usampler2D raster;
layout(std430, binding = 8) writeonly buffer depths_buffer { uint depths[]; };
layout(std430, binding = 9) writeonly buffer triangles_buffer { uint triangles[]; };
layout(std430, binding = 10) buffer count_buffer { uint count[]; };
shared uint drawn;
void main() {
uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 256u +
gl_LocalInvocationID.x;
if (gl_LocalInvocationID.x == 0u) {
drawn = 0u;
}
barrier();
if (i < skybark_header.y) {
uvec2 fragment =
texelFetch(raster, ivec2(i % skybark_header.x, i / skybark_header.x), 0).xy;
triangles[i] = fragment.x;
depths[i] = fragment.y;
if (fragment.y != 0u) {
atomicAdd(drawn, 1u);
}
}
barrier();
if (gl_LocalInvocationID.x == 0u && drawn != 0u) {
atomicAdd(count[0], drawn);
atomicAdd(count[1], drawn);
}
}
)glsl", 2357};

} // namespace skybark::opengl
