// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 a325a888fcc77aa531a74fcd00ce891241ea1ca69ade61d24080f575eb47c787
#pragma once

#include <skybark/kernels/shadow_polygon.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::shadow_polygon> {
    static constexpr std::string_view accumulate_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_COMPUTE_STAGE
#ifdef SKYBARK_VULKAN
layout(local_size_x_id = 0) in;
#else
layout(local_size_x = 16) in;
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
#define KERNEL_PARAMETERS light_grid grid; float sigmas; float forward; uint light; uint profile; uint slices;
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
float exp_minus(float x)
{
float within = x < 87.0f ? x : 87.0f;
float halvings = floor(within * 1.44269504f + 0.5f);
float r = halvings * 0.693145752f - within;
r = r + halvings * 1.42860677e-6f;
float p = 1.0f + r * (1.0f / 7.0f);
p = 1.0f + r * (1.0f / 6.0f) * p;
p = 1.0f + r * (1.0f / 5.0f) * p;
p = 1.0f + r * (1.0f / 4.0f) * p;
p = 1.0f + r * (1.0f / 3.0f) * p;
p = 1.0f + r * (1.0f / 2.0f) * p;
p = 1.0f + r * p;
int exponent = 127 - int(halvings);
return x < 87.0f ? p * intBitsToFloat(exponent * 8388608) : 0.0f;
}
float one_minus_exp(float x)
{
float p = 1.0f - x * (1.0f / 9.0f);
p = 1.0f - x * (1.0f / 8.0f) * p;
p = 1.0f - x * (1.0f / 7.0f) * p;
p = 1.0f - x * (1.0f / 6.0f) * p;
p = 1.0f - x * (1.0f / 5.0f) * p;
p = 1.0f - x * (1.0f / 4.0f) * p;
p = 1.0f - x * (1.0f / 3.0f) * p;
p = 1.0f - x * (1.0f / 2.0f) * p;
return x < 0.5f ? x * p : 1.0f - exp_minus(x);
}
float log_of_sum(float sum, float less_one)
{
float twos = 0.0f;
float less = less_one;
if (less_one < -0.25f || less_one > 0.4f) {
int bits = floatBitsToInt(max(sum, 1.2e-38f));
int power = (bits - 0x3f3504f3) >> 23;
less = intBitsToFloat(bits - power * 8388608) - 1.0f;
twos = float(power);
}
float s = less / (2.0f + less);
float s2 = s * s;
float p = s2 * (1.0f / 11.0f) + 1.0f / 9.0f;
p = s2 * p + 1.0f / 7.0f;
p = s2 * p + 1.0f / 5.0f;
p = s2 * p + 1.0f / 3.0f;
p = s2 * p + 1.0f;
return 2.0f * s * p + twos * 0.693147181f;
}
float gaussian_above(float u)
{
float x = abs(u) * 0.707106781f;
float t = 1.0f / (1.0f + 0.3275911f * x);
float p = 1.061405429f * t - 1.453152027f;
p = p * t + 1.421413741f;
p = p * t - 0.284496736f;
p = p * t + 0.254829592f;
float tail = 0.5f * (p * t * exp_minus(x * x));
return u < 0.0f ? 1.0f - tail : tail;
}
vec3 cells_of(light_grid grid, vec3 place)
{
float px = place.x - grid.anchor.x;
float py = place.y - grid.anchor.y;
float pz = place.z - grid.anchor.z;
return vec3(grid.row_x.x * px + grid.row_x.y * py + grid.row_x.z * pz + grid.row_x.w,
grid.row_y.x * px + grid.row_y.y * py + grid.row_y.z * pz + grid.row_y.w,
grid.row_z.x * px + grid.row_z.y * py + grid.row_z.z * pz + grid.row_z.w);
}
vec3 place_of(light_grid grid, vec3 cells)
{
float x = (cells.x - grid.row_x.w) * grid.voxel.x * grid.voxel.x;
float y = (cells.y - grid.row_y.w) * grid.voxel.y * grid.voxel.y;
float z = (cells.z - grid.row_z.w) * grid.voxel.z * grid.voxel.z;
return vec3(
grid.anchor.x + grid.row_x.x * x + grid.row_y.x * y + grid.row_z.x * z,
grid.anchor.y + grid.row_x.y * x + grid.row_y.y * y + grid.row_z.y * z,
grid.anchor.z + grid.row_x.z * x + grid.row_y.z * y + grid.row_z.z * z);
}
float holdable(float cells)
{
return abs(cells) < 1.0e6f ? cells : -1.0e6f;
}
vec3 holdable_cells_of(light_grid grid, vec3 place)
{
vec3 cells = cells_of(grid, place);
return vec3(holdable(cells.x), holdable(cells.y), holdable(cells.z));
}
float bounded(float x, float largest)
{
return x > 0.0f ? min(x, largest) : 0.0f;
}
float particle_attenuation(cloud_particle p, float d2, float sigmas, uint light, float forward)
{
float r2 = p.radius * p.radius;
if (d2 >= r2) {
return 0.0f;
}
float tau = bounded(p.optical_depth, 1e6f) * exp_minus(0.5f * sigmas * sigmas * d2 / r2);
float albedo = bounded(p.albedo, 1.0f);
float on = albedo * forward * tau;
if (light == 2u && on > 0.0f) {
return -log_of_sum(exp_minus(tau) + on, on - one_minus_exp(tau));
}
return light == 1u ? tau * (1.0f - albedo * forward) : tau;
}
float summable(float amount)
{
return amount < 2147483520.0f ? amount : (amount > 0.0f ? 67108864.0f : 0.0f);
}
int top_row(float y, float radius)
{
return int(ceil(y + radius - 0.5f)) - 1;
}
int bottom_row(float y, float radius)
{
return int(floor(y - radius - 0.5f));
}
float part_above(uint profile, int row, float y, float radius, float sigmas)
{
if (row > top_row(y, radius)) {
return 0.0f;
}
if (profile == 0u || row <= bottom_row(y, radius)) {
return 1.0f;
}
return gaussian_above((float(row) + 0.5f - y) / radius * sigmas);
}
int quanta(float amount)
{
return int(floor(amount + 0.5f));
}
layout(std430, binding = 0) readonly buffer particles_buffer { vec4 particles[]; };
cloud_particle particle_at(uint i) {
vec4 a = particles[2u * i];
vec4 b = particles[2u * i + 1u];
return cloud_particle(a.xyz, a.w, b.x, b.y, b.z, b.w);
}
struct placed {
vec3 centre;
vec3 radius;
};
placed place(cloud_particle p) {
return placed(holdable_cells_of(grid, p.position),
vec3(holdable(p.radius / grid.voxel.x), holdable(p.radius / grid.voxel.y),
holdable(p.radius / grid.voxel.z)));
}
int first_slice(placed p) { return int(ceil(p.centre.z - p.radius.z - 0.5)); }
uint slice_count(placed p) {
int last = int(floor(p.centre.z + p.radius.z - 0.5));
int count = last - first_slice(p) + 1;
return count > 0 ? min(uint(count), slices) : 0u;
}
float lateral_of(cloud_particle p, placed at, int x, int z) {
float dx = (float(x) + 0.5 - at.centre.x) * grid.voxel.x;
float dz = (float(z) + 0.5 - at.centre.z) * grid.voxel.z;
float amount = particle_attenuation(p, dx * dx + dz * dz, sigmas, light, forward);
return summable(amount / grid.voxel.w);
}
float part_of(placed p, int y) { return part_above(profile, y, p.centre.y, p.radius.y, sigmas); }
layout(std430, binding = 1) readonly buffer corners_buffer { vec4 corners[]; };
uint kernel_slabs() { return 1u; }
uint kernel_slab_count(uint i) {
return i % 2u == 0u && corners[3u * i].x != corners[3u * i + 1u].x ? 1u : 0u;
}
voxel_slab kernel_slab(uint i, uint s) {
vec4 low = corners[3u * i];
vec4 high = corners[3u * i + 5u];
return voxel_slab(ivec2(ceil(low.xy - 0.5)), ivec2(ceil(high.xy - 0.5)), int(low.z));
}
cloud_particle particle_of(uint i) { return particle_at(uint(corners[3u * i].w)); }
float kernel_lateral(uint i, int x, int z) {
cloud_particle p = particle_of(i);
return lateral_of(p, place(p), x, z);
}
float kernel_row(uint i, int y) { return part_of(place(particle_of(i)), y); }
int kernel_amount(float lateral, float row, float above) { return quanta(lateral * row); }
layout(std430, binding = 10) readonly buffer skybark_length_buffer { uint skybark_length[]; };
layout(binding = SKYBARK_SUMS_BINDING, r32i) uniform iimage3D skybark_sums;
int skybark_fetch(ivec2 low, ivec2 high, int slice, int row, int step) {
int all = 0;
for (int y = low.y + row; y < high.y; y += step) {
all |= imageLoad(skybark_sums, ivec3(low.x, y, slice)).x;
all |= imageLoad(skybark_sums, ivec3(high.x - 1, y, slice)).x;
}
return all & int(skybark_header.w & 0xfffcu);
}
void skybark_add(uint i, uint s, int column, int step, ivec3 size) {
voxel_slab slab = kernel_slab(i, s);
if (slab.slice < 0 || slab.slice >= size.z) {
return;
}
ivec2 low = clamp(slab.low, ivec2(0), size.xy);
ivec2 high = min(slab.high, size.xy);
int first = low.x + column;
if ((skybark_header.w & 2u) != 0u && low.x < high.x && high.y - low.y > 1) {
first += skybark_fetch(low, high, slab.slice, column, step);
}
for (int x = first; x < high.x; x += step) {
float lateral = kernel_lateral(i, x, slab.slice);
float row = kernel_row(i, low.y);
for (int y = low.y; y < high.y; ++y) {
float above = kernel_row(i, y + 1);
int amount = kernel_amount(lateral, row, above);
if (amount != 0) {
imageAtomicAdd(skybark_sums, ivec3(x, y, slab.slice), amount);
}
row = above;
}
}
}
void main() {
uint lanes = skybark_header.z & 0xffffu;
uint sharing = skybark_header.z >> 16;
uint each = skybark_header.w >> 16;
uint parts = (kernel_slabs() + each - 1u) / each * sharing;
uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
uint k = group / parts;
uint i = skybark_header.x + k;
bool counted = (skybark_header.w & 1u) != 0u;
if (k >= skybark_header.y || (counted && i >= skybark_length[0])) {
return;
}
uint part = group - k * parts;
uint slot = gl_LocalInvocationID.x / lanes;
uint column = part % sharing * lanes + gl_LocalInvocationID.x - slot * lanes;
uint first = part / sharing * each;
uint last = min(first + each, kernel_slab_count(i));
ivec3 size = imageSize(skybark_sums);
for (uint s = first + slot; s < last; s += gl_WorkGroupSize.x / lanes) {
skybark_add(i, s, int(column), int(lanes * sharing), size);
}
}
)glsl", 11130};
    static constexpr std::string_view slabs_vert{R"glsl(#version 450
#define SKYBARK_OPENGL
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
#define KERNEL_PARAMETERS light_grid grid; float sigmas; float forward; uint light; uint profile; uint slices;
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
float exp_minus(float x)
{
float within = x < 87.0f ? x : 87.0f;
float halvings = floor(within * 1.44269504f + 0.5f);
float r = halvings * 0.693145752f - within;
r = r + halvings * 1.42860677e-6f;
float p = 1.0f + r * (1.0f / 7.0f);
p = 1.0f + r * (1.0f / 6.0f) * p;
p = 1.0f + r * (1.0f / 5.0f) * p;
p = 1.0f + r * (1.0f / 4.0f) * p;
p = 1.0f + r * (1.0f / 3.0f) * p;
p = 1.0f + r * (1.0f / 2.0f) * p;
p = 1.0f + r * p;
int exponent = 127 - int(halvings);
return x < 87.0f ? p * intBitsToFloat(exponent * 8388608) : 0.0f;
}
float one_minus_exp(float x)
{
float p = 1.0f - x * (1.0f / 9.0f);
p = 1.0f - x * (1.0f / 8.0f) * p;
p = 1.0f - x * (1.0f / 7.0f) * p;
p = 1.0f - x * (1.0f / 6.0f) * p;
p = 1.0f - x * (1.0f / 5.0f) * p;
p = 1.0f - x * (1.0f / 4.0f) * p;
p = 1.0f - x * (1.0f / 3.0f) * p;
p = 1.0f - x * (1.0f / 2.0f) * p;
return x < 0.5f ? x * p : 1.0f - exp_minus(x);
}
float log_of_sum(float sum, float less_one)
{
float twos = 0.0f;
float less = less_one;
if (less_one < -0.25f || less_one > 0.4f) {
int bits = floatBitsToInt(max(sum, 1.2e-38f));
int power = (bits - 0x3f3504f3) >> 23;
less = intBitsToFloat(bits - power * 8388608) - 1.0f;
twos = float(power);
}
float s = less / (2.0f + less);
float s2 = s * s;
float p = s2 * (1.0f / 11.0f) + 1.0f / 9.0f;
p = s2 * p + 1.0f / 7.0f;
p = s2 * p + 1.0f / 5.0f;
p = s2 * p + 1.0f / 3.0f;
p = s2 * p + 1.0f;
return 2.0f * s * p + twos * 0.693147181f;
}
float gaussian_above(float u)
{
float x = abs(u) * 0.707106781f;
float t = 1.0f / (1.0f + 0.3275911f * x);
float p = 1.061405429f * t - 1.453152027f;
p = p * t + 1.421413741f;
p = p * t - 0.284496736f;
p = p * t + 0.254829592f;
float tail = 0.5f * (p * t * exp_minus(x * x));
return u < 0.0f ? 1.0f - tail : tail;
}
vec3 cells_of(light_grid grid, vec3 place)
{
float px = place.x - grid.anchor.x;
float py = place.y - grid.anchor.y;
float pz = place.z - grid.anchor.z;
return vec3(grid.row_x.x * px + grid.row_x.y * py + grid.row_x.z * pz + grid.row_x.w,
grid.row_y.x * px + grid.row_y.y * py + grid.row_y.z * pz + grid.row_y.w,
grid.row_z.x * px + grid.row_z.y * py + grid.row_z.z * pz + grid.row_z.w);
}
vec3 place_of(light_grid grid, vec3 cells)
{
float x = (cells.x - grid.row_x.w) * grid.voxel.x * grid.voxel.x;
float y = (cells.y - grid.row_y.w) * grid.voxel.y * grid.voxel.y;
float z = (cells.z - grid.row_z.w) * grid.voxel.z * grid.voxel.z;
return vec3(
grid.anchor.x + grid.row_x.x * x + grid.row_y.x * y + grid.row_z.x * z,
grid.anchor.y + grid.row_x.y * x + grid.row_y.y * y + grid.row_z.y * z,
grid.anchor.z + grid.row_x.z * x + grid.row_y.z * y + grid.row_z.z * z);
}
float holdable(float cells)
{
return abs(cells) < 1.0e6f ? cells : -1.0e6f;
}
vec3 holdable_cells_of(light_grid grid, vec3 place)
{
vec3 cells = cells_of(grid, place);
return vec3(holdable(cells.x), holdable(cells.y), holdable(cells.z));
}
float bounded(float x, float largest)
{
return x > 0.0f ? min(x, largest) : 0.0f;
}
float particle_attenuation(cloud_particle p, float d2, float sigmas, uint light, float forward)
{
float r2 = p.radius * p.radius;
if (d2 >= r2) {
return 0.0f;
}
float tau = bounded(p.optical_depth, 1e6f) * exp_minus(0.5f * sigmas * sigmas * d2 / r2);
float albedo = bounded(p.albedo, 1.0f);
float on = albedo * forward * tau;
if (light == 2u && on > 0.0f) {
return -log_of_sum(exp_minus(tau) + on, on - one_minus_exp(tau));
}
return light == 1u ? tau * (1.0f - albedo * forward) : tau;
}
float summable(float amount)
{
return amount < 2147483520.0f ? amount : (amount > 0.0f ? 67108864.0f : 0.0f);
}
int top_row(float y, float radius)
{
return int(ceil(y + radius - 0.5f)) - 1;
}
int bottom_row(float y, float radius)
{
return int(floor(y - radius - 0.5f));
}
float part_above(uint profile, int row, float y, float radius, float sigmas)
{
if (row > top_row(y, radius)) {
return 0.0f;
}
if (profile == 0u || row <= bottom_row(y, radius)) {
return 1.0f;
}
return gaussian_above((float(row) + 0.5f - y) / radius * sigmas);
}
int quanta(float amount)
{
return int(floor(amount + 0.5f));
}
layout(std430, binding = 0) readonly buffer particles_buffer { vec4 particles[]; };
cloud_particle particle_at(uint i) {
vec4 a = particles[2u * i];
vec4 b = particles[2u * i + 1u];
return cloud_particle(a.xyz, a.w, b.x, b.y, b.z, b.w);
}
struct placed {
vec3 centre;
vec3 radius;
};
placed place(cloud_particle p) {
return placed(holdable_cells_of(grid, p.position),
vec3(holdable(p.radius / grid.voxel.x), holdable(p.radius / grid.voxel.y),
holdable(p.radius / grid.voxel.z)));
}
int first_slice(placed p) { return int(ceil(p.centre.z - p.radius.z - 0.5)); }
uint slice_count(placed p) {
int last = int(floor(p.centre.z + p.radius.z - 0.5));
int count = last - first_slice(p) + 1;
return count > 0 ? min(uint(count), slices) : 0u;
}
float lateral_of(cloud_particle p, placed at, int x, int z) {
float dx = (float(x) + 0.5 - at.centre.x) * grid.voxel.x;
float dz = (float(z) + 0.5 - at.centre.z) * grid.voxel.z;
float amount = particle_attenuation(p, dx * dx + dz * dz, sigmas, light, forward);
return summable(amount / grid.voxel.w);
}
float part_of(placed p, int y) { return part_above(profile, y, p.centre.y, p.radius.y, sigmas); }
layout(std430, binding = 1) readonly buffer corners_buffer { vec4 corners[]; };
uint kernel_slabs() { return 1u; }
uint kernel_slab_count(uint i) {
return i % 2u == 0u && corners[3u * i].x != corners[3u * i + 1u].x ? 1u : 0u;
}
voxel_slab kernel_slab(uint i, uint s) {
vec4 low = corners[3u * i];
vec4 high = corners[3u * i + 5u];
return voxel_slab(ivec2(ceil(low.xy - 0.5)), ivec2(ceil(high.xy - 0.5)), int(low.z));
}
cloud_particle particle_of(uint i) { return particle_at(uint(corners[3u * i].w)); }
float kernel_lateral(uint i, int x, int z) {
cloud_particle p = particle_of(i);
return lateral_of(p, place(p), x, z);
}
float kernel_row(uint i, int y) { return part_of(place(particle_of(i)), y); }
int kernel_amount(float lateral, float row, float above) { return quanta(lateral * row); }
layout(location = 0) uniform ivec4 skybark_layers;
layout(location = 1) uniform ivec4 skybark_tiles;
ivec2 skybark_origin(int n) {
return skybark_tiles.x == 0
? ivec2(0)
: ivec2(n % skybark_tiles.x, n / skybark_tiles.x) * skybark_layers.xy;
}
bool skybark_empty(voxel_slab slab) { return any(greaterThanEqual(slab.low, slab.high)); }
voxel_slab skybark_nothing() { return voxel_slab(ivec2(0), ivec2(0), skybark_layers.z); }
voxel_slab skybark_visible(uint i, uint s) {
voxel_slab slab = kernel_slab(i, s);
slab.low = max(slab.low, ivec2(0));
slab.high = min(slab.high, skybark_layers.xy);
bool inside =
slab.slice >= skybark_layers.z && slab.slice - skybark_layers.z < skybark_layers.w;
if (!inside || skybark_empty(slab)) {
return skybark_nothing();
}
return slab;
}
vec4 skybark_corner(voxel_slab slab, uint corner) {
ivec2 at = ivec2((corner & 1u) != 0u ? slab.high.x : slab.low.x,
(corner & 2u) != 0u ? slab.high.y : slab.low.y);
at += skybark_origin(slab.slice - skybark_layers.z);
return vec4(vec2(2 * at - skybark_tiles.zw) / vec2(skybark_tiles.zw), 0.0, 1.0);
}
layout(location = 0) flat out ivec2 skybark_cell;
void main() {
if ((skybark_header.w & 8u) != 0u) {
skybark_cell = ivec2(gl_VertexID, 0);
gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
return;
}
const uint corners[6] = uint[6](0u, 1u, 2u, 2u, 1u, 3u);
uint rectangle = uint(gl_VertexID) / 6u;
uint element = rectangle / kernel_slabs();
uint s = rectangle - element * kernel_slabs();
uint i = skybark_header.x + element;
voxel_slab slab = skybark_nothing();
if (s < kernel_slab_count(i)) {
slab = skybark_visible(i, s);
}
skybark_cell = ivec2(i, slab.slice);
gl_Position = skybark_corner(slab, corners[uint(gl_VertexID) - rectangle * 6u]);
}
)glsl", 10600};
    static constexpr std::string_view slabs_geom{R"glsl(#version 450
#define SKYBARK_OPENGL
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
#define KERNEL_PARAMETERS light_grid grid; float sigmas; float forward; uint light; uint profile; uint slices;
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
float exp_minus(float x)
{
float within = x < 87.0f ? x : 87.0f;
float halvings = floor(within * 1.44269504f + 0.5f);
float r = halvings * 0.693145752f - within;
r = r + halvings * 1.42860677e-6f;
float p = 1.0f + r * (1.0f / 7.0f);
p = 1.0f + r * (1.0f / 6.0f) * p;
p = 1.0f + r * (1.0f / 5.0f) * p;
p = 1.0f + r * (1.0f / 4.0f) * p;
p = 1.0f + r * (1.0f / 3.0f) * p;
p = 1.0f + r * (1.0f / 2.0f) * p;
p = 1.0f + r * p;
int exponent = 127 - int(halvings);
return x < 87.0f ? p * intBitsToFloat(exponent * 8388608) : 0.0f;
}
float one_minus_exp(float x)
{
float p = 1.0f - x * (1.0f / 9.0f);
p = 1.0f - x * (1.0f / 8.0f) * p;
p = 1.0f - x * (1.0f / 7.0f) * p;
p = 1.0f - x * (1.0f / 6.0f) * p;
p = 1.0f - x * (1.0f / 5.0f) * p;
p = 1.0f - x * (1.0f / 4.0f) * p;
p = 1.0f - x * (1.0f / 3.0f) * p;
p = 1.0f - x * (1.0f / 2.0f) * p;
return x < 0.5f ? x * p : 1.0f - exp_minus(x);
}
float log_of_sum(float sum, float less_one)
{
float twos = 0.0f;
float less = less_one;
if (less_one < -0.25f || less_one > 0.4f) {
int bits = floatBitsToInt(max(sum, 1.2e-38f));
int power = (bits - 0x3f3504f3) >> 23;
less = intBitsToFloat(bits - power * 8388608) - 1.0f;
twos = float(power);
}
float s = less / (2.0f + less);
float s2 = s * s;
float p = s2 * (1.0f / 11.0f) + 1.0f / 9.0f;
p = s2 * p + 1.0f / 7.0f;
p = s2 * p + 1.0f / 5.0f;
p = s2 * p + 1.0f / 3.0f;
p = s2 * p + 1.0f;
return 2.0f * s * p + twos * 0.693147181f;
}
float gaussian_above(float u)
{
float x = abs(u) * 0.707106781f;
float t = 1.0f / (1.0f + 0.3275911f * x);
float p = 1.061405429f * t - 1.453152027f;
p = p * t + 1.421413741f;
p = p * t - 0.284496736f;
p = p * t + 0.254829592f;
float tail = 0.5f * (p * t * exp_minus(x * x));
return u < 0.0f ? 1.0f - tail : tail;
}
vec3 cells_of(light_grid grid, vec3 place)
{
float px = place.x - grid.anchor.x;
float py = place.y - grid.anchor.y;
float pz = place.z - grid.anchor.z;
return vec3(grid.row_x.x * px + grid.row_x.y * py + grid.row_x.z * pz + grid.row_x.w,
grid.row_y.x * px + grid.row_y.y * py + grid.row_y.z * pz + grid.row_y.w,
grid.row_z.x * px + grid.row_z.y * py + grid.row_z.z * pz + grid.row_z.w);
}
vec3 place_of(light_grid grid, vec3 cells)
{
float x = (cells.x - grid.row_x.w) * grid.voxel.x * grid.voxel.x;
float y = (cells.y - grid.row_y.w) * grid.voxel.y * grid.voxel.y;
float z = (cells.z - grid.row_z.w) * grid.voxel.z * grid.voxel.z;
return vec3(
grid.anchor.x + grid.row_x.x * x + grid.row_y.x * y + grid.row_z.x * z,
grid.anchor.y + grid.row_x.y * x + grid.row_y.y * y + grid.row_z.y * z,
grid.anchor.z + grid.row_x.z * x + grid.row_y.z * y + grid.row_z.z * z);
}
float holdable(float cells)
{
return abs(cells) < 1.0e6f ? cells : -1.0e6f;
}
vec3 holdable_cells_of(light_grid grid, vec3 place)
{
vec3 cells = cells_of(grid, place);
return vec3(holdable(cells.x), holdable(cells.y), holdable(cells.z));
}
float bounded(float x, float largest)
{
return x > 0.0f ? min(x, largest) : 0.0f;
}
float particle_attenuation(cloud_particle p, float d2, float sigmas, uint light, float forward)
{
float r2 = p.radius * p.radius;
if (d2 >= r2) {
return 0.0f;
}
float tau = bounded(p.optical_depth, 1e6f) * exp_minus(0.5f * sigmas * sigmas * d2 / r2);
float albedo = bounded(p.albedo, 1.0f);
float on = albedo * forward * tau;
if (light == 2u && on > 0.0f) {
return -log_of_sum(exp_minus(tau) + on, on - one_minus_exp(tau));
}
return light == 1u ? tau * (1.0f - albedo * forward) : tau;
}
float summable(float amount)
{
return amount < 2147483520.0f ? amount : (amount > 0.0f ? 67108864.0f : 0.0f);
}
int top_row(float y, float radius)
{
return int(ceil(y + radius - 0.5f)) - 1;
}
int bottom_row(float y, float radius)
{
return int(floor(y - radius - 0.5f));
}
float part_above(uint profile, int row, float y, float radius, float sigmas)
{
if (row > top_row(y, radius)) {
return 0.0f;
}
if (profile == 0u || row <= bottom_row(y, radius)) {
return 1.0f;
}
return gaussian_above((float(row) + 0.5f - y) / radius * sigmas);
}
int quanta(float amount)
{
return int(floor(amount + 0.5f));
}
layout(std430, binding = 0) readonly buffer particles_buffer { vec4 particles[]; };
cloud_particle particle_at(uint i) {
vec4 a = particles[2u * i];
vec4 b = particles[2u * i + 1u];
return cloud_particle(a.xyz, a.w, b.x, b.y, b.z, b.w);
}
struct placed {
vec3 centre;
vec3 radius;
};
placed place(cloud_particle p) {
return placed(holdable_cells_of(grid, p.position),
vec3(holdable(p.radius / grid.voxel.x), holdable(p.radius / grid.voxel.y),
holdable(p.radius / grid.voxel.z)));
}
int first_slice(placed p) { return int(ceil(p.centre.z - p.radius.z - 0.5)); }
uint slice_count(placed p) {
int last = int(floor(p.centre.z + p.radius.z - 0.5));
int count = last - first_slice(p) + 1;
return count > 0 ? min(uint(count), slices) : 0u;
}
float lateral_of(cloud_particle p, placed at, int x, int z) {
float dx = (float(x) + 0.5 - at.centre.x) * grid.voxel.x;
float dz = (float(z) + 0.5 - at.centre.z) * grid.voxel.z;
float amount = particle_attenuation(p, dx * dx + dz * dz, sigmas, light, forward);
return summable(amount / grid.voxel.w);
}
float part_of(placed p, int y) { return part_above(profile, y, p.centre.y, p.radius.y, sigmas); }
layout(std430, binding = 1) readonly buffer corners_buffer { vec4 corners[]; };
uint kernel_slabs() { return 1u; }
uint kernel_slab_count(uint i) {
return i % 2u == 0u && corners[3u * i].x != corners[3u * i + 1u].x ? 1u : 0u;
}
voxel_slab kernel_slab(uint i, uint s) {
vec4 low = corners[3u * i];
vec4 high = corners[3u * i + 5u];
return voxel_slab(ivec2(ceil(low.xy - 0.5)), ivec2(ceil(high.xy - 0.5)), int(low.z));
}
cloud_particle particle_of(uint i) { return particle_at(uint(corners[3u * i].w)); }
float kernel_lateral(uint i, int x, int z) {
cloud_particle p = particle_of(i);
return lateral_of(p, place(p), x, z);
}
float kernel_row(uint i, int y) { return part_of(place(particle_of(i)), y); }
int kernel_amount(float lateral, float row, float above) { return quanta(lateral * row); }
layout(location = 0) uniform ivec4 skybark_layers;
layout(location = 1) uniform ivec4 skybark_tiles;
ivec2 skybark_origin(int n) {
return skybark_tiles.x == 0
? ivec2(0)
: ivec2(n % skybark_tiles.x, n / skybark_tiles.x) * skybark_layers.xy;
}
bool skybark_empty(voxel_slab slab) { return any(greaterThanEqual(slab.low, slab.high)); }
voxel_slab skybark_nothing() { return voxel_slab(ivec2(0), ivec2(0), skybark_layers.z); }
voxel_slab skybark_visible(uint i, uint s) {
voxel_slab slab = kernel_slab(i, s);
slab.low = max(slab.low, ivec2(0));
slab.high = min(slab.high, skybark_layers.xy);
bool inside =
slab.slice >= skybark_layers.z && slab.slice - skybark_layers.z < skybark_layers.w;
if (!inside || skybark_empty(slab)) {
return skybark_nothing();
}
return slab;
}
vec4 skybark_corner(voxel_slab slab, uint corner) {
ivec2 at = ivec2((corner & 1u) != 0u ? slab.high.x : slab.low.x,
(corner & 2u) != 0u ? slab.high.y : slab.low.y);
at += skybark_origin(slab.slice - skybark_layers.z);
return vec4(vec2(2 * at - skybark_tiles.zw) / vec2(skybark_tiles.zw), 0.0, 1.0);
}
#ifndef SKYBARK_MAX_VERTICES
#define SKYBARK_MAX_VERTICES 16
#endif
layout(points) in;
layout(triangle_strip, max_vertices = SKYBARK_MAX_VERTICES) out;
layout(location = 0) flat in ivec2 skybark_point[1];
layout(location = 0) flat out ivec2 skybark_cell;
void skybark_emit(uint i, voxel_slab slab) {
for (uint corner = 0u; corner < 4u; ++corner) {
skybark_cell = ivec2(i, slab.slice);
gl_Layer = slab.slice - skybark_layers.z;
gl_Position = skybark_corner(slab, corner);
EmitVertex();
}
EndPrimitive();
}
void main() {
uint slabs = kernel_slabs();
uint parts = (slabs + skybark_header.z - 1u) / skybark_header.z;
uint element = uint(skybark_point[0].x) / parts;
uint i = skybark_header.x + element;
uint first = (uint(skybark_point[0].x) - element * parts) * skybark_header.z;
bool padded = (skybark_header.w & 2u) != 0u;
uint count = kernel_slab_count(i);
uint last = min(first + skybark_header.z, padded ? slabs : min(count, slabs));
for (uint s = first; s < last; ++s) {
voxel_slab slab = skybark_nothing();
if (s < count) {
slab = skybark_visible(i, s);
}
if (padded || !skybark_empty(slab)) {
skybark_emit(i, slab);
}
}
}
)glsl", 11092};
    static constexpr std::string_view slabs_frag{R"glsl(#version 450
#define SKYBARK_OPENGL
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
#define KERNEL_PARAMETERS light_grid grid; float sigmas; float forward; uint light; uint profile; uint slices;
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
float exp_minus(float x)
{
float within = x < 87.0f ? x : 87.0f;
float halvings = floor(within * 1.44269504f + 0.5f);
float r = halvings * 0.693145752f - within;
r = r + halvings * 1.42860677e-6f;
float p = 1.0f + r * (1.0f / 7.0f);
p = 1.0f + r * (1.0f / 6.0f) * p;
p = 1.0f + r * (1.0f / 5.0f) * p;
p = 1.0f + r * (1.0f / 4.0f) * p;
p = 1.0f + r * (1.0f / 3.0f) * p;
p = 1.0f + r * (1.0f / 2.0f) * p;
p = 1.0f + r * p;
int exponent = 127 - int(halvings);
return x < 87.0f ? p * intBitsToFloat(exponent * 8388608) : 0.0f;
}
float one_minus_exp(float x)
{
float p = 1.0f - x * (1.0f / 9.0f);
p = 1.0f - x * (1.0f / 8.0f) * p;
p = 1.0f - x * (1.0f / 7.0f) * p;
p = 1.0f - x * (1.0f / 6.0f) * p;
p = 1.0f - x * (1.0f / 5.0f) * p;
p = 1.0f - x * (1.0f / 4.0f) * p;
p = 1.0f - x * (1.0f / 3.0f) * p;
p = 1.0f - x * (1.0f / 2.0f) * p;
return x < 0.5f ? x * p : 1.0f - exp_minus(x);
}
float log_of_sum(float sum, float less_one)
{
float twos = 0.0f;
float less = less_one;
if (less_one < -0.25f || less_one > 0.4f) {
int bits = floatBitsToInt(max(sum, 1.2e-38f));
int power = (bits - 0x3f3504f3) >> 23;
less = intBitsToFloat(bits - power * 8388608) - 1.0f;
twos = float(power);
}
float s = less / (2.0f + less);
float s2 = s * s;
float p = s2 * (1.0f / 11.0f) + 1.0f / 9.0f;
p = s2 * p + 1.0f / 7.0f;
p = s2 * p + 1.0f / 5.0f;
p = s2 * p + 1.0f / 3.0f;
p = s2 * p + 1.0f;
return 2.0f * s * p + twos * 0.693147181f;
}
float gaussian_above(float u)
{
float x = abs(u) * 0.707106781f;
float t = 1.0f / (1.0f + 0.3275911f * x);
float p = 1.061405429f * t - 1.453152027f;
p = p * t + 1.421413741f;
p = p * t - 0.284496736f;
p = p * t + 0.254829592f;
float tail = 0.5f * (p * t * exp_minus(x * x));
return u < 0.0f ? 1.0f - tail : tail;
}
vec3 cells_of(light_grid grid, vec3 place)
{
float px = place.x - grid.anchor.x;
float py = place.y - grid.anchor.y;
float pz = place.z - grid.anchor.z;
return vec3(grid.row_x.x * px + grid.row_x.y * py + grid.row_x.z * pz + grid.row_x.w,
grid.row_y.x * px + grid.row_y.y * py + grid.row_y.z * pz + grid.row_y.w,
grid.row_z.x * px + grid.row_z.y * py + grid.row_z.z * pz + grid.row_z.w);
}
vec3 place_of(light_grid grid, vec3 cells)
{
float x = (cells.x - grid.row_x.w) * grid.voxel.x * grid.voxel.x;
float y = (cells.y - grid.row_y.w) * grid.voxel.y * grid.voxel.y;
float z = (cells.z - grid.row_z.w) * grid.voxel.z * grid.voxel.z;
return vec3(
grid.anchor.x + grid.row_x.x * x + grid.row_y.x * y + grid.row_z.x * z,
grid.anchor.y + grid.row_x.y * x + grid.row_y.y * y + grid.row_z.y * z,
grid.anchor.z + grid.row_x.z * x + grid.row_y.z * y + grid.row_z.z * z);
}
float holdable(float cells)
{
return abs(cells) < 1.0e6f ? cells : -1.0e6f;
}
vec3 holdable_cells_of(light_grid grid, vec3 place)
{
vec3 cells = cells_of(grid, place);
return vec3(holdable(cells.x), holdable(cells.y), holdable(cells.z));
}
float bounded(float x, float largest)
{
return x > 0.0f ? min(x, largest) : 0.0f;
}
float particle_attenuation(cloud_particle p, float d2, float sigmas, uint light, float forward)
{
float r2 = p.radius * p.radius;
if (d2 >= r2) {
return 0.0f;
}
float tau = bounded(p.optical_depth, 1e6f) * exp_minus(0.5f * sigmas * sigmas * d2 / r2);
float albedo = bounded(p.albedo, 1.0f);
float on = albedo * forward * tau;
if (light == 2u && on > 0.0f) {
return -log_of_sum(exp_minus(tau) + on, on - one_minus_exp(tau));
}
return light == 1u ? tau * (1.0f - albedo * forward) : tau;
}
float summable(float amount)
{
return amount < 2147483520.0f ? amount : (amount > 0.0f ? 67108864.0f : 0.0f);
}
int top_row(float y, float radius)
{
return int(ceil(y + radius - 0.5f)) - 1;
}
int bottom_row(float y, float radius)
{
return int(floor(y - radius - 0.5f));
}
float part_above(uint profile, int row, float y, float radius, float sigmas)
{
if (row > top_row(y, radius)) {
return 0.0f;
}
if (profile == 0u || row <= bottom_row(y, radius)) {
return 1.0f;
}
return gaussian_above((float(row) + 0.5f - y) / radius * sigmas);
}
int quanta(float amount)
{
return int(floor(amount + 0.5f));
}
layout(std430, binding = 0) readonly buffer particles_buffer { vec4 particles[]; };
cloud_particle particle_at(uint i) {
vec4 a = particles[2u * i];
vec4 b = particles[2u * i + 1u];
return cloud_particle(a.xyz, a.w, b.x, b.y, b.z, b.w);
}
struct placed {
vec3 centre;
vec3 radius;
};
placed place(cloud_particle p) {
return placed(holdable_cells_of(grid, p.position),
vec3(holdable(p.radius / grid.voxel.x), holdable(p.radius / grid.voxel.y),
holdable(p.radius / grid.voxel.z)));
}
int first_slice(placed p) { return int(ceil(p.centre.z - p.radius.z - 0.5)); }
uint slice_count(placed p) {
int last = int(floor(p.centre.z + p.radius.z - 0.5));
int count = last - first_slice(p) + 1;
return count > 0 ? min(uint(count), slices) : 0u;
}
float lateral_of(cloud_particle p, placed at, int x, int z) {
float dx = (float(x) + 0.5 - at.centre.x) * grid.voxel.x;
float dz = (float(z) + 0.5 - at.centre.z) * grid.voxel.z;
float amount = particle_attenuation(p, dx * dx + dz * dz, sigmas, light, forward);
return summable(amount / grid.voxel.w);
}
float part_of(placed p, int y) { return part_above(profile, y, p.centre.y, p.radius.y, sigmas); }
layout(std430, binding = 1) readonly buffer corners_buffer { vec4 corners[]; };
uint kernel_slabs() { return 1u; }
uint kernel_slab_count(uint i) {
return i % 2u == 0u && corners[3u * i].x != corners[3u * i + 1u].x ? 1u : 0u;
}
voxel_slab kernel_slab(uint i, uint s) {
vec4 low = corners[3u * i];
vec4 high = corners[3u * i + 5u];
return voxel_slab(ivec2(ceil(low.xy - 0.5)), ivec2(ceil(high.xy - 0.5)), int(low.z));
}
cloud_particle particle_of(uint i) { return particle_at(uint(corners[3u * i].w)); }
float kernel_lateral(uint i, int x, int z) {
cloud_particle p = particle_of(i);
return lateral_of(p, place(p), x, z);
}
float kernel_row(uint i, int y) { return part_of(place(particle_of(i)), y); }
int kernel_amount(float lateral, float row, float above) { return quanta(lateral * row); }
layout(location = 0) uniform ivec4 skybark_layers;
layout(location = 1) uniform ivec4 skybark_tiles;
ivec2 skybark_origin(int n) {
return skybark_tiles.x == 0
? ivec2(0)
: ivec2(n % skybark_tiles.x, n / skybark_tiles.x) * skybark_layers.xy;
}
bool skybark_empty(voxel_slab slab) { return any(greaterThanEqual(slab.low, slab.high)); }
voxel_slab skybark_nothing() { return voxel_slab(ivec2(0), ivec2(0), skybark_layers.z); }
voxel_slab skybark_visible(uint i, uint s) {
voxel_slab slab = kernel_slab(i, s);
slab.low = max(slab.low, ivec2(0));
slab.high = min(slab.high, skybark_layers.xy);
bool inside =
slab.slice >= skybark_layers.z && slab.slice - skybark_layers.z < skybark_layers.w;
if (!inside || skybark_empty(slab)) {
return skybark_nothing();
}
return slab;
}
vec4 skybark_corner(voxel_slab slab, uint corner) {
ivec2 at = ivec2((corner & 1u) != 0u ? slab.high.x : slab.low.x,
(corner & 2u) != 0u ? slab.high.y : slab.low.y);
at += skybark_origin(slab.slice - skybark_layers.z);
return vec4(vec2(2 * at - skybark_tiles.zw) / vec2(skybark_tiles.zw), 0.0, 1.0);
}
layout(location = 0) flat in ivec2 skybark_cell;
layout(location = 0) out vec2 skybark_amount;
void main() {
int slice = skybark_cell.y;
ivec2 at = ivec2(gl_FragCoord.xy) - skybark_origin(slice - skybark_layers.z);
uint i = uint(skybark_cell.x);
int amount = kernel_amount(kernel_lateral(i, at.x, slice), kernel_row(i, at.y),
kernel_row(i, at.y + 1));
int low = amount & 255;
int carry = low >> 7;
skybark_amount = vec2(float((amount >> 8) + carry), float(low - 256 * carry));
}
)glsl", 10444};
};

} // namespace skybark::opengl
