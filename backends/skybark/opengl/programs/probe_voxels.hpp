// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 3652901d335a201f23a7b14d34bc0670c1cd23fb674b78a45609f18e7f49ac91
#pragma once

#include <skybark/kernels/probe_voxels.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::probe_voxels> {
    static constexpr std::string_view voxels_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 8, local_size_y = 8) in;
#define KERNEL_PARAMETERS int extent_x; int extent_y; float shift;
#define KERNEL_VOLUMES 2
#define KERNEL_TARGETS 2
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
layout(std430, binding = 0) readonly buffer weights_buffer { vec4 weights[]; };
layout(std430, binding = 1) writeonly buffer numbers_buffer { uint numbers[]; };
float loaded(ivec3 at) {
ivec3 size = textureSize(kernel_volumes[0], 0);
bool inside = all(greaterThanEqual(at, ivec3(0))) && all(lessThan(at, size));
return inside ? texelFetch(kernel_volumes[0], at, 0).x : 0.0;
}
void kernel_voxel(ivec3 at) {
float sum = loaded(at);
sum += loaded(at + ivec3(1, 0, 0)) + loaded(at - ivec3(1, 0, 0));
sum += loaded(at + ivec3(0, 1, 0)) + loaded(at - ivec3(0, 1, 0));
sum += loaded(at + ivec3(0, 0, 1)) + loaded(at - ivec3(0, 0, 1));
imageStore(kernel_targets[0], at, vec4(weights[at.z].x * sum));
vec3 place = (vec3(at) + 0.5 + shift) / vec3(textureSize(kernel_volumes[1], 0));
imageStore(kernel_targets[1], at, vec4(textureLod(kernel_volumes[1], place, 0.0).x));
int number = (at.z * extent_y + at.y) * extent_x + at.x;
numbers[number] = uint(number) + (uint(textureSize(kernel_volumes[0], 0).x) << 24);
}
void main() {
if (all(lessThan(gl_GlobalInvocationID, skybark_header.xyz))) {
kernel_voxel(ivec3(gl_GlobalInvocationID));
}
}
)glsl", 2809};
};

} // namespace skybark::opengl
