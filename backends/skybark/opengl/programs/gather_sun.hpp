// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 2da05db050251b578d1b57fbf3e9dcb2fc5a7c8a6ac521224869f06f54908870
#pragma once

#include <skybark/kernels/gather_sun.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::gather_sun> {
    static constexpr std::string_view map_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 64) in;
#define KERNEL_PARAMETERS vec4 direction; vec4 irradiance; uint dimmed;
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
float luminance_of(vec4 light)
{
return (0.2126f * light.x + 0.7152f * light.y) + 0.0722f * light.z;
}
float weight_of_sample(gather_sample at, vec4 direction)
{
precise float along = (at.normal.x * direction.x + at.normal.y * direction.y) +
at.normal.z * direction.z;
float weight = abs(along);
bool usable = weight <= 2.0f && abs(at.position.x) <= 1e30f && abs(at.position.y) <= 1e30f &&
abs(at.position.z) <= 1e30f;
return usable ? weight : 0.0f;
}
vec4 light_sum(vec4 sum, vec4 radiance, float weight)
{
precise float r = sum.x + radiance.x * weight;
precise float g = sum.y + radiance.y * weight;
precise float b = sum.z + radiance.z * weight;
precise float w = sum.w + weight;
return vec4(r, g, b, w);
}
vec4 moment_sum(vec4 sum, float radiance, vec4 direction, float side)
{
precise float mean = sum.x + radiance;
precise float x = sum.y + radiance * (side * direction.x);
precise float y = sum.z + radiance * (side * direction.y);
precise float z = sum.w + radiance * (side * direction.z);
return vec4(mean, x, y, z);
}
vec4 harmonics_of(vec4 moments, float each)
{
precise float mean = each * (0.282094792f * moments.x);
precise float y = each * (0.488602512f * moments.z);
precise float z = each * (0.488602512f * moments.w);
precise float x = each * (0.488602512f * moments.y);
return vec4(mean, y, z, x);
}
vec4 leaving_radiance(gather_material material, vec4 here, vec4 behind)
{
const float over_pi = 0.318309886f;
precise float r = material.emission.x + over_pi * (material.diffuse.x * here.x +
material.transmission.x * behind.x);
precise float g = material.emission.y + over_pi * (material.diffuse.y * here.y +
material.transmission.y * behind.y);
precise float b = material.emission.z + over_pi * (material.diffuse.z * here.z +
material.transmission.z * behind.z);
return vec4(r, g, b, 0.0f);
}
layout(std430, binding = 0) readonly buffer samples_buffer { gather_sample samples[]; };
layout(std430, binding = 1) readonly buffer hits_buffer { gather_hit hits[]; };
layout(std430, binding = 2) readonly buffer arriving_buffer { vec4 arriving[]; };
layout(std430, binding = 3) readonly buffer before_buffer { vec4 before[]; };
layout(std430, binding = 4) writeonly buffer direct_buffer { vec4 direct[]; };
void kernel_map(uint i) {
vec3 n = samples[i].normal;
precise float along = (n.x * direction.x + n.y * direction.y) + n.z * direction.z;
bool lit = along > 0.0 && weight_of_sample(samples[i], direction) > 0.0 &&
hits[i].surface == 0xffffffffu;
float part = dimmed != 0u ? arriving[i].y : 1.0;
precise float light = lit ? along * part : 0.0;
precise vec4 sum = before[i] + irradiance * light;
direct[i] = sum;
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
)glsl", 6024};
    static constexpr std::string_view levels_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define readonly coherent readonly
#define writeonly coherent writeonly
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 256) in;
#define KERNEL_PARAMETERS vec4 direction; vec4 irradiance; uint dimmed;
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
float luminance_of(vec4 light)
{
return (0.2126f * light.x + 0.7152f * light.y) + 0.0722f * light.z;
}
float weight_of_sample(gather_sample at, vec4 direction)
{
precise float along = (at.normal.x * direction.x + at.normal.y * direction.y) +
at.normal.z * direction.z;
float weight = abs(along);
bool usable = weight <= 2.0f && abs(at.position.x) <= 1e30f && abs(at.position.y) <= 1e30f &&
abs(at.position.z) <= 1e30f;
return usable ? weight : 0.0f;
}
vec4 light_sum(vec4 sum, vec4 radiance, float weight)
{
precise float r = sum.x + radiance.x * weight;
precise float g = sum.y + radiance.y * weight;
precise float b = sum.z + radiance.z * weight;
precise float w = sum.w + weight;
return vec4(r, g, b, w);
}
vec4 moment_sum(vec4 sum, float radiance, vec4 direction, float side)
{
precise float mean = sum.x + radiance;
precise float x = sum.y + radiance * (side * direction.x);
precise float y = sum.z + radiance * (side * direction.y);
precise float z = sum.w + radiance * (side * direction.z);
return vec4(mean, x, y, z);
}
vec4 harmonics_of(vec4 moments, float each)
{
precise float mean = each * (0.282094792f * moments.x);
precise float y = each * (0.488602512f * moments.z);
precise float z = each * (0.488602512f * moments.w);
precise float x = each * (0.488602512f * moments.y);
return vec4(mean, y, z, x);
}
vec4 leaving_radiance(gather_material material, vec4 here, vec4 behind)
{
const float over_pi = 0.318309886f;
precise float r = material.emission.x + over_pi * (material.diffuse.x * here.x +
material.transmission.x * behind.x);
precise float g = material.emission.y + over_pi * (material.diffuse.y * here.y +
material.transmission.y * behind.y);
precise float b = material.emission.z + over_pi * (material.diffuse.z * here.z +
material.transmission.z * behind.z);
return vec4(r, g, b, 0.0f);
}
layout(std430, binding = 0) readonly buffer samples_buffer { gather_sample samples[]; };
layout(std430, binding = 1) readonly buffer hits_buffer { gather_hit hits[]; };
layout(std430, binding = 2) readonly buffer arriving_buffer { vec4 arriving[]; };
layout(std430, binding = 3) readonly buffer before_buffer { vec4 before[]; };
layout(std430, binding = 4) writeonly buffer direct_buffer { vec4 direct[]; };
void kernel_map(uint i) {
vec3 n = samples[i].normal;
precise float along = (n.x * direction.x + n.y * direction.y) + n.z * direction.z;
bool lit = along > 0.0 && weight_of_sample(samples[i], direction) > 0.0 &&
hits[i].surface == 0xffffffffu;
float part = dimmed != 0u ? arriving[i].y : 1.0;
precise float light = lit ? along * part : 0.0;
precise vec4 sum = before[i] + irradiance * light;
direct[i] = sum;
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
)glsl", 6039};
};

} // namespace skybark::opengl
