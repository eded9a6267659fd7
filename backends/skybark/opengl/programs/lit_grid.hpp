// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 35ac5dcb397d89cfea30358a4b196bca929ad99af4bae7ed3d386d6bb94d17f9
#pragma once

#include <skybark/kernels/lit_grid.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::lit_grid> {
    static constexpr std::string_view draw_vert{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_VERTEX_STAGE
#define KERNEL_VARYINGS 1
#define KERNEL_IMAGES 1
#define KERNEL_VOLUMES 4
#define KERNEL_PARAMETERS vec4 low; vec4 high; float step_length;
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
float phase_henyey_greenstein(float g, float u) {
float a = 1.0f - g;
float s = a * a + 2.0f * g * (1.0f - u);
return 0.079577472f * a * (1.0f + g) / (s * sqrt(s));
}
float phase_draine(float g, float alpha, float u) {
return phase_henyey_greenstein(g, u) * (1.0f + alpha * u * u) /
(1.0f + alpha * (1.0f + 2.0f * g * g) * 0.33333333f);
}
float phase_value(vec4 phase, float u) {
return (1.0f - phase.w) * phase_henyey_greenstein(phase.x, u) +
phase.w * phase_draine(phase.y, phase.z, u);
}
vec4 phase_widened(vec4 phase, float c) {
return vec4(phase.x * c, phase.y * c, phase.z, phase.w);
}
struct cloud_lighting {
light_grid sun_grid;
light_grid sky_grid;
light_grid diffuse_grid;
vec4 phase;
vec4 octaves;
float forward;
float sigmas;
float air;
float sky;
float sky_thickness;
float diffuse;
uint paper_form;
uint by_particle;
uint forward_point;
float torn;
float grain;
uint reserved0;
};
struct scaled_scattering {
float depth;
float single;
float diffuse;
};
scaled_scattering scattering_without(float albedo, float forward) {
float depth = 1.0f - albedo * forward;
scaled_scattering scaled;
scaled.depth = depth;
scaled.single = albedo / depth;
scaled.diffuse = albedo * (1.0f - forward) / depth;
return scaled;
}
uint farther_first(float distance2) {
return 4294967295u - uint(floatBitsToInt(distance2));
}
float puff_depth(float tau, float rho2, float ahead, float radius, float sigmas) {
if (rho2 >= radius * radius) {
return 0.0f;
}
float over = sigmas / radius;
float whole = tau * exp_minus(0.5f * over * over * rho2);
return ahead * over > 5.0f ? whole : whole * gaussian_above(-ahead * over);
}
float puff_front(float tau) {
float t = min(tau, 40.0f);
return 0.22f * t / (1.0f + 0.075f * t);
}
float octaves_scattered(vec4 octaves, vec4 phase, float attenuation, float cosine) {
float sum = 0.0f;
float light = 1.0f;
float depth = attenuation;
float c = 1.0f;
int count = int(octaves.w);
for (int i = 0; i < count; i = i + 1) {
sum = sum + light * cloud_light(depth) * phase_value(phase_widened(phase, c), cosine);
light = light * octaves.x;
depth = depth * octaves.y;
c = c * octaves.z;
}
return sum;
}
vec3 sky_inside(float above, float whole, vec3 from_above, vec3 from_below) {
float all = max(whole, above);
float scale = 0.5f / (1.0f + all);
float down = (1.0f + 2.0f * (all - above)) * scale;
float up = (1.0f + 2.0f * above) * scale;
return vec3(from_above.x * down + from_below.x * up, from_above.y * down + from_below.y * up,
from_above.z * down + from_below.z * up);
}
float air_between(float air, float distance) { return one_minus_exp(air * distance); }
vec4 behind_air(vec3 own, float alpha, float hidden, vec3 air) {
float seen = 1.0f - hidden;
float before = hidden * alpha;
return vec4(own.x * seen + air.x * before, own.y * seen + air.y * before,
own.z * seen + air.z * before, alpha);
}
vec2 ray_in_box(vec3 eye, vec3 direction, vec3 low, vec3 high) {
float first = 0.0f;
float last = 1e30f;
for (int i = 0; i < 3; i = i + 1) {
float d = direction[i];
if (abs(d) < 1e-12f) {
if (eye[i] < low[i] || eye[i] > high[i]) {
return vec2(0.0f, 0.0f);
}
} else {
float a = (low[i] - eye[i]) / d;
float b = (high[i] - eye[i]) / d;
first = max(first, min(a, b));
last = min(last, max(a, b));
}
}
return vec2(first, last);
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
layout(std430, binding = 1) readonly buffer lighting_buffer { cloud_lighting lighting; };
#ifndef SKYBARK_VERTEX_STAGE
float cloud_volume(int n, light_grid grid, vec3 place) {
vec3 at = cloud_texel(grid, vec3(textureSize(kernel_volumes[n], 0)), place);
return textureLod(kernel_volumes[n], at, 0.0).x;
}
vec3 cloud_sky(vec3 place) {
vec3 above = ambient_light(scene.ambient[0], scene.ambient[1], scene.ambient[2],
scene.ambient[3], vec3(0.0, 1.0, 0.0));
vec3 below = ambient_light(scene.ambient[0], scene.ambient[1], scene.ambient[2],
scene.ambient[3], vec3(0.0, -1.0, 0.0));
vec3 at = cloud_texel(lighting.sky_grid, vec3(textureSize(kernel_volumes[1], 0)), place);
float over = lighting.sky_thickness * textureLod(kernel_volumes[1], at, 0.0).x;
float whole =
lighting.sky_thickness * textureLod(kernel_volumes[1], vec3(at.x, 0.0, at.z), 0.0).x;
return sky_inside(over, whole, above, below);
}
vec3 cloud_source(vec3 place, vec3 direction, float given, float single, float diffuse) {
float cosine = dot(direction, scene.sky.to_sun.xyz);
float scattered = given >= 0.0
? given * phase_value(lighting.phase, cosine)
: octaves_scattered(lighting.octaves, lighting.phase,
cloud_volume(0, lighting.sun_grid, place), cosine);
scattered *= single;
if (lighting.diffuse > 0.0) {
scattered += diffuse * lighting.diffuse * cloud_volume(2, lighting.diffuse_grid, place);
}
vec3 light = scene.sky.sunlight.xyz * (3.14159265 * scattered);
return lighting.sky > 0.0 ? light + cloud_sky(place) * (lighting.sky * diffuse) : light;
}
#endif
#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
vec4 p = vec4(index == 1u ? 3.0 : -1.0, index == 2u ? 3.0 : -1.0, 0.0, 1.0);
varying_out[0] = scene.from_clip * vec4(p.xy, 1.0, 1.0);
return p;
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
const float least_light = 1.0 / 2048.0;
float surface(vec2 pixel, float depth) {
vec2 size = vec2(textureSize(kernel_images[0], 0));
vec4 at = scene.from_clip *
vec4(pixel.x / size.x * 2.0 - 1.0, 1.0 - pixel.y / size.y * 2.0, depth, 1.0);
return length(at.xyz * (1.0 / at.w) - scene.camera.xyz);
}
bool kernel_fragment(vec2 pixel, bool front) {
vec3 eye = scene.camera.xyz;
vec3 direction = normalize(varying_in[0].xyz * (1.0 / varying_in[0].w) - eye);
vec2 part = ray_in_box(eye, direction, low.xyz, high.xyz);
float opaque = texelFetch(kernel_images[0], ivec2(pixel), 0).x;
float last = opaque < 1.0 ? min(part.y, surface(pixel, opaque)) : part.y;
if (!(last > part.x)) {
return false;
}
int steps = clamp(int((last - part.x) / step_length) + 1, 1, 512);
float span = (last - part.x) / float(steps);
scaled_scattering scaled = scattering_without(high.w, lighting.forward);
float extinction = low.w * scaled.depth * span;
vec3 over = vec3(1.0) / (high.xyz - low.xyz);
vec3 seen = vec3(0.0);
float through = 1.0;
float air = 0.0;
for (int i = 0; i < steps && through > least_light; ++i) {
float at = part.x + (float(i) + 0.5) * span;
vec3 place = eye + direction * at;
float density = textureLod(kernel_volumes[3], (place - low.xyz) * over, 0.0).x;
if (density > 0.0) {
float alpha = one_minus_exp(extinction * density);
float hidden = air_between(lighting.air, at);
seen += cloud_source(place, direction, -1.0, scaled.single, scaled.diffuse) *
(through * alpha * (1.0 - hidden));
air += through * alpha * hidden;
through *= 1.0 - alpha;
}
}
if (through >= 1.0) {
return false;
}
if (air > 0.0) {
seen += sky_radiance(scene.sky, direction) * air;
}
color_out = vec4(seen, 1.0 - through);
return true;
}
#endif
void main() { gl_Position = kernel_vertex(uint(SKYBARK_VERTEX_INDEX)); }
)glsl", 19845};
    static constexpr std::string_view draw_frag{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_FRAGMENT_STAGE
#define KERNEL_VARYINGS 1
#define KERNEL_IMAGES 1
#define KERNEL_VOLUMES 4
#define KERNEL_PARAMETERS vec4 low; vec4 high; float step_length;
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
float phase_henyey_greenstein(float g, float u) {
float a = 1.0f - g;
float s = a * a + 2.0f * g * (1.0f - u);
return 0.079577472f * a * (1.0f + g) / (s * sqrt(s));
}
float phase_draine(float g, float alpha, float u) {
return phase_henyey_greenstein(g, u) * (1.0f + alpha * u * u) /
(1.0f + alpha * (1.0f + 2.0f * g * g) * 0.33333333f);
}
float phase_value(vec4 phase, float u) {
return (1.0f - phase.w) * phase_henyey_greenstein(phase.x, u) +
phase.w * phase_draine(phase.y, phase.z, u);
}
vec4 phase_widened(vec4 phase, float c) {
return vec4(phase.x * c, phase.y * c, phase.z, phase.w);
}
struct cloud_lighting {
light_grid sun_grid;
light_grid sky_grid;
light_grid diffuse_grid;
vec4 phase;
vec4 octaves;
float forward;
float sigmas;
float air;
float sky;
float sky_thickness;
float diffuse;
uint paper_form;
uint by_particle;
uint forward_point;
float torn;
float grain;
uint reserved0;
};
struct scaled_scattering {
float depth;
float single;
float diffuse;
};
scaled_scattering scattering_without(float albedo, float forward) {
float depth = 1.0f - albedo * forward;
scaled_scattering scaled;
scaled.depth = depth;
scaled.single = albedo / depth;
scaled.diffuse = albedo * (1.0f - forward) / depth;
return scaled;
}
uint farther_first(float distance2) {
return 4294967295u - uint(floatBitsToInt(distance2));
}
float puff_depth(float tau, float rho2, float ahead, float radius, float sigmas) {
if (rho2 >= radius * radius) {
return 0.0f;
}
float over = sigmas / radius;
float whole = tau * exp_minus(0.5f * over * over * rho2);
return ahead * over > 5.0f ? whole : whole * gaussian_above(-ahead * over);
}
float puff_front(float tau) {
float t = min(tau, 40.0f);
return 0.22f * t / (1.0f + 0.075f * t);
}
float octaves_scattered(vec4 octaves, vec4 phase, float attenuation, float cosine) {
float sum = 0.0f;
float light = 1.0f;
float depth = attenuation;
float c = 1.0f;
int count = int(octaves.w);
for (int i = 0; i < count; i = i + 1) {
sum = sum + light * cloud_light(depth) * phase_value(phase_widened(phase, c), cosine);
light = light * octaves.x;
depth = depth * octaves.y;
c = c * octaves.z;
}
return sum;
}
vec3 sky_inside(float above, float whole, vec3 from_above, vec3 from_below) {
float all = max(whole, above);
float scale = 0.5f / (1.0f + all);
float down = (1.0f + 2.0f * (all - above)) * scale;
float up = (1.0f + 2.0f * above) * scale;
return vec3(from_above.x * down + from_below.x * up, from_above.y * down + from_below.y * up,
from_above.z * down + from_below.z * up);
}
float air_between(float air, float distance) { return one_minus_exp(air * distance); }
vec4 behind_air(vec3 own, float alpha, float hidden, vec3 air) {
float seen = 1.0f - hidden;
float before = hidden * alpha;
return vec4(own.x * seen + air.x * before, own.y * seen + air.y * before,
own.z * seen + air.z * before, alpha);
}
vec2 ray_in_box(vec3 eye, vec3 direction, vec3 low, vec3 high) {
float first = 0.0f;
float last = 1e30f;
for (int i = 0; i < 3; i = i + 1) {
float d = direction[i];
if (abs(d) < 1e-12f) {
if (eye[i] < low[i] || eye[i] > high[i]) {
return vec2(0.0f, 0.0f);
}
} else {
float a = (low[i] - eye[i]) / d;
float b = (high[i] - eye[i]) / d;
first = max(first, min(a, b));
last = min(last, max(a, b));
}
}
return vec2(first, last);
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
layout(std430, binding = 1) readonly buffer lighting_buffer { cloud_lighting lighting; };
#ifndef SKYBARK_VERTEX_STAGE
float cloud_volume(int n, light_grid grid, vec3 place) {
vec3 at = cloud_texel(grid, vec3(textureSize(kernel_volumes[n], 0)), place);
return textureLod(kernel_volumes[n], at, 0.0).x;
}
vec3 cloud_sky(vec3 place) {
vec3 above = ambient_light(scene.ambient[0], scene.ambient[1], scene.ambient[2],
scene.ambient[3], vec3(0.0, 1.0, 0.0));
vec3 below = ambient_light(scene.ambient[0], scene.ambient[1], scene.ambient[2],
scene.ambient[3], vec3(0.0, -1.0, 0.0));
vec3 at = cloud_texel(lighting.sky_grid, vec3(textureSize(kernel_volumes[1], 0)), place);
float over = lighting.sky_thickness * textureLod(kernel_volumes[1], at, 0.0).x;
float whole =
lighting.sky_thickness * textureLod(kernel_volumes[1], vec3(at.x, 0.0, at.z), 0.0).x;
return sky_inside(over, whole, above, below);
}
vec3 cloud_source(vec3 place, vec3 direction, float given, float single, float diffuse) {
float cosine = dot(direction, scene.sky.to_sun.xyz);
float scattered = given >= 0.0
? given * phase_value(lighting.phase, cosine)
: octaves_scattered(lighting.octaves, lighting.phase,
cloud_volume(0, lighting.sun_grid, place), cosine);
scattered *= single;
if (lighting.diffuse > 0.0) {
scattered += diffuse * lighting.diffuse * cloud_volume(2, lighting.diffuse_grid, place);
}
vec3 light = scene.sky.sunlight.xyz * (3.14159265 * scattered);
return lighting.sky > 0.0 ? light + cloud_sky(place) * (lighting.sky * diffuse) : light;
}
#endif
#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
vec4 p = vec4(index == 1u ? 3.0 : -1.0, index == 2u ? 3.0 : -1.0, 0.0, 1.0);
varying_out[0] = scene.from_clip * vec4(p.xy, 1.0, 1.0);
return p;
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
const float least_light = 1.0 / 2048.0;
float surface(vec2 pixel, float depth) {
vec2 size = vec2(textureSize(kernel_images[0], 0));
vec4 at = scene.from_clip *
vec4(pixel.x / size.x * 2.0 - 1.0, 1.0 - pixel.y / size.y * 2.0, depth, 1.0);
return length(at.xyz * (1.0 / at.w) - scene.camera.xyz);
}
bool kernel_fragment(vec2 pixel, bool front) {
vec3 eye = scene.camera.xyz;
vec3 direction = normalize(varying_in[0].xyz * (1.0 / varying_in[0].w) - eye);
vec2 part = ray_in_box(eye, direction, low.xyz, high.xyz);
float opaque = texelFetch(kernel_images[0], ivec2(pixel), 0).x;
float last = opaque < 1.0 ? min(part.y, surface(pixel, opaque)) : part.y;
if (!(last > part.x)) {
return false;
}
int steps = clamp(int((last - part.x) / step_length) + 1, 1, 512);
float span = (last - part.x) / float(steps);
scaled_scattering scaled = scattering_without(high.w, lighting.forward);
float extinction = low.w * scaled.depth * span;
vec3 over = vec3(1.0) / (high.xyz - low.xyz);
vec3 seen = vec3(0.0);
float through = 1.0;
float air = 0.0;
for (int i = 0; i < steps && through > least_light; ++i) {
float at = part.x + (float(i) + 0.5) * span;
vec3 place = eye + direction * at;
float density = textureLod(kernel_volumes[3], (place - low.xyz) * over, 0.0).x;
if (density > 0.0) {
float alpha = one_minus_exp(extinction * density);
float hidden = air_between(lighting.air, at);
seen += cloud_source(place, direction, -1.0, scaled.single, scaled.diffuse) *
(through * alpha * (1.0 - hidden));
air += through * alpha * hidden;
through *= 1.0 - alpha;
}
}
if (through >= 1.0) {
return false;
}
if (air > 0.0) {
seen += sky_radiance(scene.sky, direction) * air;
}
color_out = vec4(seen, 1.0 - through);
return true;
}
#endif
void main() {
if (!kernel_fragment(gl_FragCoord.xy, gl_FrontFacing)) {
discard;
}
}
)glsl", 19858};
};

} // namespace skybark::opengl
