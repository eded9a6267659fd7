// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 3634370efafda11ae2e5b5eec9c29a450ca2ab65ffc9c563f0c189ab5a33a4f1
#pragma once

#include <skybark/kernels/meadow_leaf.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::meadow_leaf> {
    static constexpr std::string_view draw_vert{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_VERTEX_STAGE
#define KERNEL_VARYINGS 2
#define KERNEL_IMAGES 2
#define KERNEL_VOLUMES 2
#define KERNEL_PARAMETERS float through;
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
struct irradiance_grid {
vec4 low;
vec4 per_step;
vec4 points;
};
vec3 irradiance_texel(irradiance_grid grid, vec3 place, float coefficient)
{
const float apart = 0.001953125f;
float x = clamp((place.x - grid.low.x) * grid.per_step.x, 0.0f, grid.points.x - 1.0f);
float y = clamp((place.y - grid.low.y) * grid.per_step.y, apart, grid.points.y - 1.0f - apart);
float z = clamp((place.z - grid.low.z) * grid.per_step.z, 0.0f, grid.points.z - 1.0f);
return vec3((x + 0.5f) / grid.points.x,
(coefficient * grid.points.y + y + 0.5f) / (12.0f * grid.points.y),
(z + 0.5f) / grid.points.z);
}
float irradiance_of_color(vec4 c, vec3 normal)
{
return 0.886227f * c.x + 1.023327f * ((c.y * normal.y + c.z * normal.z) + c.w * normal.x);
}
vec3 irradiance_of(vec4 red, vec4 green, vec4 blue, vec3 normal)
{
return vec3(max(irradiance_of_color(red, normal), 0.0f),
max(irradiance_of_color(green, normal), 0.0f),
max(irradiance_of_color(blue, normal), 0.0f));
}
struct surroundings_record {
light_grid clouds;
irradiance_grid gathered;
float cloud_shadow;
float air;
float reserved0;
float reserved1;
};
float meadow_cloud_light(surroundings_record around, float attenuation) {
return mix(1.0f, cloud_light(attenuation), around.cloud_shadow);
}
vec3 meadow_lit(vec3 albedo, vec3 n, daylight_sky sky, float sun, vec3 irradiance) {
return lit(albedo, n, sky, sun, irradiance * 0.318309886f);
}
vec3 meadow_through_air(surroundings_record around, daylight_sky sky, vec3 light, vec3 away) {
float distance = sqrt(away.x * away.x + away.y * away.y + away.z * away.z);
vec3 air = sky_radiance(sky, away * (1.0f / max(distance, 1e-6f)));
return mix(light, air, one_minus_exp(around.air * distance));
}
vec3 meadow_albedo(float x, float z, float distance) {
float t = clamp((distance - 60.0f) * (1.0f / 340.0f), 0.0f, 1.0f);
float distant = t * t * (3.0f - 2.0f * t);
if (distant == 0.0f) {
return grass_albedo(x, z);
}
vec3 country = country_albedo(x, z, distance);
return distant == 1.0f ? country : mix(grass_albedo(x, z), country, distant);
}
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
struct bark_surface {
vec3 albedo;
vec3 normal;
};
float surfaces_dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
bark_surface bark_surface_of(vec4 texel, vec3 geometric, vec4 tangent, vec3 low, vec3 high,
float strength) {
bark_surface s;
s.albedo = mix(low, high, texel.w);
vec3 along = vec3(tangent.x, tangent.y, tangent.z);
vec3 across = along - geometric * surfaces_dot(geometric, along);
vec3 t = across * (1.0f / sqrt(max(surfaces_dot(across, across), 1e-12f)));
vec3 b = vec3(geometric.y * t.z - geometric.z * t.y, geometric.z * t.x - geometric.x * t.z,
geometric.x * t.y - geometric.y * t.x) * tangent.w;
float slope = strength * min(abs(tangent.w), 1.0f);
vec3 n = geometric * (texel.z * 2.0f - 1.0f) + t * ((texel.x * 2.0f - 1.0f) * slope) +
b * ((texel.y * 2.0f - 1.0f) * slope);
s.normal = n * (1.0f / sqrt(surfaces_dot(n, n)));
return s;
}
struct leaf_surface {
vec3 reflected;
vec3 through;
};
leaf_surface leaf_surface_of(vec4 texel, float through) {
leaf_surface s;
s.reflected = vec3(leaf_linear(texel.x), leaf_linear(texel.y), leaf_linear(texel.z));
s.through = s.reflected * vec3(1.1f, 1.0f, 0.3f) * through;
return s;
}
vec3 leaf_surface_lit(leaf_surface s, vec3 sunlight, float facing, vec3 here, vec3 behind) {
return vec3(leaf_lit(s.reflected.x, s.through.x, sunlight.x, facing, here.x, behind.x),
leaf_lit(s.reflected.y, s.through.y, sunlight.y, facing, here.y, behind.y),
leaf_lit(s.reflected.z, s.through.z, sunlight.z, facing, here.z, behind.z));
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
layout(std430, binding = 0) readonly buffer vertices_buffer { vec4 vertices[]; };
layout(std430, binding = 1) readonly buffer scene_buffer { scene_record scene; };
layout(std430, binding = 2) readonly buffer around_buffer { surroundings_record around; };
#ifdef SKYBARK_FRAGMENT_STAGE
float sun_behind_clouds(vec3 place) {
if (!(around.cloud_shadow > 0.0)) {
return 1.0;
}
vec3 at = cloud_texel(around.clouds, vec3(textureSize(kernel_volumes[0], 0)), place);
return meadow_cloud_light(around, textureLod(kernel_volumes[0], at, 0.0).x);
}
#if KERNEL_VOLUMES > 1
struct gathered_around {
vec4 red;
vec4 green;
vec4 blue;
};
float gathered_coefficient(vec3 place, float k) {
return textureLod(kernel_volumes[1], irradiance_texel(around.gathered, place, k), 0.0).x;
}
vec4 gathered_color(vec3 place, float first) {
return vec4(gathered_coefficient(place, first), gathered_coefficient(place, first + 1.0),
gathered_coefficient(place, first + 2.0), gathered_coefficient(place, first + 3.0));
}
gathered_around gathered_at(vec3 place) {
return gathered_around(gathered_color(place, 0.0), gathered_color(place, 4.0),
gathered_color(place, 8.0));
}
vec3 gathered_irradiance(gathered_around light, vec3 normal) {
return irradiance_of(light.red, light.green, light.blue, normal);
}
#endif
#endif
#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
varying_out[0] = vertices[3u * index];
varying_out[1] = vertices[3u * index + 1u];
return scene.to_clip * vec4(varying_out[0].xyz, 1.0);
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
vec4 texel = textureLod(kernel_images[1], vec2(varying_in[0].w, varying_in[1].w), 0.0);
if (texel.w < 0.5) {
return false;
}
vec3 position = varying_in[0].xyz;
vec3 upper = normalize(varying_in[1].xyz);
vec3 n = front ? upper : -upper;
float facing = dot(n, scene.sky.to_sun.xyz);
float sun = sun_at(scene, position, facing > 0.0 ? n : -n) * sun_behind_clouds(position);
gathered_around gathered = gathered_at(position);
const float over_pi = 0.318309886;
vec3 light = leaf_surface_lit(leaf_surface_of(texel, through), scene.sky.sunlight.xyz * sun,
facing, gathered_irradiance(gathered, n) * over_pi,
gathered_irradiance(gathered, -n) * over_pi);
vec3 away = position - scene.camera.xyz;
color_out = vec4(meadow_through_air(around, scene.sky, light, away), 1.0);
return true;
}
#endif
void main() { gl_Position = kernel_vertex(uint(SKYBARK_VERTEX_INDEX)); }
)glsl", 28259};
    static constexpr std::string_view draw_frag{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_FRAGMENT_STAGE
#define KERNEL_VARYINGS 2
#define KERNEL_IMAGES 2
#define KERNEL_VOLUMES 2
#define KERNEL_PARAMETERS float through;
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
struct irradiance_grid {
vec4 low;
vec4 per_step;
vec4 points;
};
vec3 irradiance_texel(irradiance_grid grid, vec3 place, float coefficient)
{
const float apart = 0.001953125f;
float x = clamp((place.x - grid.low.x) * grid.per_step.x, 0.0f, grid.points.x - 1.0f);
float y = clamp((place.y - grid.low.y) * grid.per_step.y, apart, grid.points.y - 1.0f - apart);
float z = clamp((place.z - grid.low.z) * grid.per_step.z, 0.0f, grid.points.z - 1.0f);
return vec3((x + 0.5f) / grid.points.x,
(coefficient * grid.points.y + y + 0.5f) / (12.0f * grid.points.y),
(z + 0.5f) / grid.points.z);
}
float irradiance_of_color(vec4 c, vec3 normal)
{
return 0.886227f * c.x + 1.023327f * ((c.y * normal.y + c.z * normal.z) + c.w * normal.x);
}
vec3 irradiance_of(vec4 red, vec4 green, vec4 blue, vec3 normal)
{
return vec3(max(irradiance_of_color(red, normal), 0.0f),
max(irradiance_of_color(green, normal), 0.0f),
max(irradiance_of_color(blue, normal), 0.0f));
}
struct surroundings_record {
light_grid clouds;
irradiance_grid gathered;
float cloud_shadow;
float air;
float reserved0;
float reserved1;
};
float meadow_cloud_light(surroundings_record around, float attenuation) {
return mix(1.0f, cloud_light(attenuation), around.cloud_shadow);
}
vec3 meadow_lit(vec3 albedo, vec3 n, daylight_sky sky, float sun, vec3 irradiance) {
return lit(albedo, n, sky, sun, irradiance * 0.318309886f);
}
vec3 meadow_through_air(surroundings_record around, daylight_sky sky, vec3 light, vec3 away) {
float distance = sqrt(away.x * away.x + away.y * away.y + away.z * away.z);
vec3 air = sky_radiance(sky, away * (1.0f / max(distance, 1e-6f)));
return mix(light, air, one_minus_exp(around.air * distance));
}
vec3 meadow_albedo(float x, float z, float distance) {
float t = clamp((distance - 60.0f) * (1.0f / 340.0f), 0.0f, 1.0f);
float distant = t * t * (3.0f - 2.0f * t);
if (distant == 0.0f) {
return grass_albedo(x, z);
}
vec3 country = country_albedo(x, z, distance);
return distant == 1.0f ? country : mix(grass_albedo(x, z), country, distant);
}
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
struct bark_surface {
vec3 albedo;
vec3 normal;
};
float surfaces_dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
bark_surface bark_surface_of(vec4 texel, vec3 geometric, vec4 tangent, vec3 low, vec3 high,
float strength) {
bark_surface s;
s.albedo = mix(low, high, texel.w);
vec3 along = vec3(tangent.x, tangent.y, tangent.z);
vec3 across = along - geometric * surfaces_dot(geometric, along);
vec3 t = across * (1.0f / sqrt(max(surfaces_dot(across, across), 1e-12f)));
vec3 b = vec3(geometric.y * t.z - geometric.z * t.y, geometric.z * t.x - geometric.x * t.z,
geometric.x * t.y - geometric.y * t.x) * tangent.w;
float slope = strength * min(abs(tangent.w), 1.0f);
vec3 n = geometric * (texel.z * 2.0f - 1.0f) + t * ((texel.x * 2.0f - 1.0f) * slope) +
b * ((texel.y * 2.0f - 1.0f) * slope);
s.normal = n * (1.0f / sqrt(surfaces_dot(n, n)));
return s;
}
struct leaf_surface {
vec3 reflected;
vec3 through;
};
leaf_surface leaf_surface_of(vec4 texel, float through) {
leaf_surface s;
s.reflected = vec3(leaf_linear(texel.x), leaf_linear(texel.y), leaf_linear(texel.z));
s.through = s.reflected * vec3(1.1f, 1.0f, 0.3f) * through;
return s;
}
vec3 leaf_surface_lit(leaf_surface s, vec3 sunlight, float facing, vec3 here, vec3 behind) {
return vec3(leaf_lit(s.reflected.x, s.through.x, sunlight.x, facing, here.x, behind.x),
leaf_lit(s.reflected.y, s.through.y, sunlight.y, facing, here.y, behind.y),
leaf_lit(s.reflected.z, s.through.z, sunlight.z, facing, here.z, behind.z));
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
layout(std430, binding = 0) readonly buffer vertices_buffer { vec4 vertices[]; };
layout(std430, binding = 1) readonly buffer scene_buffer { scene_record scene; };
layout(std430, binding = 2) readonly buffer around_buffer { surroundings_record around; };
#ifdef SKYBARK_FRAGMENT_STAGE
float sun_behind_clouds(vec3 place) {
if (!(around.cloud_shadow > 0.0)) {
return 1.0;
}
vec3 at = cloud_texel(around.clouds, vec3(textureSize(kernel_volumes[0], 0)), place);
return meadow_cloud_light(around, textureLod(kernel_volumes[0], at, 0.0).x);
}
#if KERNEL_VOLUMES > 1
struct gathered_around {
vec4 red;
vec4 green;
vec4 blue;
};
float gathered_coefficient(vec3 place, float k) {
return textureLod(kernel_volumes[1], irradiance_texel(around.gathered, place, k), 0.0).x;
}
vec4 gathered_color(vec3 place, float first) {
return vec4(gathered_coefficient(place, first), gathered_coefficient(place, first + 1.0),
gathered_coefficient(place, first + 2.0), gathered_coefficient(place, first + 3.0));
}
gathered_around gathered_at(vec3 place) {
return gathered_around(gathered_color(place, 0.0), gathered_color(place, 4.0),
gathered_color(place, 8.0));
}
vec3 gathered_irradiance(gathered_around light, vec3 normal) {
return irradiance_of(light.red, light.green, light.blue, normal);
}
#endif
#endif
#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
varying_out[0] = vertices[3u * index];
varying_out[1] = vertices[3u * index + 1u];
return scene.to_clip * vec4(varying_out[0].xyz, 1.0);
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
vec4 texel = textureLod(kernel_images[1], vec2(varying_in[0].w, varying_in[1].w), 0.0);
if (texel.w < 0.5) {
return false;
}
vec3 position = varying_in[0].xyz;
vec3 upper = normalize(varying_in[1].xyz);
vec3 n = front ? upper : -upper;
float facing = dot(n, scene.sky.to_sun.xyz);
float sun = sun_at(scene, position, facing > 0.0 ? n : -n) * sun_behind_clouds(position);
gathered_around gathered = gathered_at(position);
const float over_pi = 0.318309886;
vec3 light = leaf_surface_lit(leaf_surface_of(texel, through), scene.sky.sunlight.xyz * sun,
facing, gathered_irradiance(gathered, n) * over_pi,
gathered_irradiance(gathered, -n) * over_pi);
vec3 away = position - scene.camera.xyz;
color_out = vec4(meadow_through_air(around, scene.sky, light, away), 1.0);
return true;
}
#endif
void main() {
if (!kernel_fragment(gl_FragCoord.xy, gl_FrontFacing)) {
discard;
}
}
)glsl", 28272};
};

} // namespace skybark::opengl
