// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 9cf85518868e3ab8633030adc702461b5ed2fa905c3869cd1971f762691d0b06
#pragma once

#include <skybark/kernels/irradiance_voxels.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::irradiance_voxels> {
    static constexpr std::string_view voxels_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 8, local_size_y = 8) in;
#define KERNEL_PARAMETERS vec4 tilt; int points_x; int points_y;
#define KERNEL_TARGETS 1
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
layout(std430, binding = 0) readonly buffer harmonics_buffer { vec4 harmonics[]; };
void kernel_voxel(ivec3 at) {
int k = at.y / points_y;
int y = at.y - k * points_y;
int point = (at.z * points_y + y) * points_x + at.x;
int at_above = 6 * point + k / 4;
vec4 above = harmonics[at_above];
vec4 below = harmonics[at_above + 3];
precise vec4 all = (above + below) - tilt * (above.x - below.x);
imageStore(kernel_targets[0], at, vec4(all[k % 4]));
}
void main() {
if (all(lessThan(gl_GlobalInvocationID, skybark_header.xyz))) {
kernel_voxel(ivec3(gl_GlobalInvocationID));
}
}
)glsl", 2227};
};

} // namespace skybark::opengl
