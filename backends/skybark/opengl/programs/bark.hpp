// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 ac557d2591e5e35e120d70e0d218a253f41389e2be20068e1fdd2482b4d9bbc5
#pragma once

#include <skybark/kernels/bark.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::bark> {
    static constexpr std::string_view expand_vert{R"glsl(#version 450
#define SKYBARK_OPENGL
layout(location = 0) flat out uint skybark_point;
void main() { skybark_point = uint(gl_VertexID); }
)glsl", 137};
    static constexpr std::string_view strips_geom{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_EXPAND
#define KERNEL_PARAMETERS                                                                          \
uint indexed; uint base_vertex; uint width; uint height; float repeats_around;                 \
float repeats_along; float relief; float threshold; float steepest; float rounding;                \
uint levels;
#define VERTEX_VEC4S 3
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
float dot3(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
vec3 cross3(vec3 a, vec3 b) {
return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
vec3 unit_or(vec3 v, vec3 otherwise) {
float l2 = dot3(v, v);
return l2 > 1e-30f ? v * (1.0f / sqrt(l2)) : otherwise;
}
vec3 double_reflection(vec3 p1, vec3 t1, vec3 r, vec3 p2, vec3 t2) {
vec3 v1 = p2 - p1;
float c1 = dot3(v1, v1);
vec3 r_mirrored = r;
vec3 t_mirrored = t1;
if (c1 > 1e-30f) {
r_mirrored = r - v1 * (2.0f / c1 * dot3(v1, r));
t_mirrored = t1 - v1 * (2.0f / c1 * dot3(v1, t1));
}
vec3 v2 = t2 - t_mirrored;
float c2 = dot3(v2, v2);
return c2 > 1e-30f ? r_mirrored - v2 * (2.0f / c2 * dot3(v2, r_mirrored)) : r_mirrored;
}
float bark_edge_square(vec3 a, vec3 b) {
vec3 d = b - a;
return dot3(d, d);
}
uint bark_pattern(vec3 a, vec3 b, vec3 c, float threshold) {
float most = threshold * threshold;
return (bark_edge_square(a, b) > most ? 1u : 0u) | (bark_edge_square(b, c) > most ? 2u : 0u) |
(bark_edge_square(c, a) > most ? 4u : 0u);
}
uint bark_triangles(uint pattern) {
return 1u + (pattern & 1u) + ((pattern >> 1u) & 1u) + (pattern >> 2u);
}
uint bark_first_edge(uint pattern) {
return pattern == 2u || pattern == 6u ? 1u : (pattern == 4u || pattern == 5u ? 2u : 0u);
}
bool bark_has_two(uint pattern) { return bark_triangles(pattern) == 3u; }
uint bark_corner(uint pattern, bool other, uint triangle, uint corner) {
uint count = bark_triangles(pattern);
uint corners = 0x210u;
if (count == 2u) {
corners = triangle == 0u ? 0x230u : 0x213u;
} else if (count == 3u) {
corners = triangle == 0u ? 0x413u
: (other ? (triangle == 1u ? 0x430u : 0x240u)
: (triangle == 1u ? 0x230u : 0x243u));
} else if (count == 4u) {
corners = triangle == 0u ? 0x530u
: (triangle == 1u ? 0x413u : (triangle == 2u ? 0x245u : 0x543u));
}
uint code = (corners >> (4u * corner)) & 7u;
uint turned = (code < 3u ? code : code - 3u) + (count == 4u ? 0u : bark_first_edge(pattern));
return (turned < 3u ? turned : turned - 3u) + (code < 3u ? 0u : 3u);
}
float bark_texel(float coordinate, uint size) {
float part = coordinate - floor(coordinate);
float x = (part >= 0.0f && part <= 1.0f ? part : 0.0f) * float(size) - 0.5f;
return x < 0.0f ? x + float(size) : x;
}
struct bark_texels {
uint x0;
uint x1;
uint row0;
uint row1;
float x;
float y;
};
bark_texels bark_texels_at(float around, float along, uint width, uint height) {
float x = bark_texel(around, width);
float y = bark_texel(along, height);
float left = floor(x);
float low = floor(y);
bark_texels t;
t.x = x - left;
t.y = y - low;
t.x0 = uint(left) < width ? uint(left) : 0u;
t.x1 = t.x0 + 1u < width ? t.x0 + 1u : 0u;
uint row = uint(low) < height ? uint(low) : 0u;
t.row0 = row * width;
t.row1 = (row + 1u < height ? row + 1u : 0u) * width;
return t;
}
float bark_between(bark_texels t, float h00, float h10, float h01, float h11) {
float low = h00 + (h10 - h00) * t.x;
float high = h01 + (h11 - h01) * t.x;
return low + (high - low) * t.y;
}
bool bark_in_order(vec3 a, vec3 b) {
return a.x != b.x ? a.x < b.x : (a.y != b.y ? a.y < b.y : a.z < b.z);
}
surface_vertex bark_middle(surface_vertex a, surface_vertex b) {
surface_vertex m;
vec3 n = a.normal + b.normal;
vec3 t = vec3(a.tangent.x + b.tangent.x, a.tangent.y + b.tangent.y, a.tangent.z + b.tangent.z);
t = unit_or(t, t);
bool plain = a.tangent.w == 0.0f || b.tangent.w == 0.0f;
m.position = (a.position + b.position) * 0.5f;
m.u = (a.u + b.u) * 0.5f;
m.normal = unit_or(n, n);
m.v = (a.v + b.v) * 0.5f;
m.tangent = vec4(t.x, t.y, t.z, plain ? 0.0f : (a.tangent.w + b.tangent.w) * 0.5f);
return m;
}
float bark_rise(float length, float h_a, float h_b, float h_m, float relief, float steepest) {
float most = steepest * length;
float rise = relief * (h_m - 0.5f * (h_a + h_b));
return rise > most ? most : (rise < -most ? -most : rise);
}
surface_vertex bark_raised(surface_vertex m, surface_vertex a, surface_vertex b, float rise,
float rounding) {
vec3 ab = b.position - a.position;
vec3 round_a = a.normal * dot3(ab, a.normal);
vec3 round_b = b.normal * dot3(ab, b.normal);
m.position = m.position - (round_a - round_b) * (0.125f * rounding) + m.normal * rise;
return m;
}
layout(std430, binding = 0) readonly buffer vertices_buffer { vec4 vertices[]; };
layout(std430, binding = 1) readonly buffer indices_buffer { uint indices[]; };
layout(std430, binding = 2) readonly buffer heights_buffer { float heights[]; };
uint corner_index(uint i, uint corner) {
return indexed != 0u ? base_vertex + indices[3u * i + corner] : 3u * i + corner;
}
surface_vertex surface_at(uint index) {
surface_vertex s;
vec4 first = vertices[3u * index];
vec4 second = vertices[3u * index + 1u];
s.position = first.xyz;
s.u = first.w;
s.normal = second.xyz;
s.v = second.w;
s.tangent = vertices[3u * index + 2u];
return s;
}
struct triangle {
surface_vertex a;
surface_vertex b;
surface_vertex c;
};
triangle triangle_at(uint i) {
triangle t;
t.a = surface_at(corner_index(i, 0u));
t.b = surface_at(corner_index(i, 1u));
t.c = surface_at(corner_index(i, 2u));
return t;
}
uint pattern_of(triangle t) {
return bark_pattern(t.a.position, t.b.position, t.c.position, threshold);
}
float height_at(float u, float v) {
bark_texels t = bark_texels_at(u * repeats_around, v * repeats_along, width, height);
return bark_between(t, heights[t.row0 + t.x0], heights[t.row0 + t.x1], heights[t.row1 + t.x0],
heights[t.row1 + t.x1]);
}
surface_vertex midpoint(surface_vertex p, surface_vertex q) {
surface_vertex a = p;
surface_vertex b = q;
if (!bark_in_order(p.position, q.position)) {
a = q;
b = p;
}
surface_vertex m = bark_middle(a, b);
if (m.tangent.w == 0.0) {
return m;
}
float rise = bark_rise(sqrt(bark_edge_square(a.position, b.position)), height_at(a.u, a.v),
height_at(b.u, b.v), height_at(m.u, m.v), relief, steepest);
return bark_raised(m, a, b, rise, rounding);
}
surface_vertex corner_of(triangle t, uint corner) {
surface_vertex s = t.a;
if (corner == 1u) {
s = t.b;
} else if (corner == 2u) {
s = t.c;
}
return s;
}
surface_vertex point_of(triangle t, uint code) {
if (code < 3u) {
return corner_of(t, code);
}
return midpoint(corner_of(t, code - 3u), corner_of(t, code == 5u ? 0u : code - 2u));
}
bool takes_other_diagonal(triangle t, uint pattern, uint child) {
if (!bark_has_two(pattern) || child == 0u) {
return false;
}
vec3 ends[4];
for (uint end = 0u; end < 4u; ++end) {
uint corner = (end & 1u) != 0u ? 2u : (end == 0u ? 1u : 0u);
ends[end] = point_of(t, bark_corner(pattern, end >= 2u, 1u, corner)).position;
}
return bark_edge_square(ends[2], ends[3]) < bark_edge_square(ends[0], ends[1]);
}
triangle child_of(triangle t, uint pattern, uint child) {
bool other = takes_other_diagonal(t, pattern, child);
triangle made = t;
for (uint corner = 0u; corner < 3u; ++corner) {
surface_vertex s = point_of(t, bark_corner(pattern, other, child, corner));
if (corner == 0u) {
made.a = s;
} else if (corner == 1u) {
made.b = s;
} else {
made.c = s;
}
}
return made;
}
bool descended;
triangle descend(triangle t, uint strip, uint steps) {
descended = true;
for (uint step = 0u; step < steps && descended; ++step) {
uint child = (strip >> (2u * (levels - 1u - step))) & 3u;
uint pattern = pattern_of(t);
descended = child < bark_triangles(pattern);
if (descended && pattern != 0u) {
t = child_of(t, pattern, child);
}
}
return t;
}
uint kernel_strips() { return 1u << (2u * levels); }
uint kernel_strip_triangles() { return 1u; }
uint kernel_triangles(uint i, uint strip) {
triangle t = descend(triangle_at(i), strip, levels - 1u);
return descended && (strip & 3u) < bark_triangles(pattern_of(t)) ? 1u : 0u;
}
void kernel_strip(uint i, uint strip, uint first, uint count) {
triangle t = descend(triangle_at(i), strip, levels);
for (uint j = first; j < first + count; ++j) {
surface_vertex s = corner_of(t, j);
vertex_out[0] = vec4(s.position, s.u);
vertex_out[1] = vec4(s.normal, s.v);
vertex_out[2] = s.tangent;
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
)glsl", 12850};
};

} // namespace skybark::opengl
