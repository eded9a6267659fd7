// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 a903df77169607f5fc54a19b72a1ed0e48c3a907ea8eda9eb20f6351d7eeaee8
#pragma once

#include <skybark/kernels/branch_detail.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::branch_detail> {
    static constexpr std::string_view map_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 64) in;
#define KERNEL_PARAMETERS vec4 camera; float error; float thin; uint fewest_sides; uint sides;
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
vec3 hermite_point(vec3 p1, vec3 n1, vec3 p2, vec3 n2, float t) {
float s = 1.0f - t;
return (p1 * ((1.0f + 2.0f * t) * (s * s)) + n1 * (t * (s * s))) +
(p2 * ((t * t) * (1.0f + 2.0f * s)) - n2 * ((t * t) * s));
}
vec3 hermite_derivative(vec3 p1, vec3 n1, vec3 p2, vec3 n2, float t) {
float s = 1.0f - t;
return (p2 - p1) * (6.0f * t * s) + (n1 * (s * (1.0f - 3.0f * t)) + n2 * (t * (3.0f * t - 2.0f)));
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
struct branch_ring {
vec3 centre;
float radius;
vec3 x;
float path;
vec3 y;
float lean;
vec3 z;
vec3 tilt;
};
branch_ring branch_ring_leaning(branch_ring r, float slope) {
r.lean = 1.0f / sqrt(1.0f + slope * slope);
r.tilt = r.y * (slope * r.lean);
return r;
}
struct branch_curve {
vec3 p1;
vec3 n1;
vec3 p2;
vec3 n2;
slerp_arc arc;
};
branch_curve branch_curve_between(branch_end a, branch_end b) {
branch_curve c;
vec3 chord = b.position - a.position;
float l = sqrt(dot3(chord, chord));
c.p1 = a.position;
c.p2 = b.position;
c.n1 = quaternion_y(a.orientation) * l;
c.n2 = quaternion_y(b.orientation) * l;
c.arc = slerp_begin(a.orientation, b.orientation);
return c;
}
branch_ring branch_ring_slerp(branch_end a, branch_end b, branch_curve c, float t) {
branch_ring r;
vec4 q = slerp_at(c.arc, t);
float l2 = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
q = q * (1.0f / sqrt(l2));
r.centre = hermite_point(c.p1, c.n1, c.p2, c.n2, t);
r.radius = a.radius * (1.0f - t) + b.radius * t;
r.path = a.path * (1.0f - t) + b.path * t;
r.x = quaternion_x(q);
r.y = quaternion_y(q);
r.z = quaternion_z(q);
return branch_ring_leaning(r, a.slope * (1.0f - t) + b.slope * t);
}
vec3 branch_direction(branch_end a, branch_curve c, uint k, uint last) {
float t = float(k) / float(last);
return unit_or(hermite_derivative(c.p1, c.n1, c.p2, c.n2, t), quaternion_y(a.orientation));
}
branch_ring branch_ring_rotation_minimising(branch_end a, branch_end b, branch_curve c, uint k,
uint last) {
branch_ring r = branch_ring_slerp(a, b, c, float(k) / float(last));
if (k == 0u || k == last) {
return r;
}
vec3 chord = c.p2 - c.p1;
vec3 x = quaternion_x(a.orientation);
vec3 x_here = x;
vec3 p = vec3(0.0f, 0.0f, 0.0f);
vec3 d = branch_direction(a, c, 0u, last);
vec3 d_here = d;
for (uint i = 1u; i <= last; ++i) {
vec3 p_next = hermite_point(vec3(0.0f, 0.0f, 0.0f), c.n1, chord, c.n2, float(i) / float(last));
vec3 d_next = branch_direction(a, c, i, last);
x = double_reflection(p, d, x, p_next, d_next);
p = p_next;
d = d_next;
if (i == k) {
x_here = x;
d_here = d;
}
}
vec3 x_end = quaternion_x(b.orientation);
float twist = atan(dot3(cross3(x, x_end), d), dot3(x, x_end));
float angle = twist * float(k) / float(last);
vec3 side = cross3(d_here, x_here);
vec3 turned = x_here * cos(angle) + side * sin(angle);
r.y = d_here;
r.x = unit_or(turned - d_here * dot3(turned, d_here), r.x);
r.z = cross3(r.x, r.y);
return branch_ring_leaning(r, a.slope * (1.0f - float(k) / float(last)) +
b.slope * (float(k) / float(last)));
}
surface_vertex branch_vertex(branch_ring r, vec4 corner) {
surface_vertex vertex;
vec3 outward = r.x * corner.x - r.z * corner.y;
vec3 along = r.x * corner.y + r.z * corner.x;
vertex.position = r.centre + outward * r.radius;
vertex.u = corner.z;
vertex.normal = outward * r.lean - r.tilt;
vertex.v = r.path;
vertex.tangent = vec4(-along.x, -along.y, -along.z, 1.0f);
return vertex;
}
branch_ring branch_ring_at_end(branch_end e) {
branch_ring r;
float l2 = e.orientation.x * e.orientation.x + e.orientation.y * e.orientation.y +
e.orientation.z * e.orientation.z + e.orientation.w * e.orientation.w;
vec4 q = e.orientation * (1.0f / sqrt(l2));
r.centre = e.position;
r.radius = e.radius;
r.path = e.path;
r.x = quaternion_x(q);
r.y = quaternion_y(q);
r.z = quaternion_z(q);
return branch_ring_leaning(r, 0.0f);
}
uint branch_cap_corner(uint i, uint sides, bool base) {
uint corner = i == 0u ? 0u : ((i & 1u) == 1u ? (i + 1u) / 2u : sides - i / 2u);
return base && corner != 0u ? sides - corner : corner;
}
surface_vertex branch_cap_vertex(branch_ring r, vec4 corner, bool base) {
surface_vertex vertex = branch_vertex(r, corner);
vertex.normal = base ? r.y * -1.0f : r.y;
vertex.u = 0.5f + 0.5f * corner.x;
vertex.v = r.path + r.radius * corner.y;
vertex.tangent = vec4(r.x.x, r.x.y, r.x.z, base ? -1.0f : 1.0f);
return vertex;
}
struct end_detail {
float sides;
float scale;
float distance;
float errors;
};
struct segment_detail {
uint sides;
uint gaps;
float fraction;
uint caps;
};
struct chain_share {
float rank;
float least;
uint chain;
uint place;
};
struct chain_detail {
uint last;
uint caps;
uint stride;
float fraction;
};
float versine(uint n) {
float s = sin_quarter(1.57079633f / float(n));
return 2.0f * (s * s);
}
float detailed_sides(float errors, uint least, uint most) {
uint n = least;
while (n < most) {
float off = errors * versine(n);
if (off <= 1.0f) {
return float(n);
}
if (off < 2.0f) {
return float(n) * off;
}
n = n * 2u;
}
return float(most);
}
uint corner_count(float sides, uint least, uint most) {
uint n = least;
while (n < most && float(n) < sides) {
n = n * 2u;
}
return n;
}
float new_corner_distance(float sides, uint count) {
float risen = sides / float(count / 2u) - 1.0f;
return 1.0f - (1.0f - risen) * versine(count / 2u);
}
float width_kept(float sides, uint least, uint most) {
if (!(sides < float(most))) {
return 1.0f;
}
uint count = corner_count(sides, least, most);
float side = 2.0f * sin_quarter(3.14159265f / float(count));
if (count > least) {
float d = new_corner_distance(sides, count);
side = sqrt((1.0f - d) * (1.0f - d) + 2.0f * d * versine(count / 2u));
}
return float(most) * (2.0f * sin_quarter(3.14159265f / float(most))) / (float(count) * side);
}
float kept_scale(float cut, float rank) {
if (!(cut < 1.5f)) {
return 1.0f;
}
float top = cut * 1.33333333f;
float over = max(top - 1.0f, 0.0f);
float kept = cut - over * over / top;
return clamp(2.0f - 2.0f * rank / top, 0.0f, 1.0f) / kept;
}
end_detail detail_of_end(branch_end e, chain_share share, vec4 camera, float error, float thin,
uint least, uint most) {
end_detail d;
vec3 away = e.position - vec3(camera.x, camera.y, camera.z);
d.distance = sqrt(dot3(away, away));
float pixels = e.radius * camera.w / max(d.distance, 1e-6f);
d.scale = 1.0f;
if (thin > 0.0f) {
d.scale = kept_scale(max(pixels / thin, share.least), share.rank);
}
d.errors = error > 0.0f ? pixels * d.scale / error : 1e30f;
d.sides = detailed_sides(d.errors, least, most);
d.scale = d.scale * width_kept(d.sides, least, most);
return d;
}
float segment_bend(branch_end a, branch_end b) {
vec3 chord = b.position - a.position;
float l = sqrt(dot3(chord, chord));
vec3 e1 = quaternion_y(a.orientation) * l - chord;
vec3 e2 = quaternion_y(b.orientation) * l - chord;
vec3 at_start = e1 * 2.0f + e2;
vec3 at_end = e2 * 2.0f + e1;
float curve = 0.25f * sqrt(max(dot3(at_start, at_start), dot3(at_end, at_end)));
float cosine = a.orientation.x * b.orientation.x + a.orientation.y * b.orientation.y +
a.orientation.z * b.orientation.z + a.orientation.w * b.orientation.w;
vec4 d = b.orientation * (cosine < 0.0f ? -1.0f : 1.0f) - a.orientation;
float d2 = d.x * d.x + d.y * d.y + d.z * d.z + d.w * d.w;
float radius = max(a.radius, b.radius);
return curve + 0.6169f * radius * d2 + 0.5554f * abs(a.radius - b.radius) * sqrt(d2);
}
uint least_factor(uint n) {
uint p = 2u;
while (p * p <= n) {
if (n % p == 0u) {
return p;
}
p = p + 1u;
}
return n;
}
branch_end end_between(branch_end a, branch_end b, branch_end own) {
float l = b.path - a.path;
float t = l > 0.0f ? clamp((own.path - a.path) / l, 0.0f, 1.0f) : 0.5f;
branch_curve c = branch_curve_between(a, b);
branch_end e = own;
e.position = hermite_point(c.p1, c.n1, c.p2, c.n2, t);
e.radius = a.radius * (1.0f - t) + b.radius * t;
e.orientation = slerp(a.orientation, b.orientation, t);
e.slope = a.slope * (1.0f - t) + b.slope * t;
return e;
}
float way_between(branch_end a, branch_end b, branch_end own) {
branch_end e = end_between(a, b, own);
vec3 way = e.position - own.position;
return sqrt(dot3(way, way)) + abs(e.radius - own.radius) +
own.radius * abs(e.slope - own.slope);
}
branch_end end_on_its_way(branch_end a, branch_end b, branch_end own, float fraction) {
branch_end e = end_between(a, b, own);
e.position = e.position * (1.0f - fraction) + own.position * fraction;
e.radius = e.radius * (1.0f - fraction) + own.radius * fraction;
e.orientation = slerp(e.orientation, own.orientation, fraction);
e.slope = e.slope * (1.0f - fraction) + own.slope * fraction;
return e;
}
branch_segment merged_segment(branch_segment s, chain_detail chain) {
branch_segment m = s;
m.end = min(s.start + chain.stride, chain.last);
m.caps = (s.caps & 1u) | (m.end == chain.last ? chain.caps & 2u : 0u);
return m;
}
bool is_merged_away(chain_share start, chain_detail chain) {
return start.place % chain.stride != 0u;
}
segment_detail detail_of_segment(branch_segment s, branch_end a, branch_end b, end_detail da,
end_detail db, float pixels_per_radian, float error, uint least,
uint most, uint gaps) {
segment_detail d;
d.sides = corner_count(max(da.sides, db.sides), least, most);
d.gaps = gaps;
d.fraction = 1.0f;
d.caps = s.caps;
bool whole = da.scale == 1.0f && db.scale == 1.0f;
if (!whole && a.radius == 0.0f && b.radius == 0.0f) {
d.sides = 0u;
d.caps = 0u;
}
if (!(error > 0.0f)) {
return d;
}
if ((d.caps & 1u) != 0u && da.errors <= 1.0f) {
d.caps = d.caps - 1u;
}
if ((d.caps & 2u) != 0u && db.errors <= 1.0f) {
d.caps = d.caps - 2u;
}
vec3 chord = b.position - a.position;
float half_length = 0.5f * sqrt(dot3(chord, chord));
float nearest = max(min(da.distance, db.distance) - half_length, 1e-6f);
float bend = segment_bend(a, b) * pixels_per_radian / (nearest * error);
while (d.gaps > 1u) {
uint coarse = d.gaps / least_factor(d.gaps);
float off = bend / (float(coarse) * float(coarse));
if (!(off < 2.0f)) {
return d;
}
if (off > 1.0f) {
d.fraction = off - 1.0f;
return d;
}
d.gaps = coarse;
}
return d;
}
struct ring_outline {
uint step;
uint between;
float inner;
};
ring_outline outline_of(float sides, uint least, uint most) {
ring_outline o;
uint count = corner_count(sides, least, most);
o.step = most / count;
o.between = count > least ? 1u : 0u;
o.inner = count > least ? new_corner_distance(sides, count) : 1.0f;
return o;
}
uint outline_before(ring_outline o, uint j) { return j / o.step * o.step; }
uint outline_after(ring_outline o, uint j) { return (j + o.step - 1u) / o.step * o.step; }
float outline_distance(ring_outline o, uint j) {
return o.between == 1u && (j / o.step) % 2u == 1u ? o.inner : 1.0f;
}
vec2 point_of_outline(ring_outline o, uint j, vec4 before, vec4 after) {
uint first = outline_before(o, j);
uint last = outline_after(o, j);
float d = outline_distance(o, first);
vec2 p = vec2(before.x * d, before.y * d);
if (last != first) {
float w = float(j - first) / float(o.step);
float e = outline_distance(o, last);
p = p * (1.0f - w) + vec2(after.x * e, after.y * e) * w;
}
return p;
}
float outline_weight(branch_ring r, branch_end b, float t) {
return r.radius > 0.0f ? t * b.radius / r.radius : t;
}
vec2 mix_outlines(vec2 a, vec2 b, float weight) {
return a.x == b.x && a.y == b.y ? a : a * (1.0f - weight) + b * weight;
}
surface_vertex outline_vertex(branch_ring r, vec2 p, vec4 corner) {
surface_vertex vertex = branch_vertex(r, corner);
vec3 outward = r.x * p.x - r.z * p.y;
vertex.position = r.centre + outward * r.radius;
return vertex;
}
surface_vertex outline_cap_vertex(branch_ring r, vec2 p, bool base) {
return branch_cap_vertex(r, vec4(p.x, p.y, 0.0f, 0.0f), base);
}
surface_vertex between_vertices(surface_vertex own, surface_vertex before, surface_vertex after,
float w, float fraction) {
surface_vertex v = own;
vec3 place = before.position * (1.0f - w) + after.position * w;
vec3 facing = before.normal * (1.0f - w) + after.normal * w;
v.position = place * (1.0f - fraction) + own.position * fraction;
v.normal = unit_or(facing * (1.0f - fraction) + own.normal * fraction, own.normal);
return v;
}
layout(std430, binding = 0) readonly buffer ends_buffer { branch_end ends[]; };
layout(std430, binding = 1) readonly buffer shares_buffer { uvec4 shares[]; };
layout(std430, binding = 2) writeonly buffer details_buffer { vec4 details[]; };
void kernel_map(uint i) {
uvec4 s = shares[i];
chain_share share = chain_share(uintBitsToFloat(s.x), uintBitsToFloat(s.y), s.z, s.w);
end_detail d = detail_of_end(ends[i], share, camera, error, thin, fewest_sides, sides);
details[i] = vec4(d.sides, d.scale, d.distance, d.errors);
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
)glsl", 18497};
    static constexpr std::string_view levels_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define readonly coherent readonly
#define writeonly coherent writeonly
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 256) in;
#define KERNEL_PARAMETERS vec4 camera; float error; float thin; uint fewest_sides; uint sides;
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
vec3 hermite_point(vec3 p1, vec3 n1, vec3 p2, vec3 n2, float t) {
float s = 1.0f - t;
return (p1 * ((1.0f + 2.0f * t) * (s * s)) + n1 * (t * (s * s))) +
(p2 * ((t * t) * (1.0f + 2.0f * s)) - n2 * ((t * t) * s));
}
vec3 hermite_derivative(vec3 p1, vec3 n1, vec3 p2, vec3 n2, float t) {
float s = 1.0f - t;
return (p2 - p1) * (6.0f * t * s) + (n1 * (s * (1.0f - 3.0f * t)) + n2 * (t * (3.0f * t - 2.0f)));
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
struct branch_ring {
vec3 centre;
float radius;
vec3 x;
float path;
vec3 y;
float lean;
vec3 z;
vec3 tilt;
};
branch_ring branch_ring_leaning(branch_ring r, float slope) {
r.lean = 1.0f / sqrt(1.0f + slope * slope);
r.tilt = r.y * (slope * r.lean);
return r;
}
struct branch_curve {
vec3 p1;
vec3 n1;
vec3 p2;
vec3 n2;
slerp_arc arc;
};
branch_curve branch_curve_between(branch_end a, branch_end b) {
branch_curve c;
vec3 chord = b.position - a.position;
float l = sqrt(dot3(chord, chord));
c.p1 = a.position;
c.p2 = b.position;
c.n1 = quaternion_y(a.orientation) * l;
c.n2 = quaternion_y(b.orientation) * l;
c.arc = slerp_begin(a.orientation, b.orientation);
return c;
}
branch_ring branch_ring_slerp(branch_end a, branch_end b, branch_curve c, float t) {
branch_ring r;
vec4 q = slerp_at(c.arc, t);
float l2 = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
q = q * (1.0f / sqrt(l2));
r.centre = hermite_point(c.p1, c.n1, c.p2, c.n2, t);
r.radius = a.radius * (1.0f - t) + b.radius * t;
r.path = a.path * (1.0f - t) + b.path * t;
r.x = quaternion_x(q);
r.y = quaternion_y(q);
r.z = quaternion_z(q);
return branch_ring_leaning(r, a.slope * (1.0f - t) + b.slope * t);
}
vec3 branch_direction(branch_end a, branch_curve c, uint k, uint last) {
float t = float(k) / float(last);
return unit_or(hermite_derivative(c.p1, c.n1, c.p2, c.n2, t), quaternion_y(a.orientation));
}
branch_ring branch_ring_rotation_minimising(branch_end a, branch_end b, branch_curve c, uint k,
uint last) {
branch_ring r = branch_ring_slerp(a, b, c, float(k) / float(last));
if (k == 0u || k == last) {
return r;
}
vec3 chord = c.p2 - c.p1;
vec3 x = quaternion_x(a.orientation);
vec3 x_here = x;
vec3 p = vec3(0.0f, 0.0f, 0.0f);
vec3 d = branch_direction(a, c, 0u, last);
vec3 d_here = d;
for (uint i = 1u; i <= last; ++i) {
vec3 p_next = hermite_point(vec3(0.0f, 0.0f, 0.0f), c.n1, chord, c.n2, float(i) / float(last));
vec3 d_next = branch_direction(a, c, i, last);
x = double_reflection(p, d, x, p_next, d_next);
p = p_next;
d = d_next;
if (i == k) {
x_here = x;
d_here = d;
}
}
vec3 x_end = quaternion_x(b.orientation);
float twist = atan(dot3(cross3(x, x_end), d), dot3(x, x_end));
float angle = twist * float(k) / float(last);
vec3 side = cross3(d_here, x_here);
vec3 turned = x_here * cos(angle) + side * sin(angle);
r.y = d_here;
r.x = unit_or(turned - d_here * dot3(turned, d_here), r.x);
r.z = cross3(r.x, r.y);
return branch_ring_leaning(r, a.slope * (1.0f - float(k) / float(last)) +
b.slope * (float(k) / float(last)));
}
surface_vertex branch_vertex(branch_ring r, vec4 corner) {
surface_vertex vertex;
vec3 outward = r.x * corner.x - r.z * corner.y;
vec3 along = r.x * corner.y + r.z * corner.x;
vertex.position = r.centre + outward * r.radius;
vertex.u = corner.z;
vertex.normal = outward * r.lean - r.tilt;
vertex.v = r.path;
vertex.tangent = vec4(-along.x, -along.y, -along.z, 1.0f);
return vertex;
}
branch_ring branch_ring_at_end(branch_end e) {
branch_ring r;
float l2 = e.orientation.x * e.orientation.x + e.orientation.y * e.orientation.y +
e.orientation.z * e.orientation.z + e.orientation.w * e.orientation.w;
vec4 q = e.orientation * (1.0f / sqrt(l2));
r.centre = e.position;
r.radius = e.radius;
r.path = e.path;
r.x = quaternion_x(q);
r.y = quaternion_y(q);
r.z = quaternion_z(q);
return branch_ring_leaning(r, 0.0f);
}
uint branch_cap_corner(uint i, uint sides, bool base) {
uint corner = i == 0u ? 0u : ((i & 1u) == 1u ? (i + 1u) / 2u : sides - i / 2u);
return base && corner != 0u ? sides - corner : corner;
}
surface_vertex branch_cap_vertex(branch_ring r, vec4 corner, bool base) {
surface_vertex vertex = branch_vertex(r, corner);
vertex.normal = base ? r.y * -1.0f : r.y;
vertex.u = 0.5f + 0.5f * corner.x;
vertex.v = r.path + r.radius * corner.y;
vertex.tangent = vec4(r.x.x, r.x.y, r.x.z, base ? -1.0f : 1.0f);
return vertex;
}
struct end_detail {
float sides;
float scale;
float distance;
float errors;
};
struct segment_detail {
uint sides;
uint gaps;
float fraction;
uint caps;
};
struct chain_share {
float rank;
float least;
uint chain;
uint place;
};
struct chain_detail {
uint last;
uint caps;
uint stride;
float fraction;
};
float versine(uint n) {
float s = sin_quarter(1.57079633f / float(n));
return 2.0f * (s * s);
}
float detailed_sides(float errors, uint least, uint most) {
uint n = least;
while (n < most) {
float off = errors * versine(n);
if (off <= 1.0f) {
return float(n);
}
if (off < 2.0f) {
return float(n) * off;
}
n = n * 2u;
}
return float(most);
}
uint corner_count(float sides, uint least, uint most) {
uint n = least;
while (n < most && float(n) < sides) {
n = n * 2u;
}
return n;
}
float new_corner_distance(float sides, uint count) {
float risen = sides / float(count / 2u) - 1.0f;
return 1.0f - (1.0f - risen) * versine(count / 2u);
}
float width_kept(float sides, uint least, uint most) {
if (!(sides < float(most))) {
return 1.0f;
}
uint count = corner_count(sides, least, most);
float side = 2.0f * sin_quarter(3.14159265f / float(count));
if (count > least) {
float d = new_corner_distance(sides, count);
side = sqrt((1.0f - d) * (1.0f - d) + 2.0f * d * versine(count / 2u));
}
return float(most) * (2.0f * sin_quarter(3.14159265f / float(most))) / (float(count) * side);
}
float kept_scale(float cut, float rank) {
if (!(cut < 1.5f)) {
return 1.0f;
}
float top = cut * 1.33333333f;
float over = max(top - 1.0f, 0.0f);
float kept = cut - over * over / top;
return clamp(2.0f - 2.0f * rank / top, 0.0f, 1.0f) / kept;
}
end_detail detail_of_end(branch_end e, chain_share share, vec4 camera, float error, float thin,
uint least, uint most) {
end_detail d;
vec3 away = e.position - vec3(camera.x, camera.y, camera.z);
d.distance = sqrt(dot3(away, away));
float pixels = e.radius * camera.w / max(d.distance, 1e-6f);
d.scale = 1.0f;
if (thin > 0.0f) {
d.scale = kept_scale(max(pixels / thin, share.least), share.rank);
}
d.errors = error > 0.0f ? pixels * d.scale / error : 1e30f;
d.sides = detailed_sides(d.errors, least, most);
d.scale = d.scale * width_kept(d.sides, least, most);
return d;
}
float segment_bend(branch_end a, branch_end b) {
vec3 chord = b.position - a.position;
float l = sqrt(dot3(chord, chord));
vec3 e1 = quaternion_y(a.orientation) * l - chord;
vec3 e2 = quaternion_y(b.orientation) * l - chord;
vec3 at_start = e1 * 2.0f + e2;
vec3 at_end = e2 * 2.0f + e1;
float curve = 0.25f * sqrt(max(dot3(at_start, at_start), dot3(at_end, at_end)));
float cosine = a.orientation.x * b.orientation.x + a.orientation.y * b.orientation.y +
a.orientation.z * b.orientation.z + a.orientation.w * b.orientation.w;
vec4 d = b.orientation * (cosine < 0.0f ? -1.0f : 1.0f) - a.orientation;
float d2 = d.x * d.x + d.y * d.y + d.z * d.z + d.w * d.w;
float radius = max(a.radius, b.radius);
return curve + 0.6169f * radius * d2 + 0.5554f * abs(a.radius - b.radius) * sqrt(d2);
}
uint least_factor(uint n) {
uint p = 2u;
while (p * p <= n) {
if (n % p == 0u) {
return p;
}
p = p + 1u;
}
return n;
}
branch_end end_between(branch_end a, branch_end b, branch_end own) {
float l = b.path - a.path;
float t = l > 0.0f ? clamp((own.path - a.path) / l, 0.0f, 1.0f) : 0.5f;
branch_curve c = branch_curve_between(a, b);
branch_end e = own;
e.position = hermite_point(c.p1, c.n1, c.p2, c.n2, t);
e.radius = a.radius * (1.0f - t) + b.radius * t;
e.orientation = slerp(a.orientation, b.orientation, t);
e.slope = a.slope * (1.0f - t) + b.slope * t;
return e;
}
float way_between(branch_end a, branch_end b, branch_end own) {
branch_end e = end_between(a, b, own);
vec3 way = e.position - own.position;
return sqrt(dot3(way, way)) + abs(e.radius - own.radius) +
own.radius * abs(e.slope - own.slope);
}
branch_end end_on_its_way(branch_end a, branch_end b, branch_end own, float fraction) {
branch_end e = end_between(a, b, own);
e.position = e.position * (1.0f - fraction) + own.position * fraction;
e.radius = e.radius * (1.0f - fraction) + own.radius * fraction;
e.orientation = slerp(e.orientation, own.orientation, fraction);
e.slope = e.slope * (1.0f - fraction) + own.slope * fraction;
return e;
}
branch_segment merged_segment(branch_segment s, chain_detail chain) {
branch_segment m = s;
m.end = min(s.start + chain.stride, chain.last);
m.caps = (s.caps & 1u) | (m.end == chain.last ? chain.caps & 2u : 0u);
return m;
}
bool is_merged_away(chain_share start, chain_detail chain) {
return start.place % chain.stride != 0u;
}
segment_detail detail_of_segment(branch_segment s, branch_end a, branch_end b, end_detail da,
end_detail db, float pixels_per_radian, float error, uint least,
uint most, uint gaps) {
segment_detail d;
d.sides = corner_count(max(da.sides, db.sides), least, most);
d.gaps = gaps;
d.fraction = 1.0f;
d.caps = s.caps;
bool whole = da.scale == 1.0f && db.scale == 1.0f;
if (!whole && a.radius == 0.0f && b.radius == 0.0f) {
d.sides = 0u;
d.caps = 0u;
}
if (!(error > 0.0f)) {
return d;
}
if ((d.caps & 1u) != 0u && da.errors <= 1.0f) {
d.caps = d.caps - 1u;
}
if ((d.caps & 2u) != 0u && db.errors <= 1.0f) {
d.caps = d.caps - 2u;
}
vec3 chord = b.position - a.position;
float half_length = 0.5f * sqrt(dot3(chord, chord));
float nearest = max(min(da.distance, db.distance) - half_length, 1e-6f);
float bend = segment_bend(a, b) * pixels_per_radian / (nearest * error);
while (d.gaps > 1u) {
uint coarse = d.gaps / least_factor(d.gaps);
float off = bend / (float(coarse) * float(coarse));
if (!(off < 2.0f)) {
return d;
}
if (off > 1.0f) {
d.fraction = off - 1.0f;
return d;
}
d.gaps = coarse;
}
return d;
}
struct ring_outline {
uint step;
uint between;
float inner;
};
ring_outline outline_of(float sides, uint least, uint most) {
ring_outline o;
uint count = corner_count(sides, least, most);
o.step = most / count;
o.between = count > least ? 1u : 0u;
o.inner = count > least ? new_corner_distance(sides, count) : 1.0f;
return o;
}
uint outline_before(ring_outline o, uint j) { return j / o.step * o.step; }
uint outline_after(ring_outline o, uint j) { return (j + o.step - 1u) / o.step * o.step; }
float outline_distance(ring_outline o, uint j) {
return o.between == 1u && (j / o.step) % 2u == 1u ? o.inner : 1.0f;
}
vec2 point_of_outline(ring_outline o, uint j, vec4 before, vec4 after) {
uint first = outline_before(o, j);
uint last = outline_after(o, j);
float d = outline_distance(o, first);
vec2 p = vec2(before.x * d, before.y * d);
if (last != first) {
float w = float(j - first) / float(o.step);
float e = outline_distance(o, last);
p = p * (1.0f - w) + vec2(after.x * e, after.y * e) * w;
}
return p;
}
float outline_weight(branch_ring r, branch_end b, float t) {
return r.radius > 0.0f ? t * b.radius / r.radius : t;
}
vec2 mix_outlines(vec2 a, vec2 b, float weight) {
return a.x == b.x && a.y == b.y ? a : a * (1.0f - weight) + b * weight;
}
surface_vertex outline_vertex(branch_ring r, vec2 p, vec4 corner) {
surface_vertex vertex = branch_vertex(r, corner);
vec3 outward = r.x * p.x - r.z * p.y;
vertex.position = r.centre + outward * r.radius;
return vertex;
}
surface_vertex outline_cap_vertex(branch_ring r, vec2 p, bool base) {
return branch_cap_vertex(r, vec4(p.x, p.y, 0.0f, 0.0f), base);
}
surface_vertex between_vertices(surface_vertex own, surface_vertex before, surface_vertex after,
float w, float fraction) {
surface_vertex v = own;
vec3 place = before.position * (1.0f - w) + after.position * w;
vec3 facing = before.normal * (1.0f - w) + after.normal * w;
v.position = place * (1.0f - fraction) + own.position * fraction;
v.normal = unit_or(facing * (1.0f - fraction) + own.normal * fraction, own.normal);
return v;
}
layout(std430, binding = 0) readonly buffer ends_buffer { branch_end ends[]; };
layout(std430, binding = 1) readonly buffer shares_buffer { uvec4 shares[]; };
layout(std430, binding = 2) writeonly buffer details_buffer { vec4 details[]; };
void kernel_map(uint i) {
uvec4 s = shares[i];
chain_share share = chain_share(uintBitsToFloat(s.x), uintBitsToFloat(s.y), s.z, s.w);
end_detail d = detail_of_end(ends[i], share, camera, error, thin, fewest_sides, sides);
details[i] = vec4(d.sides, d.scale, d.distance, d.errors);
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
)glsl", 18512};
};

} // namespace skybark::opengl
