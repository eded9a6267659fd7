// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 c656b4d03406111f2d5822eb0edd3af1035c1f31c2c458d1bad8b237c57da890
#pragma once

#include <skybark/kernels/scatter_prolong.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::scatter_prolong> {
    static constexpr std::string_view voxels_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 8, local_size_y = 8) in;
#define KERNEL_PARAMETERS uint from_zero; uint axes;
#define KERNEL_VOLUMES 2
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
float row(int near, int far, int y, int z) {
return 0.75 * scatter_load(1, ivec3(near, y, z)) + 0.25 * scatter_load(1, ivec3(far, y, z));
}
void kernel_voxel(ivec3 at) {
ivec3 last = scatter_size(1) - 1;
ivec3 halved = halved_axes(axes, scatter_size(0));
ivec3 near = min(at / (1 + halved), last);
ivec3 far = clamp(near + halved * (2 * (at - 2 * (at / 2)) - 1), ivec3(0), last);
float sum = 0.75 * (0.75 * row(near.x, far.x, near.y, near.z) + 0.25 * row(near.x, far.x, far.y, near.z)) +
0.25 * (0.75 * row(near.x, far.x, near.y, far.z) + 0.25 * row(near.x, far.x, far.y, far.z));
if (from_zero == 0u) {
sum = scatter_load(0, at) + sum;
}
imageStore(kernel_targets[0], at, vec4(sum));
}
void main() {
if (all(lessThan(gl_GlobalInvocationID, skybark_header.xyz))) {
kernel_voxel(ivec3(gl_GlobalInvocationID));
}
}
)glsl", 3149};
};

} // namespace skybark::opengl
