// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 fb1a32c2fafe8f388d81b3f694915ea15c0b085c5dce4ff2e12c0d0194c0a0e5
#pragma once

#include <skybark/kernels/particle_fingerprint.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::particle_fingerprint> {
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
struct puff_radiance {
vec4 middle;
vec4 right;
vec4 up;
vec4 air;
};
vec3 puff_right(vec3 ahead) {
bool steep = ahead.y * ahead.y > 0.98f;
float x = steep ? 0.0f : -ahead.z;
float y = steep ? ahead.z : 0.0f;
float z = steep ? -ahead.y : ahead.x;
float over = 1.0f / sqrt(x * x + y * y + z * z);
return vec3(x * over, y * over, z * over);
}
struct puff_corner {
vec3 offset;
float over;
};
puff_corner puff_silhouette(vec3 centre, float radius, float x, float y) {
float away2 = centre.x * centre.x + centre.y * centre.y + centre.z * centre.z;
float away = sqrt(away2);
puff_corner corner;
corner.over = away / sqrt(away2 - radius * radius);
vec3 ahead = centre * (1.0f / away);
vec3 right = puff_right(ahead);
vec3 up = vec3(right.y * ahead.z - right.z * ahead.y, right.z * ahead.x - right.x * ahead.z,
right.x * ahead.y - right.y * ahead.x);
float u = x * corner.over * radius;
float v = y * corner.over * radius;
corner.offset = right * u + up * v;
return corner;
}
uint puff_corner_of(uint index) {
uint k = index % 6u;
return k < 3u ? k : (k == 3u ? 2u : (k == 4u ? 1u : 3u));
}
bool puff_finite(float x) { return (floatBitsToInt(x) & 2147483647) < 2139095040; }
bool puff_drawn(float optical_depth, float radius, float albedo, float away2) {
return puff_finite(optical_depth) && puff_finite(radius) && puff_finite(albedo) &&
puff_finite(away2) && optical_depth > 0.0f && radius > 0.0f;
}
uint puff_mixed(uint hash, float value) {
uint h = (hash ^ uint(floatBitsToInt(value))) * 2246822519u;
return h ^ (h >> 15u);
}
uint puff_fingerprint(vec3 position, float radius, float optical_depth, float albedo) {
uint h = puff_mixed(2654435769u, position.x);
h = puff_mixed(h, position.y);
h = puff_mixed(h, position.z);
h = puff_mixed(h, radius);
h = puff_mixed(h, optical_depth);
return puff_mixed(h, albedo);
}
float puff_noise(vec3 place, float over) {
float coarse = value_noise(place.x * over, place.y * over, place.z * over, 16384u);
float twice = 2.17f * over;
float fine = value_noise(place.x * twice, place.y * twice, place.z * twice, 16384u);
return 0.62f * coarse + 0.38f * fine;
}
float puff_torn(float body, float noise, float torn) {
float cut = torn * noise;
return max(body - cut, 0.0f) / (1.0f - cut);
}
layout(std430, binding = 0) readonly buffer particles_buffer { vec4 particles[]; };
layout(std430, binding = 1) writeonly buffer keys_buffer { uint keys[]; };
layout(std430, binding = 2) writeonly buffer order_buffer { uint order[]; };
void kernel_map(uint i) {
vec4 ball = particles[2u * i];
vec4 water = particles[2u * i + 1u];
keys[i] = puff_fingerprint(ball.xyz, ball.w, water.x, water.y);
order[i] = i;
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
)glsl", 6990};
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
struct puff_radiance {
vec4 middle;
vec4 right;
vec4 up;
vec4 air;
};
vec3 puff_right(vec3 ahead) {
bool steep = ahead.y * ahead.y > 0.98f;
float x = steep ? 0.0f : -ahead.z;
float y = steep ? ahead.z : 0.0f;
float z = steep ? -ahead.y : ahead.x;
float over = 1.0f / sqrt(x * x + y * y + z * z);
return vec3(x * over, y * over, z * over);
}
struct puff_corner {
vec3 offset;
float over;
};
puff_corner puff_silhouette(vec3 centre, float radius, float x, float y) {
float away2 = centre.x * centre.x + centre.y * centre.y + centre.z * centre.z;
float away = sqrt(away2);
puff_corner corner;
corner.over = away / sqrt(away2 - radius * radius);
vec3 ahead = centre * (1.0f / away);
vec3 right = puff_right(ahead);
vec3 up = vec3(right.y * ahead.z - right.z * ahead.y, right.z * ahead.x - right.x * ahead.z,
right.x * ahead.y - right.y * ahead.x);
float u = x * corner.over * radius;
float v = y * corner.over * radius;
corner.offset = right * u + up * v;
return corner;
}
uint puff_corner_of(uint index) {
uint k = index % 6u;
return k < 3u ? k : (k == 3u ? 2u : (k == 4u ? 1u : 3u));
}
bool puff_finite(float x) { return (floatBitsToInt(x) & 2147483647) < 2139095040; }
bool puff_drawn(float optical_depth, float radius, float albedo, float away2) {
return puff_finite(optical_depth) && puff_finite(radius) && puff_finite(albedo) &&
puff_finite(away2) && optical_depth > 0.0f && radius > 0.0f;
}
uint puff_mixed(uint hash, float value) {
uint h = (hash ^ uint(floatBitsToInt(value))) * 2246822519u;
return h ^ (h >> 15u);
}
uint puff_fingerprint(vec3 position, float radius, float optical_depth, float albedo) {
uint h = puff_mixed(2654435769u, position.x);
h = puff_mixed(h, position.y);
h = puff_mixed(h, position.z);
h = puff_mixed(h, radius);
h = puff_mixed(h, optical_depth);
return puff_mixed(h, albedo);
}
float puff_noise(vec3 place, float over) {
float coarse = value_noise(place.x * over, place.y * over, place.z * over, 16384u);
float twice = 2.17f * over;
float fine = value_noise(place.x * twice, place.y * twice, place.z * twice, 16384u);
return 0.62f * coarse + 0.38f * fine;
}
float puff_torn(float body, float noise, float torn) {
float cut = torn * noise;
return max(body - cut, 0.0f) / (1.0f - cut);
}
layout(std430, binding = 0) readonly buffer particles_buffer { vec4 particles[]; };
layout(std430, binding = 1) writeonly buffer keys_buffer { uint keys[]; };
layout(std430, binding = 2) writeonly buffer order_buffer { uint order[]; };
void kernel_map(uint i) {
vec4 ball = particles[2u * i];
vec4 water = particles[2u * i + 1u];
keys[i] = puff_fingerprint(ball.xyz, ball.w, water.x, water.y);
order[i] = i;
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
)glsl", 7005};
};

} // namespace skybark::opengl
