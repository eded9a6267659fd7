// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 c5cea5df24e8b2fad2ede8d66d037df3d8ac60f6db679ca8c6cd30090abd53df
#pragma once

#include <skybark/kernels/scatter_coarsen.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::scatter_coarsen> {
    static constexpr std::string_view voxels_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 8, local_size_y = 8) in;
#define KERNEL_PARAMETERS uint axes;
#define KERNEL_VOLUMES 3
#define KERNEL_TARGETS 3
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
float scatter_load(int n, ivec3 at) { return texelFetch(kernel_volumes[n], at, 0).x; }
ivec3 scatter_size(int n) { return textureSize(kernel_volumes[n], 0); }
ivec3 halved_axes(uint axes, ivec3 size) {
return ivec3(size.x > 1 ? int(axes & 1u) : 0, size.y > 1 ? int(axes >> 1u & 1u) : 0,
size.z > 1 ? int(axes >> 2u & 1u) : 0);
}
ivec3 first_child(ivec3 parent, ivec3 halved) { return parent * (1 + halved); }
ivec3 child_of(ivec3 first, int which, ivec3 halved) {
return first + ivec3(which & 1, which >> 1 & 1, which >> 2) * halved;
}
ivec3 held(ivec3 at, ivec3 size) { return min(at, size - 1); }
bool within(ivec3 at, ivec3 size) { return all(lessThan(at, size)); }
void kernel_voxel(ivec3 at) {
ivec3 size = scatter_size(0);
ivec3 halved = halved_axes(axes, size);
ivec3 first = first_child(at, halved);
float extinction = 0.0;
float scattered = 0.0;
float beam = 0.0;
for (int c = 0; c < 8; ++c) {
ivec3 child = child_of(first, c, halved);
bool inside = within(child, size);
extinction += inside ? scatter_load(0, child) : 0.0;
scattered += inside ? scatter_load(1, child) : 0.0;
if ((c & 2) != 0) {
beam += inside ? scatter_load(2, child) : 1.0;
}
}
imageStore(kernel_targets[0], at, vec4(0.125 * extinction));
imageStore(kernel_targets[1], at, vec4(0.125 * scattered));
imageStore(kernel_targets[2], at, vec4(0.25 * beam));
}
void main() {
if (all(lessThan(gl_GlobalInvocationID, skybark_header.xyz))) {
kernel_voxel(ivec3(gl_GlobalInvocationID));
}
}
)glsl", 3110};
};

} // namespace skybark::opengl
