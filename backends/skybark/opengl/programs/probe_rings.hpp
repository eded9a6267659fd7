// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 d659b69c98c3026489ebf530d34f3088bc06ee0a3e7f05d383070d94e6877946
#pragma once

#include <skybark/kernels/probe_rings.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::probe_rings> {
    static constexpr std::string_view expand_vert{R"glsl(#version 450
#define SKYBARK_OPENGL
layout(location = 0) flat out uint skybark_point;
void main() { skybark_point = uint(gl_VertexID); }
)glsl", 137};
    static constexpr std::string_view rings_geom{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_EXPAND
#define KERNEL_PARAMETERS uint around;
#define VERTEX_VEC4S 1
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
layout(std430, binding = 0) readonly buffer payloads_buffer { vec4 payloads[]; };
uint kernel_ring_vertices() { return around; }
void kernel_ring(uint i, uint first, uint count) {
for (uint j = first; j < first + count; ++j) {
vertex_out[0] = vec4(float(i), float(j), payloads[i].x, payloads[i].y);
emit_vertex();
}
}
#ifndef SKYBARK_MAX_VERTICES
#define SKYBARK_MAX_VERTICES 16
#endif
layout(points) in;
layout(location = 0) flat in uint skybark_point[1];
layout(xfb_buffer = 0, xfb_stride = 16 * VERTEX_VEC4S) out;
layout(location = 0, xfb_buffer = 0, xfb_offset = 0) out vec4 skybark_vertex[VERTEX_VEC4S];
void emit_vertex() {
for (int v = 0; v < VERTEX_VEC4S; ++v) {
skybark_vertex[v] = vertex_out[v];
}
EmitVertex();
}
layout(points, max_vertices = SKYBARK_MAX_VERTICES) out;
void main() {
uint vertices = kernel_ring_vertices();
uint part = skybark_header.z;
uint parts = (vertices + part - 1u) / part;
uint element = skybark_point[0] / parts;
uint first = (skybark_point[0] - element * parts) * part;
kernel_ring(skybark_header.x + element, first, min(part, vertices - first));
}
)glsl", 2659};
};

} // namespace skybark::opengl
