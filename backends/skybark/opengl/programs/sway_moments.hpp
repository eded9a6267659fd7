// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 50698722d47bd8ce2506ca02d452445a27a9156094214cdab2d46668d4d78a4e
#pragma once

#include <skybark/kernels/sway_moments.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::sway_moments> {
    static constexpr std::string_view map_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 64) in;
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
struct sway_joint {
vec3 axis;
float extent;
vec3 offset;
float stiffness;
vec3 base;
float relaxation;
float mass;
float lever;
float across;
float along;
uint parent;
uint first_child;
uint child_count;
uint root;
};
struct sway_state {
vec4 rotation;
vec3 bend;
float before;
vec3 rate;
float after;
vec3 turn;
float budget;
vec3 speed;
float reserved0;
vec3 shift;
float reserved1;
vec3 step_turn;
float reserved2;
vec3 step_speed;
float reserved3;
};
struct sway_energy {
float before;
float after;
float elastic;
float work;
float scale;
float budget;
float reserved0;
float reserved1;
};
struct sway_carry {
vec4 b0;
vec4 b1;
vec4 b2;
vec4 p;
vec4 a;
vec4 ac;
vec4 c;
};
struct sway_gain {
vec4 b0;
vec4 b1;
vec4 b2;
vec4 e;
vec4 er;
vec4 r;
};
struct sway_rule {
float weight;
float hold;
float spring;
};
struct sway_sym {
float xx;
float xy;
float xz;
float yy;
float yz;
float zz;
};
float sway_dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
vec3 sway_cross(vec3 a, vec3 b) {
return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
vec3 sway_times(sway_sym m, vec3 v) {
return vec3(m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
m.xz * v.x + m.yz * v.y + m.zz * v.z);
}
sway_sym sway_inverse(sway_sym m, float least) {
float d0 = 1.0f / max(m.xx, least);
float l1 = m.xy * d0;
float l2 = m.xz * d0;
float d1 = 1.0f / max(m.yy - l1 * m.xy, least);
float t = m.yz - l1 * m.xz;
float l3 = t * d1;
float d2 = 1.0f / max(m.zz - l2 * m.xz - l3 * t, least);
float k2 = l1 * l3 - l2;
sway_sym y;
y.zz = d2;
y.yz = -l3 * d2;
y.xz = k2 * d2;
y.yy = d1 + l3 * l3 * d2;
y.xy = -l1 * d1 - l3 * y.xz;
y.xx = d0 + l1 * l1 * d1 + k2 * y.xz;
return y;
}
sway_sym sway_product(sway_sym a, sway_sym b) {
sway_sym m;
m.xx = a.xx * b.xx + a.xy * b.xy + a.xz * b.xz;
m.xy = a.xx * b.xy + a.xy * b.yy + a.xz * b.yz;
m.xz = a.xx * b.xz + a.xy * b.yz + a.xz * b.zz;
m.yy = a.xy * b.xy + a.yy * b.yy + a.yz * b.yz;
m.yz = a.xy * b.xz + a.yy * b.yz + a.yz * b.zz;
m.zz = a.xz * b.xz + a.yz * b.yz + a.zz * b.zz;
return m;
}
float sway_sinc(float s) {
return 1.0f + s * (-0.1666666664f +
s * (0.0083333315f +
s * (-0.0001984090f + s * (0.0000027526f + s * -0.0000000239f))));
}
vec4 sway_rotation(vec3 bend) {
float square = sway_dot(bend, bend);
float angle = sqrt(square);
float turns = floor(angle * 0.15915494f + 0.5f);
float left = min(max(angle - 6.2831853f * turns, -3.1415927f), 3.1415927f);
float kept = (left + max(1.0f - angle, 0.0f)) / max(angle, 1.0f);
square = left * left;
float s = sway_sinc(0.25f * square);
float c = sway_sinc(0.0625f * square);
float by = 0.5f * s * kept;
return vec4(by * bend.x, by * bend.y, by * bend.z, 1.0f - 0.125f * square * (c * c));
}
vec4 sway_rotated(vec4 parent, vec3 bend) {
vec4 q = quaternion_times(parent, sway_rotation(bend));
float n = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
return q * (1.5f - 0.5f * n);
}
vec3 sway_back(vec4 q, vec3 v) { return quaternion_rotate(vec4(-q.x, -q.y, -q.z, q.w), v); }
sway_rule sway_rule_of(sway_joint joint, float seconds) {
float share = min(joint.relaxation / seconds, 1.0f);
float rest = joint.relaxation - 0.5f * share * seconds;
sway_rule rule;
rule.weight = 0.5f + 0.5f * share;
rule.spring = rule.weight * seconds * joint.stiffness;
rule.hold = rule.spring * (0.5f * seconds + rest);
return rule;
}
float sway_kinetic(sway_joint joint, vec3 axis, vec3 turn, vec3 speed) {
float spin = sway_dot(axis, turn);
return 0.5f * (joint.across * sway_dot(turn, turn) +
(joint.along - joint.across) * (spin * spin) +
joint.mass * sway_dot(speed, speed)) +
joint.lever * sway_dot(sway_cross(turn, axis), speed);
}
sway_carry sway_body(sway_joint joint, sway_state state, segment_load load, sway_rule rule,
float scale, float seconds) {
vec3 axis = quaternion_rotate(state.rotation, joint.axis);
vec3 turn = state.turn * scale;
vec3 speed = state.speed * scale;
vec3 middle = axis * (0.5f * joint.extent);
float share = rule.weight * seconds;
float drag = share * load.drag;
vec3 push = load.force * share;
vec3 lever = axis * joint.lever;
vec3 momentum = speed * joint.mass + sway_cross(turn, lever);
vec3 spin = turn * joint.across +
axis * ((joint.along - joint.across) * sway_dot(axis, turn)) +
sway_cross(lever, speed) + sway_cross(middle, push);
float reach = drag * (0.25f * joint.extent * joint.extent);
float across = joint.across + reach;
float excess = joint.along - across;
vec3 g = lever + middle * drag;
float mass = joint.mass + drag;
vec3 e = axis * excess;
sway_carry c;
c.b0 = vec4(0.0f, -g.z, g.y, spin.x);
c.b1 = vec4(g.z, 0.0f, -g.x, spin.y);
c.b2 = vec4(-g.y, g.x, 0.0f, spin.z);
c.p = vec4(momentum + push, 0.0f);
c.a = vec4(across + e.x * axis.x, e.x * axis.y, e.x * axis.z, across + e.y * axis.y);
c.ac = vec4(e.y * axis.z, across + e.z * axis.z, mass, 0.0f);
c.c = vec4(0.0f, mass, 0.0f, mass);
return c;
}
sway_carry sway_sum(sway_carry a, sway_carry b) {
a.b0 = a.b0 + b.b0;
a.b1 = a.b1 + b.b1;
a.b2 = a.b2 + b.b2;
a.p = a.p + b.p;
a.a = a.a + b.a;
a.ac = a.ac + b.ac;
a.c = a.c + b.c;
return a;
}
struct sway_parted {
sway_carry carry;
sway_gain gain;
};
sway_parted sway_part(sway_joint joint, sway_carry sum, sway_rule rule, vec4 rotation, vec3 bend,
vec4 parent_rotation) {
vec3 r = quaternion_rotate(parent_rotation, joint.offset);
vec3 b0 = vec3(sum.b0.x, sum.b0.y, sum.b0.z);
vec3 b1 = vec3(sum.b1.x, sum.b1.y, sum.b1.z);
vec3 b2 = vec3(sum.b2.x, sum.b2.y, sum.b2.z);
vec3 spin = vec3(sum.b0.w, sum.b1.w, sum.b2.w);
vec3 momentum = vec3(sum.p.x, sum.p.y, sum.p.z);
sway_sym a;
a.xx = sum.a.x;
a.xy = sum.a.y;
a.xz = sum.a.z;
a.yy = sum.a.w;
a.yz = sum.ac.x;
a.zz = sum.ac.y;
sway_sym d = a;
d.xx = a.xx + rule.hold;
d.yy = a.yy + rule.hold;
d.zz = a.zz + rule.hold;
sway_sym y = sway_inverse(d, rule.hold + 4e-6f * (a.xx + a.yy + a.zz));
sway_sym give = sway_product(y, a);
vec3 torque = spin - quaternion_rotate(rotation, bend) * rule.spring;
vec3 free = sway_times(y, torque);
vec3 y0 = b0 * y.xx + b1 * y.xy + b2 * y.xz;
vec3 y1 = b0 * y.xy + b1 * y.yy + b2 * y.yz;
vec3 y2 = b0 * y.xz + b1 * y.yz + b2 * y.zz;
vec3 spin_left = spin - sway_times(give, torque);
vec3 left = momentum - (b0 * free.x + b1 * free.y + b2 * free.z);
vec3 c0 = vec3(sum.ac.z, sum.ac.w, sum.c.x) - (y0 * b0.x + y1 * b1.x + y2 * b2.x);
float least = 4e-6f * (sum.ac.z + sum.c.y + sum.c.w);
float cxx = max(c0.x, least);
float cyy = max(sum.c.y - (b0.y * y0.y + b1.y * y1.y + b2.y * y2.y), least);
float cyz = sum.c.z - (b0.y * y0.z + b1.y * y1.z + b2.y * y2.z);
float czz = max(sum.c.w - (b0.z * y0.z + b1.z * y1.z + b2.z * y2.z), least);
c0.x = cxx;
vec3 c1 = vec3(c0.y, cyy, cyz);
vec3 c2 = vec3(c0.z, cyz, czz);
vec3 h0 = y0 * rule.hold;
vec3 h1 = y1 * rule.hold;
vec3 h2 = y2 * rule.hold;
vec3 n0 = h0 + (c2 * r.y - c1 * r.z);
vec3 n1 = h1 + (c0 * r.z - c2 * r.x);
vec3 n2 = h2 + (c1 * r.x - c0 * r.y);
vec3 s0 = sway_cross(r, h0);
vec3 s1 = sway_cross(r, h1);
vec3 s2 = sway_cross(r, h2);
vec3 t0 = sway_cross(r, n0);
vec3 t1 = sway_cross(r, n1);
vec3 t2 = sway_cross(r, n2);
spin_left = spin_left + sway_cross(r, left);
sway_parted parted;
parted.carry.b0 = vec4(n0, spin_left.x);
parted.carry.b1 = vec4(n1, spin_left.y);
parted.carry.b2 = vec4(n2, spin_left.z);
parted.carry.p = vec4(left, 0.0f);
parted.carry.a = vec4(rule.hold * give.xx + (s0.x + t0.x), rule.hold * give.xy + (s1.x + t0.y),
rule.hold * give.xz + (s2.x + t0.z), rule.hold * give.yy + (s1.y + t1.y));
parted.carry.ac = vec4(rule.hold * give.yz + (s2.y + t1.z),
rule.hold * give.zz + (s2.z + t2.z), c0.x, c0.y);
parted.carry.c = vec4(c0.z, cyy, cyz, czz);
parted.gain.b0 = vec4(y0, free.x);
parted.gain.b1 = vec4(y1, free.y);
parted.gain.b2 = vec4(y2, free.z);
parted.gain.e = vec4(give.xx, give.xy, give.xz, give.yy);
parted.gain.er = vec4(give.yz, give.zz, 0.0f, 0.0f);
parted.gain.r = vec4(r, 0.0f);
return parted;
}
sway_state sway_placed(sway_joint joint, sway_state parent, sway_state now) {
vec3 moved = quaternion_move(parent.rotation, joint.offset);
now.rotation = sway_rotated(parent.rotation, now.bend);
now.shift = parent.shift + moved;
now.turn = parent.turn + quaternion_rotate(parent.rotation, now.rate);
now.speed = parent.speed + sway_cross(parent.turn, joint.offset + moved);
return now;
}
sway_state sway_stepped(sway_joint joint, sway_gain gain, sway_state was, vec4 parent_was,
sway_state parent, sway_rule rule, sway_energy tree, float seconds) {
sway_sym give;
give.xx = gain.e.x;
give.xy = gain.e.y;
give.xz = gain.e.z;
give.yy = gain.e.w;
give.yz = gain.er.x;
give.zz = gain.er.y;
vec3 r = vec3(gain.r.x, gain.r.y, gain.r.z);
vec3 speed = parent.step_speed + sway_cross(parent.step_turn, r);
vec3 given = sway_times(give, parent.step_turn);
vec3 rate = vec3(
gain.b0.w - given.x - (gain.b0.x * speed.x + gain.b0.y * speed.y + gain.b0.z * speed.z),
gain.b1.w - given.y - (gain.b1.x * speed.x + gain.b1.y * speed.y + gain.b1.z * speed.z),
gain.b2.w - given.z - (gain.b2.x * speed.x + gain.b2.y * speed.y + gain.b2.z * speed.z));
vec3 turn = parent.step_turn + rate;
float ahead = 1.0f / rule.weight;
vec3 mean = sway_back(parent_was, rate);
vec3 old_rate = was.rate * tree.scale;
vec3 old_turn = was.turn * tree.scale;
vec3 old_speed = was.speed * tree.scale;
sway_state now = was;
now.budget = tree.budget;
now.bend = was.bend + mean * seconds;
now.rate = old_rate + (mean - old_rate) * ahead;
now.step_turn = turn;
now.step_speed = speed;
vec3 axis_was = quaternion_rotate(was.rotation, joint.axis);
now.before = sway_kinetic(joint, axis_was, old_turn + (turn - old_turn) * ahead,
old_speed + (speed - old_speed) * ahead);
now = sway_placed(joint, parent, now);
now.after = sway_kinetic(joint, quaternion_rotate(now.rotation, joint.axis), now.turn,
now.speed);
return now;
}
segment_pose sway_pose(sway_joint joint, sway_state state) {
segment_pose pose;
pose.rotation = state.rotation;
pose.base = joint.base;
pose.reserved0 = 0.0f;
pose.shift = state.shift;
pose.reserved1 = 0.0f;
return pose;
}
vec4 sway_velocity(sway_joint joint, vec4 was, sway_state now) {
vec3 middle = quaternion_rotate(was, joint.axis) * (0.5f * joint.extent);
return vec4(now.step_speed + sway_cross(now.step_turn, middle), 0.0f);
}
sway_energy sway_energy_of(sway_joint joint, sway_state state, segment_load load, vec4 velocity,
float seconds) {
sway_energy own;
own.before = state.before;
own.after = state.after;
own.elastic = 0.5f * joint.stiffness * sway_dot(state.bend, state.bend);
own.work = seconds * (load.force.x * velocity.x + load.force.y * velocity.y +
load.force.z * velocity.z);
own.scale = 1.0f;
own.budget = 0.0f;
own.reserved0 = 0.0f;
own.reserved1 = 0.0f;
return own;
}
sway_energy sway_energy_sum(sway_energy a, sway_energy b) {
a.before = a.before + b.before;
a.after = a.after + b.after;
a.elastic = a.elastic + b.elastic;
a.work = a.work + b.work;
return a;
}
struct sway_moment {
vec4 a;
vec4 ag;
vec4 force;
vec4 moment;
};
sway_moment sway_moment_sum(sway_moment a, sway_moment b) {
a.a = a.a + b.a;
a.ag = a.ag + b.ag;
a.force = a.force + b.force;
a.moment = a.moment + b.moment;
return a;
}
float sway_hold(vec3 force, vec3 r) {
float least = 0.5f * sqrt(sway_dot(force, force) * sway_dot(r, r));
return max(sway_dot(force, r), least);
}
sway_moment sway_pull(sway_joint joint, vec4 rotation, segment_load load) {
vec3 middle = quaternion_rotate(rotation, joint.axis) * (0.5f * joint.extent);
sway_moment m;
m.a = vec4(0.0f, 0.0f, 0.0f, 0.0f);
m.ag = vec4(0.0f, 0.0f, sway_hold(load.force, middle), 0.0f);
m.force = vec4(load.force, 0.0f);
m.moment = vec4(sway_cross(middle, load.force), 0.0f);
return m;
}
struct sway_balanced {
sway_moment carry;
sway_gain gain;
};
sway_balanced sway_balance(sway_joint joint, sway_moment sum, vec4 rotation, vec3 bend,
vec4 parent_rotation) {
vec3 r = quaternion_rotate(parent_rotation, joint.offset);
vec3 moment = vec3(sum.moment.x, sum.moment.y, sum.moment.z);
vec3 force = vec3(sum.force.x, sum.force.y, sum.force.z);
sway_sym a;
a.xx = sum.a.x + sum.ag.z;
a.xy = sum.a.y;
a.xz = sum.a.z;
a.yy = sum.a.w + sum.ag.z;
a.yz = sum.ag.x;
a.zz = sum.ag.y + sum.ag.z;
sway_sym d = a;
d.xx = a.xx + joint.stiffness;
d.yy = a.yy + joint.stiffness;
d.zz = a.zz + joint.stiffness;
sway_sym y = sway_inverse(d, joint.stiffness);
sway_sym give = sway_product(y, a);
vec3 torque = moment - quaternion_rotate(rotation, bend) * joint.stiffness;
vec3 free = sway_times(y, torque);
vec3 left = moment - sway_times(give, torque) + sway_cross(r, force);
float k = joint.stiffness;
sway_balanced b;
b.carry.a = vec4(k * give.xx, k * give.xy, k * give.xz, k * give.yy);
b.carry.ag = vec4(k * give.yz, k * give.zz, sway_hold(force, r), 0.0f);
b.carry.force = sum.force;
b.carry.moment = vec4(left, 0.0f);
b.gain.b0 = vec4(0.0f, 0.0f, 0.0f, free.x);
b.gain.b1 = vec4(0.0f, 0.0f, 0.0f, free.y);
b.gain.b2 = vec4(0.0f, 0.0f, 0.0f, free.z);
b.gain.e = vec4(give.xx, give.xy, give.xz, give.yy);
b.gain.er = vec4(give.yz, give.zz, 0.0f, 0.0f);
b.gain.r = vec4(r, 0.0f);
return b;
}
sway_gain sway_paper_gain(sway_joint joint, vec3 force, vec4 rotation, vec3 bend) {
vec3 axis = quaternion_rotate(rotation, joint.axis);
vec3 turn = sway_cross(axis, force) * (joint.extent / joint.stiffness);
vec3 free = turn - quaternion_rotate(rotation, bend);
sway_gain g;
g.b0 = vec4(0.0f, 0.0f, 0.0f, free.x);
g.b1 = vec4(0.0f, 0.0f, 0.0f, free.y);
g.b2 = vec4(0.0f, 0.0f, 0.0f, free.z);
g.e = vec4(0.0f, 0.0f, 0.0f, 0.0f);
g.er = vec4(0.0f, 0.0f, 0.0f, 0.0f);
g.r = vec4(0.0f, 0.0f, 0.0f, 0.0f);
return g;
}
sway_state sway_turned(sway_joint joint, sway_gain gain, sway_state was, vec4 parent_was,
sway_state parent) {
sway_sym give;
give.xx = gain.e.x;
give.xy = gain.e.y;
give.xz = gain.e.z;
give.yy = gain.e.w;
give.yz = gain.er.x;
give.zz = gain.er.y;
vec3 turn = vec3(gain.b0.w, gain.b1.w, gain.b2.w) - sway_times(give, parent.step_turn);
sway_state now = was;
now.bend = was.bend + sway_back(parent_was, turn);
now.step_turn = parent.step_turn + turn;
now.step_speed = vec3(0.0f, 0.0f, 0.0f);
now = sway_placed(joint, parent, now);
now.after = sway_kinetic(joint, quaternion_rotate(now.rotation, joint.axis), now.turn,
now.speed);
now.before = now.after;
now.budget = -1.0f;
return now;
}
layout(std430, binding = 0) readonly buffer joints_buffer { sway_joint joints[]; };
layout(std430, binding = 1) readonly buffer loads_buffer { segment_load loads[]; };
layout(std430, binding = 2) readonly buffer states_buffer { sway_state states[]; };
layout(std430, binding = 3) readonly buffer carried_buffer { sway_moment carried[]; };
layout(std430, binding = 4) writeonly buffer carry_buffer { sway_moment carry[]; };
layout(std430, binding = 5) writeonly buffer gains_buffer { sway_gain gains[]; };
void kernel_map(uint i) {
sway_joint joint = joints[i];
sway_state state = states[i];
sway_moment sum = sway_pull(joint, state.rotation, loads[i]);
for (uint c = joint.first_child; c < joint.first_child + joint.child_count; ++c) {
sum = sway_moment_sum(sum, carried[c]);
}
sway_balanced balanced = sway_balance(joint, sum, state.rotation, state.bend,
states[joint.parent].rotation);
carry[i] = balanced.carry;
gains[i] = balanced.gain;
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
)glsl", 21322};
    static constexpr std::string_view levels_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define readonly coherent readonly
#define writeonly coherent writeonly
#define SKYBARK_COMPUTE_STAGE
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
struct sway_joint {
vec3 axis;
float extent;
vec3 offset;
float stiffness;
vec3 base;
float relaxation;
float mass;
float lever;
float across;
float along;
uint parent;
uint first_child;
uint child_count;
uint root;
};
struct sway_state {
vec4 rotation;
vec3 bend;
float before;
vec3 rate;
float after;
vec3 turn;
float budget;
vec3 speed;
float reserved0;
vec3 shift;
float reserved1;
vec3 step_turn;
float reserved2;
vec3 step_speed;
float reserved3;
};
struct sway_energy {
float before;
float after;
float elastic;
float work;
float scale;
float budget;
float reserved0;
float reserved1;
};
struct sway_carry {
vec4 b0;
vec4 b1;
vec4 b2;
vec4 p;
vec4 a;
vec4 ac;
vec4 c;
};
struct sway_gain {
vec4 b0;
vec4 b1;
vec4 b2;
vec4 e;
vec4 er;
vec4 r;
};
struct sway_rule {
float weight;
float hold;
float spring;
};
struct sway_sym {
float xx;
float xy;
float xz;
float yy;
float yz;
float zz;
};
float sway_dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
vec3 sway_cross(vec3 a, vec3 b) {
return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
vec3 sway_times(sway_sym m, vec3 v) {
return vec3(m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
m.xz * v.x + m.yz * v.y + m.zz * v.z);
}
sway_sym sway_inverse(sway_sym m, float least) {
float d0 = 1.0f / max(m.xx, least);
float l1 = m.xy * d0;
float l2 = m.xz * d0;
float d1 = 1.0f / max(m.yy - l1 * m.xy, least);
float t = m.yz - l1 * m.xz;
float l3 = t * d1;
float d2 = 1.0f / max(m.zz - l2 * m.xz - l3 * t, least);
float k2 = l1 * l3 - l2;
sway_sym y;
y.zz = d2;
y.yz = -l3 * d2;
y.xz = k2 * d2;
y.yy = d1 + l3 * l3 * d2;
y.xy = -l1 * d1 - l3 * y.xz;
y.xx = d0 + l1 * l1 * d1 + k2 * y.xz;
return y;
}
sway_sym sway_product(sway_sym a, sway_sym b) {
sway_sym m;
m.xx = a.xx * b.xx + a.xy * b.xy + a.xz * b.xz;
m.xy = a.xx * b.xy + a.xy * b.yy + a.xz * b.yz;
m.xz = a.xx * b.xz + a.xy * b.yz + a.xz * b.zz;
m.yy = a.xy * b.xy + a.yy * b.yy + a.yz * b.yz;
m.yz = a.xy * b.xz + a.yy * b.yz + a.yz * b.zz;
m.zz = a.xz * b.xz + a.yz * b.yz + a.zz * b.zz;
return m;
}
float sway_sinc(float s) {
return 1.0f + s * (-0.1666666664f +
s * (0.0083333315f +
s * (-0.0001984090f + s * (0.0000027526f + s * -0.0000000239f))));
}
vec4 sway_rotation(vec3 bend) {
float square = sway_dot(bend, bend);
float angle = sqrt(square);
float turns = floor(angle * 0.15915494f + 0.5f);
float left = min(max(angle - 6.2831853f * turns, -3.1415927f), 3.1415927f);
float kept = (left + max(1.0f - angle, 0.0f)) / max(angle, 1.0f);
square = left * left;
float s = sway_sinc(0.25f * square);
float c = sway_sinc(0.0625f * square);
float by = 0.5f * s * kept;
return vec4(by * bend.x, by * bend.y, by * bend.z, 1.0f - 0.125f * square * (c * c));
}
vec4 sway_rotated(vec4 parent, vec3 bend) {
vec4 q = quaternion_times(parent, sway_rotation(bend));
float n = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
return q * (1.5f - 0.5f * n);
}
vec3 sway_back(vec4 q, vec3 v) { return quaternion_rotate(vec4(-q.x, -q.y, -q.z, q.w), v); }
sway_rule sway_rule_of(sway_joint joint, float seconds) {
float share = min(joint.relaxation / seconds, 1.0f);
float rest = joint.relaxation - 0.5f * share * seconds;
sway_rule rule;
rule.weight = 0.5f + 0.5f * share;
rule.spring = rule.weight * seconds * joint.stiffness;
rule.hold = rule.spring * (0.5f * seconds + rest);
return rule;
}
float sway_kinetic(sway_joint joint, vec3 axis, vec3 turn, vec3 speed) {
float spin = sway_dot(axis, turn);
return 0.5f * (joint.across * sway_dot(turn, turn) +
(joint.along - joint.across) * (spin * spin) +
joint.mass * sway_dot(speed, speed)) +
joint.lever * sway_dot(sway_cross(turn, axis), speed);
}
sway_carry sway_body(sway_joint joint, sway_state state, segment_load load, sway_rule rule,
float scale, float seconds) {
vec3 axis = quaternion_rotate(state.rotation, joint.axis);
vec3 turn = state.turn * scale;
vec3 speed = state.speed * scale;
vec3 middle = axis * (0.5f * joint.extent);
float share = rule.weight * seconds;
float drag = share * load.drag;
vec3 push = load.force * share;
vec3 lever = axis * joint.lever;
vec3 momentum = speed * joint.mass + sway_cross(turn, lever);
vec3 spin = turn * joint.across +
axis * ((joint.along - joint.across) * sway_dot(axis, turn)) +
sway_cross(lever, speed) + sway_cross(middle, push);
float reach = drag * (0.25f * joint.extent * joint.extent);
float across = joint.across + reach;
float excess = joint.along - across;
vec3 g = lever + middle * drag;
float mass = joint.mass + drag;
vec3 e = axis * excess;
sway_carry c;
c.b0 = vec4(0.0f, -g.z, g.y, spin.x);
c.b1 = vec4(g.z, 0.0f, -g.x, spin.y);
c.b2 = vec4(-g.y, g.x, 0.0f, spin.z);
c.p = vec4(momentum + push, 0.0f);
c.a = vec4(across + e.x * axis.x, e.x * axis.y, e.x * axis.z, across + e.y * axis.y);
c.ac = vec4(e.y * axis.z, across + e.z * axis.z, mass, 0.0f);
c.c = vec4(0.0f, mass, 0.0f, mass);
return c;
}
sway_carry sway_sum(sway_carry a, sway_carry b) {
a.b0 = a.b0 + b.b0;
a.b1 = a.b1 + b.b1;
a.b2 = a.b2 + b.b2;
a.p = a.p + b.p;
a.a = a.a + b.a;
a.ac = a.ac + b.ac;
a.c = a.c + b.c;
return a;
}
struct sway_parted {
sway_carry carry;
sway_gain gain;
};
sway_parted sway_part(sway_joint joint, sway_carry sum, sway_rule rule, vec4 rotation, vec3 bend,
vec4 parent_rotation) {
vec3 r = quaternion_rotate(parent_rotation, joint.offset);
vec3 b0 = vec3(sum.b0.x, sum.b0.y, sum.b0.z);
vec3 b1 = vec3(sum.b1.x, sum.b1.y, sum.b1.z);
vec3 b2 = vec3(sum.b2.x, sum.b2.y, sum.b2.z);
vec3 spin = vec3(sum.b0.w, sum.b1.w, sum.b2.w);
vec3 momentum = vec3(sum.p.x, sum.p.y, sum.p.z);
sway_sym a;
a.xx = sum.a.x;
a.xy = sum.a.y;
a.xz = sum.a.z;
a.yy = sum.a.w;
a.yz = sum.ac.x;
a.zz = sum.ac.y;
sway_sym d = a;
d.xx = a.xx + rule.hold;
d.yy = a.yy + rule.hold;
d.zz = a.zz + rule.hold;
sway_sym y = sway_inverse(d, rule.hold + 4e-6f * (a.xx + a.yy + a.zz));
sway_sym give = sway_product(y, a);
vec3 torque = spin - quaternion_rotate(rotation, bend) * rule.spring;
vec3 free = sway_times(y, torque);
vec3 y0 = b0 * y.xx + b1 * y.xy + b2 * y.xz;
vec3 y1 = b0 * y.xy + b1 * y.yy + b2 * y.yz;
vec3 y2 = b0 * y.xz + b1 * y.yz + b2 * y.zz;
vec3 spin_left = spin - sway_times(give, torque);
vec3 left = momentum - (b0 * free.x + b1 * free.y + b2 * free.z);
vec3 c0 = vec3(sum.ac.z, sum.ac.w, sum.c.x) - (y0 * b0.x + y1 * b1.x + y2 * b2.x);
float least = 4e-6f * (sum.ac.z + sum.c.y + sum.c.w);
float cxx = max(c0.x, least);
float cyy = max(sum.c.y - (b0.y * y0.y + b1.y * y1.y + b2.y * y2.y), least);
float cyz = sum.c.z - (b0.y * y0.z + b1.y * y1.z + b2.y * y2.z);
float czz = max(sum.c.w - (b0.z * y0.z + b1.z * y1.z + b2.z * y2.z), least);
c0.x = cxx;
vec3 c1 = vec3(c0.y, cyy, cyz);
vec3 c2 = vec3(c0.z, cyz, czz);
vec3 h0 = y0 * rule.hold;
vec3 h1 = y1 * rule.hold;
vec3 h2 = y2 * rule.hold;
vec3 n0 = h0 + (c2 * r.y - c1 * r.z);
vec3 n1 = h1 + (c0 * r.z - c2 * r.x);
vec3 n2 = h2 + (c1 * r.x - c0 * r.y);
vec3 s0 = sway_cross(r, h0);
vec3 s1 = sway_cross(r, h1);
vec3 s2 = sway_cross(r, h2);
vec3 t0 = sway_cross(r, n0);
vec3 t1 = sway_cross(r, n1);
vec3 t2 = sway_cross(r, n2);
spin_left = spin_left + sway_cross(r, left);
sway_parted parted;
parted.carry.b0 = vec4(n0, spin_left.x);
parted.carry.b1 = vec4(n1, spin_left.y);
parted.carry.b2 = vec4(n2, spin_left.z);
parted.carry.p = vec4(left, 0.0f);
parted.carry.a = vec4(rule.hold * give.xx + (s0.x + t0.x), rule.hold * give.xy + (s1.x + t0.y),
rule.hold * give.xz + (s2.x + t0.z), rule.hold * give.yy + (s1.y + t1.y));
parted.carry.ac = vec4(rule.hold * give.yz + (s2.y + t1.z),
rule.hold * give.zz + (s2.z + t2.z), c0.x, c0.y);
parted.carry.c = vec4(c0.z, cyy, cyz, czz);
parted.gain.b0 = vec4(y0, free.x);
parted.gain.b1 = vec4(y1, free.y);
parted.gain.b2 = vec4(y2, free.z);
parted.gain.e = vec4(give.xx, give.xy, give.xz, give.yy);
parted.gain.er = vec4(give.yz, give.zz, 0.0f, 0.0f);
parted.gain.r = vec4(r, 0.0f);
return parted;
}
sway_state sway_placed(sway_joint joint, sway_state parent, sway_state now) {
vec3 moved = quaternion_move(parent.rotation, joint.offset);
now.rotation = sway_rotated(parent.rotation, now.bend);
now.shift = parent.shift + moved;
now.turn = parent.turn + quaternion_rotate(parent.rotation, now.rate);
now.speed = parent.speed + sway_cross(parent.turn, joint.offset + moved);
return now;
}
sway_state sway_stepped(sway_joint joint, sway_gain gain, sway_state was, vec4 parent_was,
sway_state parent, sway_rule rule, sway_energy tree, float seconds) {
sway_sym give;
give.xx = gain.e.x;
give.xy = gain.e.y;
give.xz = gain.e.z;
give.yy = gain.e.w;
give.yz = gain.er.x;
give.zz = gain.er.y;
vec3 r = vec3(gain.r.x, gain.r.y, gain.r.z);
vec3 speed = parent.step_speed + sway_cross(parent.step_turn, r);
vec3 given = sway_times(give, parent.step_turn);
vec3 rate = vec3(
gain.b0.w - given.x - (gain.b0.x * speed.x + gain.b0.y * speed.y + gain.b0.z * speed.z),
gain.b1.w - given.y - (gain.b1.x * speed.x + gain.b1.y * speed.y + gain.b1.z * speed.z),
gain.b2.w - given.z - (gain.b2.x * speed.x + gain.b2.y * speed.y + gain.b2.z * speed.z));
vec3 turn = parent.step_turn + rate;
float ahead = 1.0f / rule.weight;
vec3 mean = sway_back(parent_was, rate);
vec3 old_rate = was.rate * tree.scale;
vec3 old_turn = was.turn * tree.scale;
vec3 old_speed = was.speed * tree.scale;
sway_state now = was;
now.budget = tree.budget;
now.bend = was.bend + mean * seconds;
now.rate = old_rate + (mean - old_rate) * ahead;
now.step_turn = turn;
now.step_speed = speed;
vec3 axis_was = quaternion_rotate(was.rotation, joint.axis);
now.before = sway_kinetic(joint, axis_was, old_turn + (turn - old_turn) * ahead,
old_speed + (speed - old_speed) * ahead);
now = sway_placed(joint, parent, now);
now.after = sway_kinetic(joint, quaternion_rotate(now.rotation, joint.axis), now.turn,
now.speed);
return now;
}
segment_pose sway_pose(sway_joint joint, sway_state state) {
segment_pose pose;
pose.rotation = state.rotation;
pose.base = joint.base;
pose.reserved0 = 0.0f;
pose.shift = state.shift;
pose.reserved1 = 0.0f;
return pose;
}
vec4 sway_velocity(sway_joint joint, vec4 was, sway_state now) {
vec3 middle = quaternion_rotate(was, joint.axis) * (0.5f * joint.extent);
return vec4(now.step_speed + sway_cross(now.step_turn, middle), 0.0f);
}
sway_energy sway_energy_of(sway_joint joint, sway_state state, segment_load load, vec4 velocity,
float seconds) {
sway_energy own;
own.before = state.before;
own.after = state.after;
own.elastic = 0.5f * joint.stiffness * sway_dot(state.bend, state.bend);
own.work = seconds * (load.force.x * velocity.x + load.force.y * velocity.y +
load.force.z * velocity.z);
own.scale = 1.0f;
own.budget = 0.0f;
own.reserved0 = 0.0f;
own.reserved1 = 0.0f;
return own;
}
sway_energy sway_energy_sum(sway_energy a, sway_energy b) {
a.before = a.before + b.before;
a.after = a.after + b.after;
a.elastic = a.elastic + b.elastic;
a.work = a.work + b.work;
return a;
}
struct sway_moment {
vec4 a;
vec4 ag;
vec4 force;
vec4 moment;
};
sway_moment sway_moment_sum(sway_moment a, sway_moment b) {
a.a = a.a + b.a;
a.ag = a.ag + b.ag;
a.force = a.force + b.force;
a.moment = a.moment + b.moment;
return a;
}
float sway_hold(vec3 force, vec3 r) {
float least = 0.5f * sqrt(sway_dot(force, force) * sway_dot(r, r));
return max(sway_dot(force, r), least);
}
sway_moment sway_pull(sway_joint joint, vec4 rotation, segment_load load) {
vec3 middle = quaternion_rotate(rotation, joint.axis) * (0.5f * joint.extent);
sway_moment m;
m.a = vec4(0.0f, 0.0f, 0.0f, 0.0f);
m.ag = vec4(0.0f, 0.0f, sway_hold(load.force, middle), 0.0f);
m.force = vec4(load.force, 0.0f);
m.moment = vec4(sway_cross(middle, load.force), 0.0f);
return m;
}
struct sway_balanced {
sway_moment carry;
sway_gain gain;
};
sway_balanced sway_balance(sway_joint joint, sway_moment sum, vec4 rotation, vec3 bend,
vec4 parent_rotation) {
vec3 r = quaternion_rotate(parent_rotation, joint.offset);
vec3 moment = vec3(sum.moment.x, sum.moment.y, sum.moment.z);
vec3 force = vec3(sum.force.x, sum.force.y, sum.force.z);
sway_sym a;
a.xx = sum.a.x + sum.ag.z;
a.xy = sum.a.y;
a.xz = sum.a.z;
a.yy = sum.a.w + sum.ag.z;
a.yz = sum.ag.x;
a.zz = sum.ag.y + sum.ag.z;
sway_sym d = a;
d.xx = a.xx + joint.stiffness;
d.yy = a.yy + joint.stiffness;
d.zz = a.zz + joint.stiffness;
sway_sym y = sway_inverse(d, joint.stiffness);
sway_sym give = sway_product(y, a);
vec3 torque = moment - quaternion_rotate(rotation, bend) * joint.stiffness;
vec3 free = sway_times(y, torque);
vec3 left = moment - sway_times(give, torque) + sway_cross(r, force);
float k = joint.stiffness;
sway_balanced b;
b.carry.a = vec4(k * give.xx, k * give.xy, k * give.xz, k * give.yy);
b.carry.ag = vec4(k * give.yz, k * give.zz, sway_hold(force, r), 0.0f);
b.carry.force = sum.force;
b.carry.moment = vec4(left, 0.0f);
b.gain.b0 = vec4(0.0f, 0.0f, 0.0f, free.x);
b.gain.b1 = vec4(0.0f, 0.0f, 0.0f, free.y);
b.gain.b2 = vec4(0.0f, 0.0f, 0.0f, free.z);
b.gain.e = vec4(give.xx, give.xy, give.xz, give.yy);
b.gain.er = vec4(give.yz, give.zz, 0.0f, 0.0f);
b.gain.r = vec4(r, 0.0f);
return b;
}
sway_gain sway_paper_gain(sway_joint joint, vec3 force, vec4 rotation, vec3 bend) {
vec3 axis = quaternion_rotate(rotation, joint.axis);
vec3 turn = sway_cross(axis, force) * (joint.extent / joint.stiffness);
vec3 free = turn - quaternion_rotate(rotation, bend);
sway_gain g;
g.b0 = vec4(0.0f, 0.0f, 0.0f, free.x);
g.b1 = vec4(0.0f, 0.0f, 0.0f, free.y);
g.b2 = vec4(0.0f, 0.0f, 0.0f, free.z);
g.e = vec4(0.0f, 0.0f, 0.0f, 0.0f);
g.er = vec4(0.0f, 0.0f, 0.0f, 0.0f);
g.r = vec4(0.0f, 0.0f, 0.0f, 0.0f);
return g;
}
sway_state sway_turned(sway_joint joint, sway_gain gain, sway_state was, vec4 parent_was,
sway_state parent) {
sway_sym give;
give.xx = gain.e.x;
give.xy = gain.e.y;
give.xz = gain.e.z;
give.yy = gain.e.w;
give.yz = gain.er.x;
give.zz = gain.er.y;
vec3 turn = vec3(gain.b0.w, gain.b1.w, gain.b2.w) - sway_times(give, parent.step_turn);
sway_state now = was;
now.bend = was.bend + sway_back(parent_was, turn);
now.step_turn = parent.step_turn + turn;
now.step_speed = vec3(0.0f, 0.0f, 0.0f);
now = sway_placed(joint, parent, now);
now.after = sway_kinetic(joint, quaternion_rotate(now.rotation, joint.axis), now.turn,
now.speed);
now.before = now.after;
now.budget = -1.0f;
return now;
}
layout(std430, binding = 0) readonly buffer joints_buffer { sway_joint joints[]; };
layout(std430, binding = 1) readonly buffer loads_buffer { segment_load loads[]; };
layout(std430, binding = 2) readonly buffer states_buffer { sway_state states[]; };
layout(std430, binding = 3) readonly buffer carried_buffer { sway_moment carried[]; };
layout(std430, binding = 4) writeonly buffer carry_buffer { sway_moment carry[]; };
layout(std430, binding = 5) writeonly buffer gains_buffer { sway_gain gains[]; };
void kernel_map(uint i) {
sway_joint joint = joints[i];
sway_state state = states[i];
sway_moment sum = sway_pull(joint, state.rotation, loads[i]);
for (uint c = joint.first_child; c < joint.first_child + joint.child_count; ++c) {
sum = sway_moment_sum(sum, carried[c]);
}
sway_balanced balanced = sway_balance(joint, sum, state.rotation, state.bend,
states[joint.parent].rotation);
carry[i] = balanced.carry;
gains[i] = balanced.gain;
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
)glsl", 21337};
};

} // namespace skybark::opengl
