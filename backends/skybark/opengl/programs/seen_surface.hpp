// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 9da6b0cf18b07b46606338ca493d180c8625154618b642449fea2bc9118cbf18
#pragma once

#include <skybark/kernels/seen_surface.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::seen_surface> {
    static constexpr std::string_view draw_vert{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_VERTEX_STAGE
#define KERNEL_VARYINGS 2
struct surface_vertex {
vec3 position;
float u;
vec3 normal;
float v;
vec4 tangent;
};
struct branch_end {
vec3 position;
float radius;
vec4 orientation;
float path;
float slope;
float reserved0;
float reserved1;
};
struct branch_segment {
uint start;
uint end;
uint caps;
uint reserved;
};
struct segment_pose {
vec4 rotation;
vec3 base;
float reserved0;
vec3 shift;
float reserved1;
};
struct end_carrier {
uint moved_by;
uint turned_by;
uint and_by;
uint reserved;
};
struct leaf {
vec3 position;
float width;
vec4 orientation;
float length;
uint carrier;
uint seed;
float fold;
};
struct segment_load {
vec3 force;
float drag;
};
struct cloud_particle {
vec3 position;
float radius;
float optical_depth;
float albedo;
float reserved0;
float reserved1;
};
struct light_grid {
vec4 anchor;
vec4 row_x;
vec4 row_y;
vec4 row_z;
vec4 voxel;
};
struct gather_triangle {
vec3 a;
uint material;
vec3 b;
uint alpha;
vec3 c;
uint reserved;
};
struct gather_material {
vec3 diffuse;
uint two_sided;
vec3 emission;
float reserved0;
vec3 transmission;
float reserved1;
};
struct gather_sample {
vec3 position;
float reserved0;
vec3 normal;
float reserved1;
};
struct gather_hit {
float distance;
uint surface;
float u;
float v;
};
struct ray_bundle {
vec4 centre;
vec4 right;
vec4 up;
vec4 direction;
};
struct patch_table {
uint front;
uint back;
uint rows;
uint reserved;
};
#define KERNEL_PARAMETERS vec4 to_clip_x; vec4 to_clip_y; vec4 to_clip_z; vec4 to_clip_w;
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
uint alpha_texel(float place, uint count)
{
float within = place - floor(place);
float texel = within * float(count);
return texel > 0.0f ? min(uint(min(texel, 65535.0f)), count - 1u) : 0u;
}
float alpha_place(float a, float b, float c, float u, float v)
{
precise float place = (a + u * (b - a)) + v * (c - a);
return place;
}
layout(std430, binding = 0) readonly buffer triangles_buffer { gather_triangle triangles[]; };
layout(std430, binding = 1) readonly buffer alpha_buffer { uint alpha[]; };
#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
uint number = index / 3u;
uint corner = index % 3u;
gather_triangle t = triangles[number];
vec3 place = corner == 0u ? t.a : corner == 1u ? t.b : t.c;
varying_out[0] = vec4(corner == 1u ? 1.0 : 0.0, corner == 2u ? 1.0 : 0.0,
float(number % 2048u), float(number / 2048u));
varying_out[1] = vec4(float(t.alpha % 2048u), float(t.alpha / 2048u), 0.0, 0.0);
vec4 p = vec4(place, 1.0);
return vec4(dot(to_clip_x, p), dot(to_clip_y, p), dot(to_clip_z, p), dot(to_clip_w, p));
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
float alpha_value(uint word) { return uintBitsToFloat(alpha[word]); }
bool is_hole(uint number, float u, float v) {
if (number == 0u) {
return false;
}
uint at = 12u * (number - 1u);
uint size = alpha[at + 7u];
float s = alpha_place(alpha_value(at), alpha_value(at + 2u), alpha_value(at + 4u), u, v);
float t = alpha_place(alpha_value(at + 1u), alpha_value(at + 3u), alpha_value(at + 5u), u, v);
uint column = alpha_texel(s, size & 0xffffu);
uint row = alpha_texel(t, size >> 16);
return alpha_value(alpha[at + 6u] + row * (size & 0xffffu) + column) < alpha_value(at + 8u);
}
bool kernel_fragment(vec2 pixel, bool front) {
vec4 place = varying_in[0];
float u = clamp(place.x, 0.0, 1.0);
float v = clamp(place.y, 0.0, 1.0 - u);
vec2 holes = floor(varying_in[1].xy + 0.5);
if (is_hole(2048u * uint(holes.y) + uint(holes.x), u, v)) {
return false;
}
color_out = vec4(u, v, 2.0 * floor(place.z + 0.5) + (front ? 0.0 : 1.0),
floor(place.w + 0.5));
return true;
}
#endif
void main() { gl_Position = kernel_vertex(uint(SKYBARK_VERTEX_INDEX)); }
)glsl", 5106};
    static constexpr std::string_view draw_frag{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_FRAGMENT_STAGE
#define KERNEL_VARYINGS 2
struct surface_vertex {
vec3 position;
float u;
vec3 normal;
float v;
vec4 tangent;
};
struct branch_end {
vec3 position;
float radius;
vec4 orientation;
float path;
float slope;
float reserved0;
float reserved1;
};
struct branch_segment {
uint start;
uint end;
uint caps;
uint reserved;
};
struct segment_pose {
vec4 rotation;
vec3 base;
float reserved0;
vec3 shift;
float reserved1;
};
struct end_carrier {
uint moved_by;
uint turned_by;
uint and_by;
uint reserved;
};
struct leaf {
vec3 position;
float width;
vec4 orientation;
float length;
uint carrier;
uint seed;
float fold;
};
struct segment_load {
vec3 force;
float drag;
};
struct cloud_particle {
vec3 position;
float radius;
float optical_depth;
float albedo;
float reserved0;
float reserved1;
};
struct light_grid {
vec4 anchor;
vec4 row_x;
vec4 row_y;
vec4 row_z;
vec4 voxel;
};
struct gather_triangle {
vec3 a;
uint material;
vec3 b;
uint alpha;
vec3 c;
uint reserved;
};
struct gather_material {
vec3 diffuse;
uint two_sided;
vec3 emission;
float reserved0;
vec3 transmission;
float reserved1;
};
struct gather_sample {
vec3 position;
float reserved0;
vec3 normal;
float reserved1;
};
struct gather_hit {
float distance;
uint surface;
float u;
float v;
};
struct ray_bundle {
vec4 centre;
vec4 right;
vec4 up;
vec4 direction;
};
struct patch_table {
uint front;
uint back;
uint rows;
uint reserved;
};
#define KERNEL_PARAMETERS vec4 to_clip_x; vec4 to_clip_y; vec4 to_clip_z; vec4 to_clip_w;
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
uint alpha_texel(float place, uint count)
{
float within = place - floor(place);
float texel = within * float(count);
return texel > 0.0f ? min(uint(min(texel, 65535.0f)), count - 1u) : 0u;
}
float alpha_place(float a, float b, float c, float u, float v)
{
precise float place = (a + u * (b - a)) + v * (c - a);
return place;
}
layout(std430, binding = 0) readonly buffer triangles_buffer { gather_triangle triangles[]; };
layout(std430, binding = 1) readonly buffer alpha_buffer { uint alpha[]; };
#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
uint number = index / 3u;
uint corner = index % 3u;
gather_triangle t = triangles[number];
vec3 place = corner == 0u ? t.a : corner == 1u ? t.b : t.c;
varying_out[0] = vec4(corner == 1u ? 1.0 : 0.0, corner == 2u ? 1.0 : 0.0,
float(number % 2048u), float(number / 2048u));
varying_out[1] = vec4(float(t.alpha % 2048u), float(t.alpha / 2048u), 0.0, 0.0);
vec4 p = vec4(place, 1.0);
return vec4(dot(to_clip_x, p), dot(to_clip_y, p), dot(to_clip_z, p), dot(to_clip_w, p));
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
float alpha_value(uint word) { return uintBitsToFloat(alpha[word]); }
bool is_hole(uint number, float u, float v) {
if (number == 0u) {
return false;
}
uint at = 12u * (number - 1u);
uint size = alpha[at + 7u];
float s = alpha_place(alpha_value(at), alpha_value(at + 2u), alpha_value(at + 4u), u, v);
float t = alpha_place(alpha_value(at + 1u), alpha_value(at + 3u), alpha_value(at + 5u), u, v);
uint column = alpha_texel(s, size & 0xffffu);
uint row = alpha_texel(t, size >> 16);
return alpha_value(alpha[at + 6u] + row * (size & 0xffffu) + column) < alpha_value(at + 8u);
}
bool kernel_fragment(vec2 pixel, bool front) {
vec4 place = varying_in[0];
float u = clamp(place.x, 0.0, 1.0);
float v = clamp(place.y, 0.0, 1.0 - u);
vec2 holes = floor(varying_in[1].xy + 0.5);
if (is_hole(2048u * uint(holes.y) + uint(holes.x), u, v)) {
return false;
}
color_out = vec4(u, v, 2.0 * floor(place.z + 0.5) + (front ? 0.0 : 1.0),
floor(place.w + 0.5));
return true;
}
#endif
void main() {
if (!kernel_fragment(gl_FragCoord.xy, gl_FrontFacing)) {
discard;
}
}
)glsl", 5119};
};

} // namespace skybark::opengl
