// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 9f1c4927dfdbf17c391d78bd244f3fc6925f152b7c4c2c178761f384e31dedbe
#pragma once

#include <skybark/kernels/wind_load.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::wind_load> {
    static constexpr std::string_view map_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 64) in;
#define KERNEL_PARAMETERS float half_density; float vogel; float reference;
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
struct wind_waves {
vec4 kx;
vec4 ky;
vec4 kz;
vec4 ax;
vec4 ay;
vec4 az;
};
struct wind_sums {
vec4 x;
vec4 y;
vec4 z;
};
struct wind_segment {
vec4 axis;
vec4 leaves;
};
vec4 wave_cosine(vec4 p) {
vec4 r = p - floor(p + 0.5f);
vec4 s = r * r;
vec4 h = r * (3.1415926400772f + s * (-5.16771007666832f + s * (2.55007738652892f +
s * (-0.598290411283619f + s * 0.0776559122767420f))));
return 1.0f - 2.0f * (h * h);
}
wind_sums wind_add(wind_sums sum, wind_waves w, vec4 phase, vec4 place) {
vec4 c = wave_cosine(phase - (w.kx * place.x + w.ky * place.y + w.kz * place.z));
sum.x = sum.x + w.ax * c;
sum.y = sum.y + w.ay * c;
sum.z = sum.z + w.az * c;
return sum;
}
vec4 wind_velocity(float x, float y, float z) {
return vec4(x, y, z, sqrt(x * x + y * y + z * z));
}
vec4 wind_total(wind_sums sum, vec4 mean, float height_factor) {
float x = (sum.x.x + sum.x.y) + (sum.x.z + sum.x.w);
float y = (sum.y.x + sum.y.y) + (sum.y.z + sum.y.w);
float z = (sum.z.x + sum.z.y) + (sum.z.z + sum.z.w);
return wind_velocity(mean.x * height_factor + x, mean.y * height_factor + y,
mean.z * height_factor + z);
}
struct wind_cell {
uint low;
uint high;
float t;
};
wind_cell wind_cell_of(float x, float origin, float per_spacing, uint count) {
float last = float(count - 1u);
float g = min(max((x - origin) * per_spacing, 0.0f), last);
float low = floor(g);
wind_cell cell;
cell.low = uint(low);
cell.high = uint(min(low + 1.0f, last));
cell.t = g - low;
return cell;
}
vec4 wind_between(vec4 a, vec4 b, float t) { return a * (1.0f - t) + b * t; }
float power_above_one(float r, float v) {
float s = sqrt(sqrt(sqrt(r)));
float z = (s - 1.0f) / (s + 1.0f);
float y = z * z;
float l = 2.0f * z * (1.0f + y * (0.333333333f + y * (0.2f + y * (0.142857143f +
y * (0.111111111f + y * 0.0909090909f)))));
float e = l * v;
float x = 1.0f + e * (1.0f + e * (0.5f + e * (0.166666667f + e * (0.0416666667f +
e * (0.00833333333f + e * (0.00138888889f + e * 0.000198412698f))))));
float x2 = x * x;
float x4 = x2 * x2;
return x4 * x4;
}
segment_load wind_load_on(wind_segment segment, vec4 rotation, vec4 air, float half_density,
float vogel, float reference) {
vec3 u = vec3(air.x, air.y, air.z);
vec3 axis = quaternion_rotate(rotation, vec3(segment.axis.x, segment.axis.y, segment.axis.z));
vec3 across = u - axis * (axis.x * u.x + axis.y * u.y + axis.z * u.z);
float speed_across =
sqrt(across.x * across.x + across.y * across.y + across.z * across.z);
float wood_drag = half_density * segment.axis.w * speed_across;
bool yields = air.w > reference;
float folded = yields ? power_above_one(air.w / reference, vogel) : 1.0f;
float leaf_drag = half_density * segment.leaves.x * air.w * folded;
segment_load load;
load.force = across * wood_drag + u * leaf_drag;
load.drag = 2.0f * wood_drag + (yields ? 2.0f + vogel : 2.0f) * leaf_drag;
return load;
}
layout(std430, binding = 0) readonly buffer segments_buffer { wind_segment segments[]; };
layout(std430, binding = 1) readonly buffer poses_buffer { segment_pose poses[]; };
layout(std430, binding = 2) readonly buffer air_buffer { vec4 air[]; };
layout(std430, binding = 3) writeonly buffer loads_buffer { segment_load loads[]; };
void kernel_map(uint i) {
loads[i] = wind_load_on(segments[i], poses[i].rotation, air[i], half_density, vogel, reference);
}
layout(std430, binding = 10) readonly buffer skybark_length_buffer { uint skybark_length[]; };
uint skybark_elements() {
return (skybark_header.w & 1u) != 0u ? min(skybark_header.y, skybark_length[0])
: skybark_header.y;
}
void main() {
uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
gl_LocalInvocationID.x;
if (i < skybark_elements()) {
kernel_map(skybark_header.x + i);
}
}
)glsl", 9576};
    static constexpr std::string_view levels_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define readonly coherent readonly
