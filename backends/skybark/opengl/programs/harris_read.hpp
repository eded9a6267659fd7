// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 2a1f43de46958999675b471adbb544bbb9486c02284bd45edabc6e93b1a2033a
#pragma once

#include <skybark/kernels/harris_read.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::harris_read> {
    static constexpr std::string_view map_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 64) in;
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
#define KERNEL_PARAMETERS light_grid grid; uint k; uint columns; uint rows; uint to;
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
layout(std430, binding = 1) readonly buffer order_buffer { uint order[]; };
layout(std430, binding = 2) readonly buffer light_buffer { float light[]; };
layout(std430, binding = 3) writeonly buffer lights_buffer { float lights[]; };
void kernel_map(uint i) {
vec3 cells = holdable_cells_of(grid, particles[2u * order[k]].xyz);
uint x = uint(clamp(floor(cells.x), 0.0, float(columns - 1u)));
uint z = uint(clamp(floor(cells.z), 0.0, float(rows - 1u)));
lights[to] = light[z * columns + x];
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
)glsl", 7981};
    static constexpr std::string_view levels_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define readonly coherent readonly
#define writeonly coherent writeonly
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 256) in;
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
#define KERNEL_PARAMETERS light_grid grid; uint k; uint columns; uint rows; uint to;
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
layout(std430, binding = 1) readonly buffer order_buffer { uint order[]; };
layout(std430, binding = 2) readonly buffer light_buffer { float light[]; };
layout(std430, binding = 3) writeonly buffer lights_buffer { float lights[]; };
void kernel_map(uint i) {
vec3 cells = holdable_cells_of(grid, particles[2u * order[k]].xyz);
uint x = uint(clamp(floor(cells.x), 0.0, float(columns - 1u)));
uint z = uint(clamp(floor(cells.z), 0.0, float(rows - 1u)));
lights[to] = light[z * columns + x];
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
)glsl", 7996};
};

} // namespace skybark::opengl
