// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 63bf932c16351734b9e7f01ff7b6cabb393c947cdf7674aa4372ea2c39ba62a8
#pragma once

#include <skybark/kernels/scatter_limit.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::scatter_limit> {
    static constexpr std::string_view voxels_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 8, local_size_y = 8) in;
#define KERNEL_PARAMETERS vec4 sides; float transport; float spreading; float assumed;
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
struct scatter_balance {
float gain;
float loss;
};
scatter_balance scatter_across(scatter_balance sum, float phi, float here, float beyond,
float side) {
float passes = 2.0f / ((here + beyond) * side * side);
scatter_balance now = sum;
now.gain = sum.gain + passes * phi;
now.loss = sum.loss + passes;
return now;
}
float scatter_escape(float empty, float side) { return 1.0f / (2.0f + 0.5f * empty * side); }
float scatter_relaxed(scatter_balance sum, float phi, float weight) {
return (1.0f - weight) * phi + weight * (sum.gain / sum.loss);
}
float scatter_resistance(float transport, float empty, float spreading, float across) {
return 3.0f * transport + empty + spreading * across;
}
float scatter_moment(float moment, float beam, float here, float beyond, float w_here,
float w_beyond) {
return moment * beam * (here + beyond) / (w_here + w_beyond);
}
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
float sideways(ivec3 at) {
ivec3 last = scatter_size(0) - 1;
int left = max(at.x - 1, 0);
int right = min(at.x + 1, last.x);
int back = max(at.z - 1, 0);
int front = min(at.z + 1, last.z);
float to_left = scatter_load(0, ivec3(left, at.y, at.z));
float to_right = scatter_load(0, ivec3(right, at.y, at.z));
float to_back = scatter_load(0, ivec3(at.x, at.y, back));
float to_front = scatter_load(0, ivec3(at.x, at.y, front));
float x = (to_right - to_left) / (float(max(right - left, 1)) * sides.x);
float z = (to_front - to_back) / (float(max(front - back, 1)) * sides.z);
float around = 0.25 * ((to_left + to_right) + (to_back + to_front));
float here = max(max(scatter_load(0, at), around), 1e-12);
return sqrt(x * x + z * z) / here;
}
void kernel_voxel(ivec3 at) {
float across = assumed;
if (assumed < 0.0) {
across = sideways(at);
}
imageStore(kernel_targets[0], at,
vec4(scatter_resistance(transport * scatter_load(1, at), sides.w, spreading, across)));
}
void main() {
if (all(lessThan(gl_GlobalInvocationID, skybark_header.xyz))) {
kernel_voxel(ivec3(gl_GlobalInvocationID));
}
}
)glsl", 4317};
};

} // namespace skybark::opengl
