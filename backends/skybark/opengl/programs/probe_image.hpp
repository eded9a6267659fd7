// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 5043009a3e5ca24d69c0eb51a7aab4102c1dcab7068a2ee7e38d239c1921b120
#pragma once

#include <skybark/kernels/probe_image.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::probe_image> {
    static constexpr std::string_view draw_vert{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_VERTEX_STAGE
#define KERNEL_PARAMETERS uint read; int offset_x; int offset_y;
#define KERNEL_VARYINGS 1
#define KERNEL_IMAGES 2
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
struct probe_vertex {
vec4 position;
vec4 color;
};
layout(std430, binding = 0) readonly buffer vertices_buffer { probe_vertex vertices[]; };
#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
varying_out[0] = vertices[index].color;
return vertices[index].position;
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
ivec2 texel = ivec2(pixel) + ivec2(offset_x, offset_y);
vec2 uv = varying_in[0].xy;
switch (read) {
case 0u:
color_out = texelFetch(kernel_images[0], texel, 0);
break;
case 1u:
color_out = textureLod(kernel_images[0], uv, 0.0);
break;
case 2u:
color_out = vec4(textureSize(kernel_images[0], 0), textureSize(kernel_images[1], 0));
break;
case 3u:
color_out = texelFetch(kernel_images[1], texel, 0);
break;
default:
color_out = textureLod(kernel_images[1], uv, 0.0);
break;
}
return true;
}
#endif
void main() { gl_Position = kernel_vertex(uint(SKYBARK_VERTEX_INDEX)); }
)glsl", 2562};
    static constexpr std::string_view draw_frag{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_FRAGMENT_STAGE
#define KERNEL_PARAMETERS uint read; int offset_x; int offset_y;
#define KERNEL_VARYINGS 1
#define KERNEL_IMAGES 2
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
struct probe_vertex {
vec4 position;
vec4 color;
};
layout(std430, binding = 0) readonly buffer vertices_buffer { probe_vertex vertices[]; };
#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
varying_out[0] = vertices[index].color;
return vertices[index].position;
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
ivec2 texel = ivec2(pixel) + ivec2(offset_x, offset_y);
vec2 uv = varying_in[0].xy;
switch (read) {
case 0u:
color_out = texelFetch(kernel_images[0], texel, 0);
break;
case 1u:
color_out = textureLod(kernel_images[0], uv, 0.0);
break;
case 2u:
color_out = vec4(textureSize(kernel_images[0], 0), textureSize(kernel_images[1], 0));
break;
case 3u:
color_out = texelFetch(kernel_images[1], texel, 0);
break;
default:
color_out = textureLod(kernel_images[1], uv, 0.0);
break;
}
return true;
}
#endif
void main() {
if (!kernel_fragment(gl_FragCoord.xy, gl_FrontFacing)) {
discard;
}
}
)glsl", 2575};
};

} // namespace skybark::opengl
