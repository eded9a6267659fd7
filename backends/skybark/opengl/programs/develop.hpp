// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 789b8e97acdf7b8b387952456c0e2824e739b105a06c33d8a57f45111317aff0
#pragma once

#include <skybark/kernels/develop.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::develop> {
    static constexpr std::string_view draw_vert{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_VERTEX_STAGE
#define KERNEL_VARYINGS 1
#define KERNEL_IMAGES 1
#define KERNEL_PARAMETERS uint samples; float exposure;
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
float ordered_dither(int x, int y) {
uint down = uint(y);
uint across = uint(x) ^ down;
uint rank = (across & 1u) << 5u | (down & 1u) << 4u | (across & 2u) << 2u |
(down & 2u) << 1u | (across & 4u) >> 1u | (down & 4u) >> 2u;
return (float(rank) + 0.5f) * 0.015625f - 0.5f;
}
#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
varying_out[0] = vec4(0.0);
return vec4(index == 1u ? 3.0 : -1.0, index == 2u ? 3.0 : -1.0, 0.0, 1.0);
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
vec3 sum = vec3(0.0);
ivec2 first = ivec2(pixel) * int(samples);
for (int y = 0; y < int(samples); ++y) {
for (int x = 0; x < int(samples); ++x) {
vec3 c = texelFetch(kernel_images[0], first + ivec2(x, y), 0).rgb * exposure;
sum += vec3(display(c.r), display(c.g), display(c.b));
}
}
float shift = ordered_dither(int(pixel.x), int(pixel.y)) * (1.0 / 255.0);
color_out = vec4(sum / float(samples * samples) + shift, 1.0);
return true;
}
#endif
void main() { gl_Position = kernel_vertex(uint(SKYBARK_VERTEX_INDEX)); }
)glsl", 8629};
    static constexpr std::string_view draw_frag{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_FRAGMENT_STAGE
#define KERNEL_VARYINGS 1
#define KERNEL_IMAGES 1
#define KERNEL_PARAMETERS uint samples; float exposure;
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
float ordered_dither(int x, int y) {
uint down = uint(y);
uint across = uint(x) ^ down;
uint rank = (across & 1u) << 5u | (down & 1u) << 4u | (across & 2u) << 2u |
(down & 2u) << 1u | (across & 4u) >> 1u | (down & 4u) >> 2u;
return (float(rank) + 0.5f) * 0.015625f - 0.5f;
}
#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
varying_out[0] = vec4(0.0);
return vec4(index == 1u ? 3.0 : -1.0, index == 2u ? 3.0 : -1.0, 0.0, 1.0);
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
vec3 sum = vec3(0.0);
ivec2 first = ivec2(pixel) * int(samples);
for (int y = 0; y < int(samples); ++y) {
for (int x = 0; x < int(samples); ++x) {
vec3 c = texelFetch(kernel_images[0], first + ivec2(x, y), 0).rgb * exposure;
sum += vec3(display(c.r), display(c.g), display(c.b));
}
}
float shift = ordered_dither(int(pixel.x), int(pixel.y)) * (1.0 / 255.0);
color_out = vec4(sum / float(samples * samples) + shift, 1.0);
return true;
}
#endif
void main() {
if (!kernel_fragment(gl_FragCoord.xy, gl_FrontFacing)) {
discard;
}
}
)glsl", 8642};
};

} // namespace skybark::opengl
