// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 3801272453e8bbf76a83e0be91a1051d5f4e4211d02f9e6a069844c025b1dd78
#pragma once

#include <skybark/kernels/probe_strips.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::probe_strips> {
    static constexpr std::string_view expand_vert{R"glsl(#version 450
#define SKYBARK_OPENGL
layout(location = 0) flat out uint skybark_point;
void main() { skybark_point = uint(gl_VertexID); }
)glsl", 137};
    static constexpr std::string_view strips_geom{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_EXPAND
#define KERNEL_PARAMETERS uint strip_count; uint most;
#define VERTEX_VEC4S 2
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
layout(std430, binding = 0) readonly buffer counts_buffer { uint counts[]; };
layout(std430, binding = 1) readonly buffer payloads_buffer { vec4 payloads[]; };
uint kernel_strips() { return strip_count; }
uint kernel_strip_triangles() { return most; }
uint kernel_triangles(uint i, uint strip) { return counts[i * strip_count + strip]; }
void kernel_strip(uint i, uint strip, uint first, uint count) {
for (uint j = first; j < first + count; ++j) {
vertex_out[0] = vec4(float(i), float(strip), float(j), 1.0);
vertex_out[1] = payloads[i];
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
layout(triangle_strip, max_vertices = SKYBARK_MAX_VERTICES) out;
void skybark_pad(uint count) {
for (int v = 0; v < VERTEX_VEC4S; ++v) {
vertex_out[v] = vec4(0.0);
}
for (uint v = 0u; v < count + 2u; ++v) {
emit_vertex();
}
EndPrimitive();
}
void skybark_run(uint element, uint strip, uint first, uint count) {
uint present = kernel_triangles(element, strip);
present = present > first ? min(present - first, count) : 0u;
if (present != 0u) {
kernel_strip(element, strip, first, present + 2u);
EndPrimitive();
}
if ((skybark_header.w & 2u) != 0u && present != count) {
skybark_pad(count - present);
}
}
void main() {
uint strips = kernel_strips();
uint length = kernel_strip_triangles();
uint whole = skybark_header.z / length;
uint pieces = (length + skybark_header.z - 1u) / skybark_header.z;
uint parts = whole != 0u ? (strips + whole - 1u) / whole : strips * pieces;
uint element = skybark_point[0] / parts;
uint part = skybark_point[0] - element * parts;
uint strip = whole != 0u ? part * whole : part / pieces;
uint first = whole != 0u ? 0u : (part - strip * pieces) * skybark_header.z;
uint count = whole != 0u ? length : min(skybark_header.z, length - first);
uint last = min(strip + max(whole, 1u), strips);
for (; strip < last; ++strip) {
skybark_run(skybark_header.x + element, strip, first, count);
}
}
)glsl", 3867};
};

} // namespace skybark::opengl
