// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 40a7f5e571e8c9da3eb82079be8a2b722c8008986d7918ec2c54074e63e9ac46
#pragma once

#include <skybark/kernels/clouded_ground.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::clouded_ground> {
    static constexpr std::string_view draw_vert{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_VERTEX_STAGE
#define KERNEL_VARYINGS 1
#define KERNEL_VOLUMES 1
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
#define KERNEL_PARAMETERS light_grid grid; float height; float extent; float air; float shadow;
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
struct daylight_sky {
vec4 a;
vec4 b;
vec4 c;
vec4 d;
vec4 e;
vec4 zenith;
vec4 to_sun;
vec4 sunlight;
};
float exp_shared(float x) {
float s = x * (1.0f / 64.0f);
float p = 1.0f + s * (1.0f + s * (0.5f + s * (0.16666667f + s * (0.041666667f + s * 0.0083333333f))));
p = p * p;
p = p * p;
p = p * p;
p = p * p;
p = p * p;
return p * p;
}
float arccos_shared(float x) {
float c = clamp(x, -1.0f, 1.0f);
return atan(sqrt((1.0f - c) * (1.0f + c)), c);
}
float perez(float a, float b, float c, float d, float e, float cos_zenith, float gamma) {
float cos_gamma = cos(gamma);
return (1.0f + a * exp_shared(b / cos_zenith)) *
(1.0f + c * exp_shared(d * gamma) + e * cos_gamma * cos_gamma);
}
vec3 srgb_from_xyY(float luminance, float x, float y) {
float X = luminance * x / y;
float Z = luminance * (1.0f - x - y) / y;
return vec3(3.2406f * X - 1.5372f * luminance - 0.4986f * Z,
-0.9689f * X + 1.8758f * luminance + 0.0415f * Z,
0.0557f * X - 0.2040f * luminance + 1.0570f * Z);
}
vec3 sky_radiance(daylight_sky sky, vec3 to) {
float up = max(to.y, 0.01f);
float flat_length = sqrt(max(1.0f - up * up, 0.0f) /
max(to.x * to.x + to.z * to.z, 1e-12f));
float cos_gamma = to.x * flat_length * sky.to_sun.x + up * sky.to_sun.y +
to.z * flat_length * sky.to_sun.z;
float gamma = arccos_shared(cos_gamma);
float luminance = sky.zenith.x * perez(sky.a.x, sky.b.x, sky.c.x, sky.d.x, sky.e.x, up, gamma);
float x = sky.zenith.y * perez(sky.a.y, sky.b.y, sky.c.y, sky.d.y, sky.e.y, up, gamma);
float y = sky.zenith.z * perez(sky.a.z, sky.b.z, sky.c.z, sky.d.z, sky.e.z, up, gamma);
vec3 rgb = srgb_from_xyY(luminance, x, y);
return vec3(max(rgb.x, 0.0f), max(rgb.y, 0.0f), max(rgb.z, 0.0f));
}
float hash_unit(uint x, uint y, uint z) {
uint h = x * 73856093u ^ y * 19349663u ^ z * 83492791u;
h = h ^ (h >> 16u);
h = h * 2246822519u;
h = h ^ (h >> 13u);
h = h * 3266489917u;
h = h ^ (h >> 16u);
return float(h >> 8u) * (1.0f / 16777216.0f);
}
float value_noise(float x, float y, float z, uint period) {
float fx = floor(x);
float fy = floor(y);
float fz = floor(z);
float tx = x - fx;
float ty = y - fy;
float tz = z - fz;
tx = tx * tx * (3.0f - 2.0f * tx);
ty = ty * ty * (3.0f - 2.0f * ty);
tz = tz * tz * (3.0f - 2.0f * tz);
uint x0 = uint(int(fx) + 1048576) % period;
uint x1 = (x0 + 1u) % period;
uint y0 = uint(int(fy) + 1048576);
uint z0 = uint(int(fz) + 1048576);
float n00 = mix(hash_unit(x0, y0, z0), hash_unit(x1, y0, z0), tx);
float n10 = mix(hash_unit(x0, y0 + 1u, z0), hash_unit(x1, y0 + 1u, z0), tx);
float n01 = mix(hash_unit(x0, y0, z0 + 1u), hash_unit(x1, y0, z0 + 1u), tx);
float n11 = mix(hash_unit(x0, y0 + 1u, z0 + 1u), hash_unit(x1, y0 + 1u, z0 + 1u), tx);
return mix(mix(n00, n10, ty), mix(n01, n11, ty), tz);
}
vec3 ambient_light(vec4 h0, vec4 h1, vec4 h2, vec4 h3, vec3 n) {
return vec3(max(h0.x + h1.x * n.x + h2.x * n.y + h3.x * n.z, 0.0f),
max(h0.y + h1.y * n.x + h2.y * n.y + h3.y * n.z, 0.0f),
max(h0.z + h1.z * n.x + h2.z * n.y + h3.z * n.z, 0.0f));
}
vec3 lit(vec3 albedo, vec3 n, daylight_sky sky, float sun, vec3 ambient) {
float facing = max(n.x * sky.to_sun.x + n.y * sky.to_sun.y + n.z * sky.to_sun.z, 0.0f) * sun;
return vec3(albedo.x * (ambient.x + sky.sunlight.x * facing),
albedo.y * (ambient.y + sky.sunlight.y * facing),
albedo.z * (ambient.z + sky.sunlight.z * facing));
}
float bark_height(float u, float v, uint cells) {
float around = u * float(cells);
float warp = value_noise(around * 0.5f, v * 3.0f, 7.0f, max(cells / 2u, 1u));
float furrow = value_noise(around + 2.0f * warp, v * 6.0f, 0.0f, cells);
float fine = value_noise(around * 3.0f, v * 24.0f, 3.0f, cells * 3u);
return 0.7f * furrow + 0.3f * fine;
}
vec3 bark_albedo(float height) {
return vec3(mix(0.10f, 0.34f, height), mix(0.075f, 0.27f, height), mix(0.055f, 0.20f, height));
}
vec3 grass_albedo(float x, float z) {
float wide = value_noise(x * 0.13f, z * 0.13f, 1.0f, 2097152u);
float middle = value_noise(x * 0.9f, z * 0.9f, 2.0f, 2097152u);
float fine = value_noise(x * 9.0f, z * 9.0f, 5.0f, 2097152u);
float straw = clamp(wide * 1.3f - 0.35f + 0.3f * middle, 0.0f, 1.0f);
float shade = 0.55f + 0.55f * fine + 0.25f * middle;
return vec3(mix(0.075f, 0.17f, straw) * shade, mix(0.105f, 0.155f, straw) * shade,
mix(0.030f, 0.065f, straw) * shade);
}
float haze(float distance) {
return 1.0f - exp_shared(-min(distance, 30000.0f) * (1.0f / 2500.0f));
}
float srgb_encode(float x) {
float c = clamp(x, 0.0f, 1.0f);
return c <= 0.0031308f ? 12.92f * c : 1.055f * pow(c, 0.41666667f) - 0.055f;
}
float display(float x) {
return srgb_encode(x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f));
}
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
vec3 cloud_texel(light_grid grid, vec3 voxels, vec3 place) {
vec3 cells = cells_of(grid, place);
return vec3(cells.x / voxels.x, cells.y / voxels.y, cells.z / voxels.z);
}
float cloud_light(float attenuation) {
return attenuation < 0.0f ? 1.0f / exp_minus(min(-attenuation, 60.0f)) : exp_minus(attenuation);
}
float country_noise(float x, float z, float size, float layer, float distance) {
float seen = clamp(2.0f - distance / (300.0f * size), 0.0f, 1.0f);
if (seen == 0.0f) {
return 0.5f;
}
float noise = value_noise(x / size, z / size, layer, 2097152u);
return 0.5f + (noise - 0.5f) * seen;
}
vec3 country_albedo(float x, float z, float distance) {
float wood = country_noise(x, z, 900.0f, 1.0f, distance) * 0.6f + country_noise(x, z, 240.0f, 2.0f, distance) * 0.4f;
float field = country_noise(x + 0.6f * z, z - 0.6f * x, 170.0f, 3.0f, distance);
float fine = country_noise(x, z, 22.0f, 4.0f, distance);
float grain = country_noise(x, z, 3.5f, 5.0f, distance);
float trees = clamp((wood - 0.5f) * 7.0f + (fine - 0.5f) * 1.5f, 0.0f, 1.0f);
float straw = clamp((field - 0.45f) * 3.0f, 0.0f, 1.0f);
float shade = 0.5f + 0.5f * fine + 0.5f * grain;
return vec3(mix(mix(0.095f, 0.190f, straw), 0.036f, trees) * shade,
mix(mix(0.125f, 0.165f, straw), 0.052f, trees) * shade,
mix(0.042f + 0.03f * straw, 0.024f, trees) * shade);
}
struct scene_record {
mat4 to_clip;
mat4 from_clip;
mat4 to_shadow;
vec4 camera;
vec4 shadow;
daylight_sky sky;
vec4 ambient[4];
};
#ifdef SKYBARK_FRAGMENT_STAGE
#ifdef KERNEL_IMAGES
float sun_at(scene_record scene, vec3 position, vec3 normal) {
vec3 raised = position + normal * (scene.shadow.x * scene.shadow.z);
vec4 p = scene.to_shadow * vec4(raised, 1.0);
vec2 texel = vec2(p.x * 0.5 + 0.5, 0.5 - p.y * 0.5) / scene.shadow.y - 0.5;
ivec2 size = textureSize(kernel_images[0], 0);
vec2 corner = floor(texel);
vec2 part = texel - corner;
float lit_texels = 0.0;
for (int y = -1; y <= 2; ++y) {
for (int x = -1; x <= 2; ++x) {
ivec2 at = ivec2(corner) + ivec2(x, y);
float wx = x == -1 ? 1.0 - part.x : (x == 2 ? part.x : 1.0);
float wy = y == -1 ? 1.0 - part.y : (y == 2 ? part.y : 1.0);
bool inside = at.x >= 0 && at.y >= 0 && at.x < size.x && at.y < size.y;
float depth = inside ? texelFetch(kernel_images[0], at, 0).r : 1.0;
lit_texels += min(p.z, 1.0) <= depth ? wx * wy : 0.0;
}
}
return lit_texels / 9.0;
}
#endif
#endif
layout(std430, binding = 0) readonly buffer scene_buffer { scene_record scene; };
#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
uint corner = index < 3u ? index : (index == 3u ? 2u : (index == 4u ? 1u : 3u));
vec3 p = vec3(scene.camera.x + ((corner & 1u) != 0u ? extent : -extent), height,
scene.camera.z + ((corner & 2u) != 0u ? -extent : extent));
varying_out[0] = vec4(p, 0.0);
return scene.to_clip * vec4(p, 1.0);
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
vec3 p = varying_in[0].xyz;
float sun = 1.0;
if (shadow > 0.0) {
vec3 at = cloud_texel(grid, vec3(textureSize(kernel_volumes[0], 0)), p);
sun = cloud_light(textureLod(kernel_volumes[0], at, 0.0).x);
}
vec3 up = vec3(0.0, 1.0, 0.0);
vec3 ambient = ambient_light(scene.ambient[0], scene.ambient[1], scene.ambient[2],
scene.ambient[3], up);
vec3 away = p - scene.camera.xyz;
float far = length(away);
vec3 light = lit(country_albedo(p.x, p.z, far), up, scene.sky, sun, ambient);
vec3 before = sky_radiance(scene.sky, away * (1.0 / far));
color_out = vec4(mix(light, before, one_minus_exp(air * far)), 1.0);
return true;
}
#endif
void main() { gl_Position = kernel_vertex(uint(SKYBARK_VERTEX_INDEX)); }
)glsl", 15205};
    static constexpr std::string_view draw_frag{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_FRAGMENT_STAGE
#define KERNEL_VARYINGS 1
#define KERNEL_VOLUMES 1
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
#define KERNEL_PARAMETERS light_grid grid; float height; float extent; float air; float shadow;
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
struct daylight_sky {
vec4 a;
vec4 b;
vec4 c;
vec4 d;
vec4 e;
vec4 zenith;
vec4 to_sun;
vec4 sunlight;
};
float exp_shared(float x) {
float s = x * (1.0f / 64.0f);
float p = 1.0f + s * (1.0f + s * (0.5f + s * (0.16666667f + s * (0.041666667f + s * 0.0083333333f))));
p = p * p;
p = p * p;
p = p * p;
p = p * p;
p = p * p;
return p * p;
}
float arccos_shared(float x) {
float c = clamp(x, -1.0f, 1.0f);
return atan(sqrt((1.0f - c) * (1.0f + c)), c);
}
float perez(float a, float b, float c, float d, float e, float cos_zenith, float gamma) {
float cos_gamma = cos(gamma);
return (1.0f + a * exp_shared(b / cos_zenith)) *
(1.0f + c * exp_shared(d * gamma) + e * cos_gamma * cos_gamma);
}
vec3 srgb_from_xyY(float luminance, float x, float y) {
float X = luminance * x / y;
float Z = luminance * (1.0f - x - y) / y;
return vec3(3.2406f * X - 1.5372f * luminance - 0.4986f * Z,
-0.9689f * X + 1.8758f * luminance + 0.0415f * Z,
0.0557f * X - 0.2040f * luminance + 1.0570f * Z);
}
vec3 sky_radiance(daylight_sky sky, vec3 to) {
float up = max(to.y, 0.01f);
float flat_length = sqrt(max(1.0f - up * up, 0.0f) /
max(to.x * to.x + to.z * to.z, 1e-12f));
float cos_gamma = to.x * flat_length * sky.to_sun.x + up * sky.to_sun.y +
to.z * flat_length * sky.to_sun.z;
float gamma = arccos_shared(cos_gamma);
float luminance = sky.zenith.x * perez(sky.a.x, sky.b.x, sky.c.x, sky.d.x, sky.e.x, up, gamma);
float x = sky.zenith.y * perez(sky.a.y, sky.b.y, sky.c.y, sky.d.y, sky.e.y, up, gamma);
float y = sky.zenith.z * perez(sky.a.z, sky.b.z, sky.c.z, sky.d.z, sky.e.z, up, gamma);
vec3 rgb = srgb_from_xyY(luminance, x, y);
return vec3(max(rgb.x, 0.0f), max(rgb.y, 0.0f), max(rgb.z, 0.0f));
}
float hash_unit(uint x, uint y, uint z) {
uint h = x * 73856093u ^ y * 19349663u ^ z * 83492791u;
h = h ^ (h >> 16u);
h = h * 2246822519u;
h = h ^ (h >> 13u);
h = h * 3266489917u;
h = h ^ (h >> 16u);
return float(h >> 8u) * (1.0f / 16777216.0f);
}
float value_noise(float x, float y, float z, uint period) {
float fx = floor(x);
float fy = floor(y);
float fz = floor(z);
float tx = x - fx;
float ty = y - fy;
float tz = z - fz;
tx = tx * tx * (3.0f - 2.0f * tx);
ty = ty * ty * (3.0f - 2.0f * ty);
tz = tz * tz * (3.0f - 2.0f * tz);
uint x0 = uint(int(fx) + 1048576) % period;
uint x1 = (x0 + 1u) % period;
uint y0 = uint(int(fy) + 1048576);
uint z0 = uint(int(fz) + 1048576);
float n00 = mix(hash_unit(x0, y0, z0), hash_unit(x1, y0, z0), tx);
float n10 = mix(hash_unit(x0, y0 + 1u, z0), hash_unit(x1, y0 + 1u, z0), tx);
float n01 = mix(hash_unit(x0, y0, z0 + 1u), hash_unit(x1, y0, z0 + 1u), tx);
float n11 = mix(hash_unit(x0, y0 + 1u, z0 + 1u), hash_unit(x1, y0 + 1u, z0 + 1u), tx);
return mix(mix(n00, n10, ty), mix(n01, n11, ty), tz);
}
vec3 ambient_light(vec4 h0, vec4 h1, vec4 h2, vec4 h3, vec3 n) {
return vec3(max(h0.x + h1.x * n.x + h2.x * n.y + h3.x * n.z, 0.0f),
max(h0.y + h1.y * n.x + h2.y * n.y + h3.y * n.z, 0.0f),
max(h0.z + h1.z * n.x + h2.z * n.y + h3.z * n.z, 0.0f));
}
vec3 lit(vec3 albedo, vec3 n, daylight_sky sky, float sun, vec3 ambient) {
float facing = max(n.x * sky.to_sun.x + n.y * sky.to_sun.y + n.z * sky.to_sun.z, 0.0f) * sun;
return vec3(albedo.x * (ambient.x + sky.sunlight.x * facing),
albedo.y * (ambient.y + sky.sunlight.y * facing),
albedo.z * (ambient.z + sky.sunlight.z * facing));
}
float bark_height(float u, float v, uint cells) {
float around = u * float(cells);
float warp = value_noise(around * 0.5f, v * 3.0f, 7.0f, max(cells / 2u, 1u));
float furrow = value_noise(around + 2.0f * warp, v * 6.0f, 0.0f, cells);
float fine = value_noise(around * 3.0f, v * 24.0f, 3.0f, cells * 3u);
return 0.7f * furrow + 0.3f * fine;
}
vec3 bark_albedo(float height) {
return vec3(mix(0.10f, 0.34f, height), mix(0.075f, 0.27f, height), mix(0.055f, 0.20f, height));
}
vec3 grass_albedo(float x, float z) {
float wide = value_noise(x * 0.13f, z * 0.13f, 1.0f, 2097152u);
float middle = value_noise(x * 0.9f, z * 0.9f, 2.0f, 2097152u);
float fine = value_noise(x * 9.0f, z * 9.0f, 5.0f, 2097152u);
float straw = clamp(wide * 1.3f - 0.35f + 0.3f * middle, 0.0f, 1.0f);
float shade = 0.55f + 0.55f * fine + 0.25f * middle;
return vec3(mix(0.075f, 0.17f, straw) * shade, mix(0.105f, 0.155f, straw) * shade,
mix(0.030f, 0.065f, straw) * shade);
}
float haze(float distance) {
return 1.0f - exp_shared(-min(distance, 30000.0f) * (1.0f / 2500.0f));
}
float srgb_encode(float x) {
float c = clamp(x, 0.0f, 1.0f);
return c <= 0.0031308f ? 12.92f * c : 1.055f * pow(c, 0.41666667f) - 0.055f;
}
float display(float x) {
return srgb_encode(x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f));
}
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
vec3 cloud_texel(light_grid grid, vec3 voxels, vec3 place) {
vec3 cells = cells_of(grid, place);
return vec3(cells.x / voxels.x, cells.y / voxels.y, cells.z / voxels.z);
}
float cloud_light(float attenuation) {
return attenuation < 0.0f ? 1.0f / exp_minus(min(-attenuation, 60.0f)) : exp_minus(attenuation);
}
float country_noise(float x, float z, float size, float layer, float distance) {
float seen = clamp(2.0f - distance / (300.0f * size), 0.0f, 1.0f);
if (seen == 0.0f) {
return 0.5f;
}
float noise = value_noise(x / size, z / size, layer, 2097152u);
return 0.5f + (noise - 0.5f) * seen;
}
vec3 country_albedo(float x, float z, float distance) {
float wood = country_noise(x, z, 900.0f, 1.0f, distance) * 0.6f + country_noise(x, z, 240.0f, 2.0f, distance) * 0.4f;
float field = country_noise(x + 0.6f * z, z - 0.6f * x, 170.0f, 3.0f, distance);
float fine = country_noise(x, z, 22.0f, 4.0f, distance);
float grain = country_noise(x, z, 3.5f, 5.0f, distance);
float trees = clamp((wood - 0.5f) * 7.0f + (fine - 0.5f) * 1.5f, 0.0f, 1.0f);
float straw = clamp((field - 0.45f) * 3.0f, 0.0f, 1.0f);
float shade = 0.5f + 0.5f * fine + 0.5f * grain;
return vec3(mix(mix(0.095f, 0.190f, straw), 0.036f, trees) * shade,
mix(mix(0.125f, 0.165f, straw), 0.052f, trees) * shade,
mix(0.042f + 0.03f * straw, 0.024f, trees) * shade);
}
struct scene_record {
mat4 to_clip;
mat4 from_clip;
mat4 to_shadow;
vec4 camera;
vec4 shadow;
daylight_sky sky;
vec4 ambient[4];
};
#ifdef SKYBARK_FRAGMENT_STAGE
#ifdef KERNEL_IMAGES
float sun_at(scene_record scene, vec3 position, vec3 normal) {
vec3 raised = position + normal * (scene.shadow.x * scene.shadow.z);
vec4 p = scene.to_shadow * vec4(raised, 1.0);
vec2 texel = vec2(p.x * 0.5 + 0.5, 0.5 - p.y * 0.5) / scene.shadow.y - 0.5;
ivec2 size = textureSize(kernel_images[0], 0);
vec2 corner = floor(texel);
vec2 part = texel - corner;
float lit_texels = 0.0;
for (int y = -1; y <= 2; ++y) {
for (int x = -1; x <= 2; ++x) {
ivec2 at = ivec2(corner) + ivec2(x, y);
float wx = x == -1 ? 1.0 - part.x : (x == 2 ? part.x : 1.0);
float wy = y == -1 ? 1.0 - part.y : (y == 2 ? part.y : 1.0);
bool inside = at.x >= 0 && at.y >= 0 && at.x < size.x && at.y < size.y;
float depth = inside ? texelFetch(kernel_images[0], at, 0).r : 1.0;
lit_texels += min(p.z, 1.0) <= depth ? wx * wy : 0.0;
}
}
return lit_texels / 9.0;
}
#endif
#endif
layout(std430, binding = 0) readonly buffer scene_buffer { scene_record scene; };
#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
uint corner = index < 3u ? index : (index == 3u ? 2u : (index == 4u ? 1u : 3u));
vec3 p = vec3(scene.camera.x + ((corner & 1u) != 0u ? extent : -extent), height,
scene.camera.z + ((corner & 2u) != 0u ? -extent : extent));
varying_out[0] = vec4(p, 0.0);
return scene.to_clip * vec4(p, 1.0);
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
vec3 p = varying_in[0].xyz;
float sun = 1.0;
if (shadow > 0.0) {
vec3 at = cloud_texel(grid, vec3(textureSize(kernel_volumes[0], 0)), p);
sun = cloud_light(textureLod(kernel_volumes[0], at, 0.0).x);
}
vec3 up = vec3(0.0, 1.0, 0.0);
vec3 ambient = ambient_light(scene.ambient[0], scene.ambient[1], scene.ambient[2],
scene.ambient[3], up);
vec3 away = p - scene.camera.xyz;
float far = length(away);
vec3 light = lit(country_albedo(p.x, p.z, far), up, scene.sky, sun, ambient);
vec3 before = sky_radiance(scene.sky, away * (1.0 / far));
color_out = vec4(mix(light, before, one_minus_exp(air * far)), 1.0);
return true;
}
#endif
void main() {
if (!kernel_fragment(gl_FragCoord.xy, gl_FrontFacing)) {
discard;
}
}
)glsl", 15218};
};

} // namespace skybark::opengl
