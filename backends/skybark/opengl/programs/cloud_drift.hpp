// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 69162189a23399bf0d747ba810dee6297462083d7b4d5e6470ab377767dd7d01
#pragma once

#include <skybark/kernels/cloud_drift.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::cloud_drift> {
    static constexpr std::string_view map_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 64) in;
#define KERNEL_PARAMETERS vec4 box; vec4 moved;
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
float drift_shift(float middle, float offset, float centre, float side, float over) {
precise float from = middle + offset - centre;
precise float turns = floor(from * over + 0.5f);
precise float shift = offset - turns * side;
return shift;
}
float drift_weight(float x, float z, float outer2, float over) {
precise float distance2 = x * x + z * z;
precise float part = clamp((outer2 - distance2) * over, 0.0f, 1.0f);
precise float weight = part * part * (3.0f - 2.0f * part);
return weight;
}
layout(std430, binding = 0) readonly buffer rest_buffer { vec4 rest[]; };
layout(std430, binding = 1) readonly buffer middle_buffer { vec4 middles[]; };
layout(std430, binding = 2) writeonly buffer particles_buffer { vec4 particles[]; };
void kernel_map(uint i) {
vec4 ball = rest[2u * i];
vec4 water = rest[2u * i + 1u];
vec4 middle = middles[i];
float x = drift_shift(middle.x, moved.x, box.x, box.z, box.w);
float z = drift_shift(middle.z, moved.y, box.y, box.z, box.w);
precise float at_x = middle.x + x - box.x;
precise float at_z = middle.z + z - box.y;
precise float ball_x = ball.x + x;
precise float ball_z = ball.z + z;
precise float depth = water.x * drift_weight(at_x, at_z, moved.z, moved.w);
particles[2u * i] = vec4(ball_x, ball.y, ball_z, ball.w);
particles[2u * i + 1u] = vec4(depth, water.y, water.z, water.w);
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
)glsl", 3325};
    static constexpr std::string_view levels_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define readonly coherent readonly
#define writeonly coherent writeonly
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 256) in;
#define KERNEL_PARAMETERS vec4 box; vec4 moved;
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
float drift_shift(float middle, float offset, float centre, float side, float over) {
precise float from = middle + offset - centre;
precise float turns = floor(from * over + 0.5f);
precise float shift = offset - turns * side;
return shift;
}
float drift_weight(float x, float z, float outer2, float over) {
precise float distance2 = x * x + z * z;
precise float part = clamp((outer2 - distance2) * over, 0.0f, 1.0f);
precise float weight = part * part * (3.0f - 2.0f * part);
return weight;
}
layout(std430, binding = 0) readonly buffer rest_buffer { vec4 rest[]; };
layout(std430, binding = 1) readonly buffer middle_buffer { vec4 middles[]; };
layout(std430, binding = 2) writeonly buffer particles_buffer { vec4 particles[]; };
void kernel_map(uint i) {
vec4 ball = rest[2u * i];
vec4 water = rest[2u * i + 1u];
vec4 middle = middles[i];
float x = drift_shift(middle.x, moved.x, box.x, box.z, box.w);
float z = drift_shift(middle.z, moved.y, box.y, box.z, box.w);
precise float at_x = middle.x + x - box.x;
precise float at_z = middle.z + z - box.y;
precise float ball_x = ball.x + x;
precise float ball_z = ball.z + z;
precise float depth = water.x * drift_weight(at_x, at_z, moved.z, moved.w);
particles[2u * i] = vec4(ball_x, ball.y, ball_z, ball.w);
particles[2u * i + 1u] = vec4(depth, water.y, water.z, water.w);
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
)glsl", 3340};
};

} // namespace skybark::opengl