#define writeonly coherent writeonly
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 256) in;
#define KERNEL_PARAMETERS float half_density; float vogel; float reference;
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
struct wind_waves {
vec4 kx;
vec4 ky;
vec4 kz;
vec4 ax;
vec4 ay;
vec4 az;
};
struct wind_sums {
vec4 x;
vec4 y;
vec4 z;
};
struct wind_segment {
vec4 axis;
vec4 leaves;
};
vec4 wave_cosine(vec4 p) {
vec4 r = p - floor(p + 0.5f);
vec4 s = r * r;
vec4 h = r * (3.1415926400772f + s * (-5.16771007666832f + s * (2.55007738652892f +
s * (-0.598290411283619f + s * 0.0776559122767420f))));
return 1.0f - 2.0f * (h * h);
}
wind_sums wind_add(wind_sums sum, wind_waves w, vec4 phase, vec4 place) {
vec4 c = wave_cosine(phase - (w.kx * place.x + w.ky * place.y + w.kz * place.z));
sum.x = sum.x + w.ax * c;
sum.y = sum.y + w.ay * c;
sum.z = sum.z + w.az * c;
return sum;
}
vec4 wind_velocity(float x, float y, float z) {
return vec4(x, y, z, sqrt(x * x + y * y + z * z));
}
vec4 wind_total(wind_sums sum, vec4 mean, float height_factor) {
float x = (sum.x.x + sum.x.y) + (sum.x.z + sum.x.w);
float y = (sum.y.x + sum.y.y) + (sum.y.z + sum.y.w);
float z = (sum.z.x + sum.z.y) + (sum.z.z + sum.z.w);
return wind_velocity(mean.x * height_factor + x, mean.y * height_factor + y,
mean.z * height_factor + z);
}
struct wind_cell {
uint low;
uint high;
float t;
};
wind_cell wind_cell_of(float x, float origin, float per_spacing, uint count) {
float last = float(count - 1u);
float g = min(max((x - origin) * per_spacing, 0.0f), last);
float low = floor(g);
wind_cell cell;
cell.low = uint(low);
cell.high = uint(min(low + 1.0f, last));
cell.t = g - low;
return cell;
}
vec4 wind_between(vec4 a, vec4 b, float t) { return a * (1.0f - t) + b * t; }
float power_above_one(float r, float v) {
float s = sqrt(sqrt(sqrt(r)));
float z = (s - 1.0f) / (s + 1.0f);
float y = z * z;
float l = 2.0f * z * (1.0f + y * (0.333333333f + y * (0.2f + y * (0.142857143f +
y * (0.111111111f + y * 0.0909090909f)))));
float e = l * v;
float x = 1.0f + e * (1.0f + e * (0.5f + e * (0.166666667f + e * (0.0416666667f +
e * (0.00833333333f + e * (0.00138888889f + e * 0.000198412698f))))));
float x2 = x * x;
float x4 = x2 * x2;
return x4 * x4;
}
segment_load wind_load_on(wind_segment segment, vec4 rotation, vec4 air, float half_density,
float vogel, float reference) {
vec3 u = vec3(air.x, air.y, air.z);
vec3 axis = quaternion_rotate(rotation, vec3(segment.axis.x, segment.axis.y, segment.axis.z));
vec3 across = u - axis * (axis.x * u.x + axis.y * u.y + axis.z * u.z);
float speed_across =
sqrt(across.x * across.x + across.y * across.y + across.z * across.z);
float wood_drag = half_density * segment.axis.w * speed_across;
bool yields = air.w > reference;
float folded = yields ? power_above_one(air.w / reference, vogel) : 1.0f;
float leaf_drag = half_density * segment.leaves.x * air.w * folded;
segment_load load;
load.force = across * wood_drag + u * leaf_drag;
load.drag = 2.0f * wood_drag + (yields ? 2.0f + vogel : 2.0f) * leaf_drag;
return load;
}
layout(std430, binding = 0) readonly buffer segments_buffer { wind_segment segments[]; };
layout(std430, binding = 1) readonly buffer poses_buffer { segment_pose poses[]; };
layout(std430, binding = 2) readonly buffer air_buffer { vec4 air[]; };
layout(std430, binding = 3) writeonly buffer loads_buffer { segment_load loads[]; };
void kernel_map(uint i) {
loads[i] = wind_load_on(segments[i], poses[i].rotation, air[i], half_density, vogel, reference);
}
layout(std430, binding = 11) readonly buffer skybark_ranges_buffer { uvec2 skybark_ranges[]; };
void main() {
for (uint r = 0u; r < skybark_header.y; ++r) {
uvec2 elements = skybark_ranges[skybark_header.x + r];
for (uint i = gl_LocalInvocationID.x; i < elements.y; i += 256u) {
kernel_map(elements.x + i);
}
memoryBarrierBuffer();
barrier();
}
}
)glsl", 9591};
};

} // namespace skybark::opengl
