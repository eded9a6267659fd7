// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 02019ce154e4963caf2f911997a39d7f45ab817077f07b2c5d2278486f56fa04
#pragma once

#include <skybark/kernels/leaf_blade.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::leaf_blade> {
    static constexpr std::string_view expand_vert{R"glsl(#version 450
#define SKYBARK_OPENGL
layout(location = 0) flat out uint skybark_point;
void main() { skybark_point = uint(gl_VertexID); }
)glsl", 137};
    static constexpr std::string_view strips_geom{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_EXPAND
#define KERNEL_PARAMETERS vec4 camera; uint time; float flutter; float flutter_speed; float lean; \
float lean_speed; float full; float quad; uint pose_step; uint air_step;
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
vec3 quaternion_x(vec4 q) {
return vec3(1.0f - 2.0f * (q.y * q.y + q.z * q.z), 2.0f * (q.x * q.y + q.w * q.z),
2.0f * (q.x * q.z - q.w * q.y));
}
vec3 quaternion_y(vec4 q) {
return vec3(2.0f * (q.x * q.y - q.w * q.z), 1.0f - 2.0f * (q.x * q.x + q.z * q.z),
2.0f * (q.y * q.z + q.w * q.x));
}
vec3 quaternion_z(vec4 q) {
return vec3(2.0f * (q.x * q.z + q.w * q.y), 2.0f * (q.y * q.z - q.w * q.x),
1.0f - 2.0f * (q.x * q.x + q.y * q.y));
}
float arctan_unit(float x) {
float s = x * x;
return x * (1.0f + s * (-0.3333314528f + s * (0.1999355085f + s * (-0.1420889944f +
s * (0.1065626393f + s * (-0.0752896400f + s * (0.0429096138f +
s * (-0.0161657367f + s * 0.0028662257f))))))));
}
float sin_quarter(float x) {
float s = x * x;
return x * (1.0f + s * (-0.1666666664f + s * (0.0083333315f + s * (-0.0001984090f +
s * (0.0000027526f + s * -0.0000000239f)))));
}
struct slerp_arc {
vec4 a;
vec4 b;
float angle;
float inverse_sin;
};
slerp_arc slerp_begin(vec4 a, vec4 b) {
slerp_arc arc;
float cosine = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
float side = cosine < 0.0f ? -1.0f : 1.0f;
arc.a = a;
arc.b = b * side;
vec4 d = a - arc.b;
vec4 s = a + arc.b;
float d2 = d.x * d.x + d.y * d.y + d.z * d.z + d.w * d.w;
float s2 = s.x * s.x + s.y * s.y + s.z * s.z + s.w * s.w;
arc.angle = s2 > 0.0f ? 2.0f * arctan_unit(sqrt(d2 / s2)) : 0.0f;
arc.inverse_sin = arc.angle > 0.001f ? 1.0f / sin_quarter(arc.angle) : 0.0f;
return arc;
}
vec4 slerp_at(slerp_arc arc, float t) {
float wa = 1.0f - t;
float wb = t;
if (arc.inverse_sin > 0.0f) {
wa = t < 1.0f ? sin_quarter(wa * arc.angle) * arc.inverse_sin : 0.0f;
wb = t > 0.0f ? sin_quarter(wb * arc.angle) * arc.inverse_sin : 0.0f;
wa = t > 0.0f ? wa : 1.0f;
wb = t < 1.0f ? wb : 1.0f;
}
return arc.a * wa + arc.b * wb;
}
vec4 slerp(vec4 a, vec4 b, float t) {
vec4 q = slerp_at(slerp_begin(a, b), t);
return q * (1.0f / sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w));
}
vec4 quaternion_times(vec4 a, vec4 b) {
return vec4(a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z);
}
vec3 quaternion_move(vec4 q, vec3 v) {
vec3 t = vec3(2.0f * (q.y * v.z - q.z * v.y), 2.0f * (q.z * v.x - q.x * v.z),
2.0f * (q.x * v.y - q.y * v.x));
return vec3(q.w * t.x + (q.y * t.z - q.z * t.y), q.w * t.y + (q.z * t.x - q.x * t.z),
q.w * t.z + (q.x * t.y - q.y * t.x));
}
vec3 quaternion_rotate(vec4 q, vec3 v) { return v + quaternion_move(q, v); }
vec3 posed_point(segment_pose p, vec3 x) {
return x + (p.shift + quaternion_move(p.rotation, x - p.base));
}
branch_end posed_end(branch_end rest, segment_pose moved, vec4 turned, vec4 other) {
branch_end now = rest;
now.position = posed_point(moved, rest.position);
vec4 turn = slerp(turned, other, 0.5f);
now.orientation = quaternion_times(turn, rest.orientation);
return now;
}
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
uint leaf_bits(uint seed, uint salt) {
uint h = seed + (salt + 1u) * 0x9e3779b9u;
h = (h ^ (h >> 16u)) * 0x7feb352du;
h = (h ^ (h >> 15u)) * 0x846ca68bu;
return h ^ (h >> 16u);
}
float leaf_rank(uint seed) { return float(leaf_bits(seed, 0u) >> 8u) * (1.0f / 16777216.0f); }
float sine_of_phase(uint phase) {
uint within = phase & 0x7fffffffu;
uint quarter = within > 0x40000000u ? 0x80000000u - within : within;
float s = sin_quarter(float(quarter >> 7u) * 1.8725352e-7f);
return phase >= 0x80000000u ? -s : s;
}
float leaf_oscillation(uint seed, uint salt, uint time) {
uint bits = leaf_bits(seed, salt);
return sine_of_phase(time * (128u + (bits & 127u)) + bits);
}
struct leaf_at_rest {
vec3 position;
float width;
vec4 orientation;
float along;
uint carrier;
uint seed;
float fold;
};
struct leaf_response {
uint time;
float flutter;
float flutter_speed;
float lean;
float lean_speed;
};
vec4 leaf_lean(leaf_response r, vec3 d, vec4 air) {
float k = r.lean * air.w / (air.w * air.w + r.lean_speed * r.lean_speed);
float x = k * (d.y * air.z - d.z * air.y);
float y = k * (d.z * air.x - d.x * air.z);
float z = k * (d.x * air.y - d.y * air.x);
float f = 1.0f / sqrt(1.0f + (x * x + y * y + z * z));
return vec4(x * f, y * f, z * f, f);
}
vec4 leaf_flutter(leaf_response r, uint seed, float speed) {
float k = r.flutter * (speed * speed / (speed * speed + r.flutter_speed * r.flutter_speed));
float y = k * (0.7f * leaf_oscillation(seed, 1u, r.time) +
0.3f * leaf_oscillation(seed, 2u, r.time));
float x = k * (0.5f * leaf_oscillation(seed, 3u, r.time));
float f = 1.0f / sqrt(1.0f + (x * x + y * y));
return vec4(x * f, y * f, 0.0f, f);
}
struct leaf_detail {
float scale;
float morph;
};
leaf_detail leaf_detail_of(float seen, float full, float quad, uint seed) {
leaf_detail d;
d.scale = 1.0f;
d.morph = clamp(2.0f - seen / quad, 0.0f, 1.0f);
float part = seen / full;
float nu = max(2.0f * (part * part), 0.00048828125f);
if (nu < 2.0f) {
float rest = 1.0f - 0.5f * nu;
float mean = nu <= 1.0f ? 0.75f * nu : 1.0f - rest * rest / nu;
float area = clamp(2.0f * (nu - leaf_rank(seed)) / nu, 0.0f, 1.0f);
d.scale = sqrt(area / mean);
}
return d;
}
struct leaf_frame {
vec3 base;
vec3 middle;
vec3 right;
vec3 left;
vec3 right_across;
vec3 left_across;
vec3 right_normal;
vec3 left_normal;
float axis;
float diagonal;
};
vec4 leaf_turn(leaf_at_rest l, segment_pose pose, vec4 air, leaf_response response) {
vec4 q = quaternion_times(pose.rotation, l.orientation);
vec4 leaning = leaf_lean(response, quaternion_y(q), air);
return quaternion_times(quaternion_times(leaning, q),
leaf_flutter(response, l.seed, air.w));
}
leaf_frame leaf_frame_of(leaf_at_rest l, vec3 base, vec4 turn, leaf_detail detail) {
leaf_frame f;
vec3 x = quaternion_x(turn);
vec3 y = quaternion_y(turn);
vec3 z = quaternion_z(turn);
float half_fold = 0.5f * clamp(l.fold, -1.5707964f, 1.5707964f);
float sine = half_fold < 0.0f ? -sin_quarter(-half_fold) : sin_quarter(half_fold);
float up = 2.0f * sine * sqrt(1.0f - sine * sine);
float level = 1.0f - 2.0f * (sine * sine);
float half_width = 0.5f * l.width * detail.scale;
float half_length = 0.5f * l.along * detail.scale;
f.base = base;
f.middle = y * half_length;
f.right_across = x * level + z * up;
f.left_across = x * level - z * up;
f.right_normal = z * level - x * up;
f.left_normal = z * level + x * up;
f.right = f.right_across * half_width;
f.left = f.left_across * -half_width;
f.axis = 1.0f + detail.morph * 0.18920712f;
f.diagonal = 0.70710678f / f.axis;
return f;
}
surface_vertex leaf_vertex(leaf_frame f, bool left, uint corner) {
surface_vertex s;
bool between = (corner & 1u) == 1u;
float across = between ? f.diagonal : (corner == 2u ? f.axis : 0.0f);
float along = corner == 2u ? 0.0f : (between ? f.diagonal : f.axis);
along = corner < 2u ? -along : along;
vec3 side = left ? f.left : f.right;
vec3 tangent = left ? f.left_across : f.right_across;
s.position = f.base + (side * across + f.middle * (1.0f + along));
s.u = left ? 0.5f - 0.5f * across : 0.5f + 0.5f * across;
s.normal = left ? f.left_normal : f.right_normal;
s.v = 0.5f + 0.5f * along;
s.tangent = vec4(tangent.x, tangent.y, tangent.z, 1.0f);
return s;
}
uint leaf_corner(uint j, bool left, bool quad) {
uint even = j == 0u ? 0u : (j == 2u ? 4u : 3u);
uint odd = j == 1u && !quad ? 1u : 2u;
uint corner = (j & 1u) == 1u ? odd : even;
return left ? 4u - corner : corner;
}
float leaf_linear(float c) { return c * (c * (c * 0.305306011f + 0.682171111f) + 0.012522878f); }
float leaf_lit(float reflected, float through, float sunlight, float facing, float ambient_here,
float ambient_behind) {
return reflected * (ambient_here + sunlight * max(facing, 0.0f)) +
through * (ambient_behind + sunlight * max(-facing, 0.0f));
}
layout(std430, binding = 0) readonly buffer leaves_buffer { uvec4 leaves[]; };
layout(std430, binding = 1) readonly buffer poses_buffer { segment_pose poses[]; };
layout(std430, binding = 2) readonly buffer air_buffer { vec4 air[]; };
void emit_surface(surface_vertex s) {
vertex_out[0] = vec4(s.position, s.u);
vertex_out[1] = vec4(s.normal, s.v);
vertex_out[2] = s.tangent;
emit_vertex();
}
leaf_at_rest leaf_of(uint i) {
uvec4 place = leaves[3u * i];
uvec4 turn = leaves[3u * i + 1u];
uvec4 more = leaves[3u * i + 2u];
return leaf_at_rest(uintBitsToFloat(place.xyz), uintBitsToFloat(place.w), uintBitsToFloat(turn),
uintBitsToFloat(more.x), more.y, more.z, uintBitsToFloat(more.w));
}
leaf_detail detail_at(leaf_at_rest l, vec3 base) {
leaf_detail all;
all.scale = 1.0;
all.morph = 0.0;
vec3 d = base - camera.xyz;
float seen = camera.w * sqrt(l.width * l.along) / max(sqrt(dot3(d, d)), 1e-6);
return camera.w > 0.0 ? leaf_detail_of(seen, full, quad, l.seed) : all;
}
leaf_frame frame_of(leaf_at_rest l) {
leaf_response response = leaf_response(time, flutter, flutter_speed, lean, lean_speed);
segment_pose pose = poses[l.carrier * pose_step];
vec3 base = posed_point(pose, l.position);
vec4 turn = leaf_turn(l, pose, air[l.carrier * air_step], response);
return leaf_frame_of(l, base, turn, detail_at(l, base));
}
uint kernel_ring_vertices() { return 10u; }
void kernel_ring(uint i, uint first, uint count) {
leaf_frame f = frame_of(leaf_of(i));
for (uint k = first; k < first + count; ++k) {
emit_surface(leaf_vertex(f, k >= 5u, k % 5u));
}
}
uint kernel_strips() { return 2u; }
uint kernel_strip_triangles() { return 3u; }
uint kernel_triangles(uint i, uint strip) {
leaf_at_rest l = leaf_of(i);
leaf_detail d = detail_at(l, posed_point(poses[l.carrier * pose_step], l.position));
return d.scale > 0.0 ? (d.morph < 1.0 ? 3u : 1u) : 0u;
}
void kernel_strip(uint i, uint strip, uint first, uint count) {
leaf_frame f = frame_of(leaf_of(i));
bool quadrilateral = kernel_triangles(i, strip) == 1u;
for (uint j = first; j < first + count; ++j) {
emit_surface(leaf_vertex(f, strip == 1u, leaf_corner(j, strip == 1u, quadrilateral)));
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
)glsl", 15289};
    static constexpr std::string_view rings_geom{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_EXPAND
#define KERNEL_PARAMETERS vec4 camera; uint time; float flutter; float flutter_speed; float lean; \
float lean_speed; float full; float quad; uint pose_step; uint air_step;
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
vec3 quaternion_x(vec4 q) {
return vec3(1.0f - 2.0f * (q.y * q.y + q.z * q.z), 2.0f * (q.x * q.y + q.w * q.z),
2.0f * (q.x * q.z - q.w * q.y));
}
vec3 quaternion_y(vec4 q) {
return vec3(2.0f * (q.x * q.y - q.w * q.z), 1.0f - 2.0f * (q.x * q.x + q.z * q.z),
2.0f * (q.y * q.z + q.w * q.x));
}
vec3 quaternion_z(vec4 q) {
return vec3(2.0f * (q.x * q.z + q.w * q.y), 2.0f * (q.y * q.z - q.w * q.x),
1.0f - 2.0f * (q.x * q.x + q.y * q.y));
}
float arctan_unit(float x) {
float s = x * x;
return x * (1.0f + s * (-0.3333314528f + s * (0.1999355085f + s * (-0.1420889944f +
s * (0.1065626393f + s * (-0.0752896400f + s * (0.0429096138f +
s * (-0.0161657367f + s * 0.0028662257f))))))));
}
float sin_quarter(float x) {
float s = x * x;
return x * (1.0f + s * (-0.1666666664f + s * (0.0083333315f + s * (-0.0001984090f +
s * (0.0000027526f + s * -0.0000000239f)))));
}
struct slerp_arc {
vec4 a;
vec4 b;
float angle;
float inverse_sin;
};
slerp_arc slerp_begin(vec4 a, vec4 b) {
slerp_arc arc;
float cosine = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
float side = cosine < 0.0f ? -1.0f : 1.0f;
arc.a = a;
arc.b = b * side;
vec4 d = a - arc.b;
vec4 s = a + arc.b;
float d2 = d.x * d.x + d.y * d.y + d.z * d.z + d.w * d.w;
float s2 = s.x * s.x + s.y * s.y + s.z * s.z + s.w * s.w;
arc.angle = s2 > 0.0f ? 2.0f * arctan_unit(sqrt(d2 / s2)) : 0.0f;
arc.inverse_sin = arc.angle > 0.001f ? 1.0f / sin_quarter(arc.angle) : 0.0f;
return arc;
}
vec4 slerp_at(slerp_arc arc, float t) {
float wa = 1.0f - t;
float wb = t;
if (arc.inverse_sin > 0.0f) {
wa = t < 1.0f ? sin_quarter(wa * arc.angle) * arc.inverse_sin : 0.0f;
wb = t > 0.0f ? sin_quarter(wb * arc.angle) * arc.inverse_sin : 0.0f;
wa = t > 0.0f ? wa : 1.0f;
wb = t < 1.0f ? wb : 1.0f;
}
return arc.a * wa + arc.b * wb;
}
vec4 slerp(vec4 a, vec4 b, float t) {
vec4 q = slerp_at(slerp_begin(a, b), t);
return q * (1.0f / sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w));
}
vec4 quaternion_times(vec4 a, vec4 b) {
return vec4(a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z);
}
vec3 quaternion_move(vec4 q, vec3 v) {
vec3 t = vec3(2.0f * (q.y * v.z - q.z * v.y), 2.0f * (q.z * v.x - q.x * v.z),
2.0f * (q.x * v.y - q.y * v.x));
return vec3(q.w * t.x + (q.y * t.z - q.z * t.y), q.w * t.y + (q.z * t.x - q.x * t.z),
q.w * t.z + (q.x * t.y - q.y * t.x));
}
vec3 quaternion_rotate(vec4 q, vec3 v) { return v + quaternion_move(q, v); }
vec3 posed_point(segment_pose p, vec3 x) {
return x + (p.shift + quaternion_move(p.rotation, x - p.base));
}
branch_end posed_end(branch_end rest, segment_pose moved, vec4 turned, vec4 other) {
branch_end now = rest;
now.position = posed_point(moved, rest.position);
vec4 turn = slerp(turned, other, 0.5f);
now.orientation = quaternion_times(turn, rest.orientation);
return now;
}
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
uint leaf_bits(uint seed, uint salt) {
uint h = seed + (salt + 1u) * 0x9e3779b9u;
h = (h ^ (h >> 16u)) * 0x7feb352du;
h = (h ^ (h >> 15u)) * 0x846ca68bu;
return h ^ (h >> 16u);
}
float leaf_rank(uint seed) { return float(leaf_bits(seed, 0u) >> 8u) * (1.0f / 16777216.0f); }
float sine_of_phase(uint phase) {
uint within = phase & 0x7fffffffu;
uint quarter = within > 0x40000000u ? 0x80000000u - within : within;
float s = sin_quarter(float(quarter >> 7u) * 1.8725352e-7f);
return phase >= 0x80000000u ? -s : s;
}
float leaf_oscillation(uint seed, uint salt, uint time) {
uint bits = leaf_bits(seed, salt);
return sine_of_phase(time * (128u + (bits & 127u)) + bits);
}
struct leaf_at_rest {
vec3 position;
float width;
vec4 orientation;
float along;
uint carrier;
uint seed;
float fold;
};
struct leaf_response {
uint time;
float flutter;
float flutter_speed;
float lean;
float lean_speed;
};
vec4 leaf_lean(leaf_response r, vec3 d, vec4 air) {
float k = r.lean * air.w / (air.w * air.w + r.lean_speed * r.lean_speed);
float x = k * (d.y * air.z - d.z * air.y);
float y = k * (d.z * air.x - d.x * air.z);
float z = k * (d.x * air.y - d.y * air.x);
float f = 1.0f / sqrt(1.0f + (x * x + y * y + z * z));
return vec4(x * f, y * f, z * f, f);
}
vec4 leaf_flutter(leaf_response r, uint seed, float speed) {
float k = r.flutter * (speed * speed / (speed * speed + r.flutter_speed * r.flutter_speed));
float y = k * (0.7f * leaf_oscillation(seed, 1u, r.time) +
0.3f * leaf_oscillation(seed, 2u, r.time));
float x = k * (0.5f * leaf_oscillation(seed, 3u, r.time));
float f = 1.0f / sqrt(1.0f + (x * x + y * y));
return vec4(x * f, y * f, 0.0f, f);
}
struct leaf_detail {
float scale;
float morph;
};
leaf_detail leaf_detail_of(float seen, float full, float quad, uint seed) {
leaf_detail d;
d.scale = 1.0f;
d.morph = clamp(2.0f - seen / quad, 0.0f, 1.0f);
float part = seen / full;
float nu = max(2.0f * (part * part), 0.00048828125f);
if (nu < 2.0f) {
float rest = 1.0f - 0.5f * nu;
float mean = nu <= 1.0f ? 0.75f * nu : 1.0f - rest * rest / nu;
float area = clamp(2.0f * (nu - leaf_rank(seed)) / nu, 0.0f, 1.0f);
d.scale = sqrt(area / mean);
}
return d;
}
struct leaf_frame {
vec3 base;
vec3 middle;
vec3 right;
vec3 left;
vec3 right_across;
vec3 left_across;
vec3 right_normal;
vec3 left_normal;
float axis;
float diagonal;
};
vec4 leaf_turn(leaf_at_rest l, segment_pose pose, vec4 air, leaf_response response) {
vec4 q = quaternion_times(pose.rotation, l.orientation);
vec4 leaning = leaf_lean(response, quaternion_y(q), air);
return quaternion_times(quaternion_times(leaning, q),
leaf_flutter(response, l.seed, air.w));
}
leaf_frame leaf_frame_of(leaf_at_rest l, vec3 base, vec4 turn, leaf_detail detail) {
leaf_frame f;
vec3 x = quaternion_x(turn);
vec3 y = quaternion_y(turn);
vec3 z = quaternion_z(turn);
float half_fold = 0.5f * clamp(l.fold, -1.5707964f, 1.5707964f);
float sine = half_fold < 0.0f ? -sin_quarter(-half_fold) : sin_quarter(half_fold);
float up = 2.0f * sine * sqrt(1.0f - sine * sine);
float level = 1.0f - 2.0f * (sine * sine);
float half_width = 0.5f * l.width * detail.scale;
float half_length = 0.5f * l.along * detail.scale;
f.base = base;
f.middle = y * half_length;
f.right_across = x * level + z * up;
f.left_across = x * level - z * up;
f.right_normal = z * level - x * up;
f.left_normal = z * level + x * up;
f.right = f.right_across * half_width;
f.left = f.left_across * -half_width;
f.axis = 1.0f + detail.morph * 0.18920712f;
f.diagonal = 0.70710678f / f.axis;
return f;
}
surface_vertex leaf_vertex(leaf_frame f, bool left, uint corner) {
surface_vertex s;
bool between = (corner & 1u) == 1u;
float across = between ? f.diagonal : (corner == 2u ? f.axis : 0.0f);
float along = corner == 2u ? 0.0f : (between ? f.diagonal : f.axis);
along = corner < 2u ? -along : along;
vec3 side = left ? f.left : f.right;
vec3 tangent = left ? f.left_across : f.right_across;
s.position = f.base + (side * across + f.middle * (1.0f + along));
s.u = left ? 0.5f - 0.5f * across : 0.5f + 0.5f * across;
s.normal = left ? f.left_normal : f.right_normal;
s.v = 0.5f + 0.5f * along;
s.tangent = vec4(tangent.x, tangent.y, tangent.z, 1.0f);
return s;
}
uint leaf_corner(uint j, bool left, bool quad) {
uint even = j == 0u ? 0u : (j == 2u ? 4u : 3u);
uint odd = j == 1u && !quad ? 1u : 2u;
uint corner = (j & 1u) == 1u ? odd : even;
return left ? 4u - corner : corner;
}
float leaf_linear(float c) { return c * (c * (c * 0.305306011f + 0.682171111f) + 0.012522878f); }
float leaf_lit(float reflected, float through, float sunlight, float facing, float ambient_here,
float ambient_behind) {
return reflected * (ambient_here + sunlight * max(facing, 0.0f)) +
through * (ambient_behind + sunlight * max(-facing, 0.0f));
}
layout(std430, binding = 0) readonly buffer leaves_buffer { uvec4 leaves[]; };
layout(std430, binding = 1) readonly buffer poses_buffer { segment_pose poses[]; };
layout(std430, binding = 2) readonly buffer air_buffer { vec4 air[]; };
void emit_surface(surface_vertex s) {
vertex_out[0] = vec4(s.position, s.u);
vertex_out[1] = vec4(s.normal, s.v);
vertex_out[2] = s.tangent;
emit_vertex();
}
leaf_at_rest leaf_of(uint i) {
uvec4 place = leaves[3u * i];
uvec4 turn = leaves[3u * i + 1u];
uvec4 more = leaves[3u * i + 2u];
return leaf_at_rest(uintBitsToFloat(place.xyz), uintBitsToFloat(place.w), uintBitsToFloat(turn),
uintBitsToFloat(more.x), more.y, more.z, uintBitsToFloat(more.w));
}
leaf_detail detail_at(leaf_at_rest l, vec3 base) {
leaf_detail all;
all.scale = 1.0;
all.morph = 0.0;
vec3 d = base - camera.xyz;
float seen = camera.w * sqrt(l.width * l.along) / max(sqrt(dot3(d, d)), 1e-6);
return camera.w > 0.0 ? leaf_detail_of(seen, full, quad, l.seed) : all;
}
leaf_frame frame_of(leaf_at_rest l) {
leaf_response response = leaf_response(time, flutter, flutter_speed, lean, lean_speed);
segment_pose pose = poses[l.carrier * pose_step];
vec3 base = posed_point(pose, l.position);
vec4 turn = leaf_turn(l, pose, air[l.carrier * air_step], response);
return leaf_frame_of(l, base, turn, detail_at(l, base));
}
uint kernel_ring_vertices() { return 10u; }
void kernel_ring(uint i, uint first, uint count) {
leaf_frame f = frame_of(leaf_of(i));
for (uint k = first; k < first + count; ++k) {
emit_surface(leaf_vertex(f, k >= 5u, k % 5u));
}
}
uint kernel_strips() { return 2u; }
uint kernel_strip_triangles() { return 3u; }
uint kernel_triangles(uint i, uint strip) {
leaf_at_rest l = leaf_of(i);
leaf_detail d = detail_at(l, posed_point(poses[l.carrier * pose_step], l.position));
return d.scale > 0.0 ? (d.morph < 1.0 ? 3u : 1u) : 0u;
}
void kernel_strip(uint i, uint strip, uint first, uint count) {
leaf_frame f = frame_of(leaf_of(i));
bool quadrilateral = kernel_triangles(i, strip) == 1u;
for (uint j = first; j < first + count; ++j) {
emit_surface(leaf_vertex(f, strip == 1u, leaf_corner(j, strip == 1u, quadrilateral)));
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
)glsl", 14337};
};

} // namespace skybark::opengl
