// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 8a190ab8850b615b6194c2fbbe82ac2f393fb923af6b4b6a83db62b44a14699e
#pragma once

#include <skybark/kernels/probe_peel.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::probe_peel> {
    static constexpr std::string_view peel_vert{R"glsl(#version 450
#define SKYBARK_OPENGL
#define KERNEL_PARAMETERS vec4 scale; vec4 shift;
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
layout(std430, binding = 0) readonly buffer corners_buffer { vec4 corners[]; };
vec4 kernel_corner(uint index) {
vec4 p = corners[index];
precise float x = p.x * scale.x + shift.x;
precise float y = p.y * scale.y + shift.y;
precise float z = p.z * scale.z + shift.z;
return vec4(x, y, z, 1.0);
}
layout(location = 0) flat out uvec2 skybark_triangle;
void main() {
uint index = skybark_header.x * 3u + uint(SKYBARK_VERTEX_INDEX);
skybark_triangle = uvec2(index / 3u, skybark_header.y);
gl_Position = kernel_corner(index);
}
)glsl", 2060};
};

} // namespace skybark::opengl
