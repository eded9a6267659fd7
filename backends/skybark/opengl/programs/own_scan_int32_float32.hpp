// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 05162d704f418474382800b8edb1ad27a76a8f4b7f2941c69471835ee1332726
#pragma once

#include <string_view>

namespace skybark::opengl {

inline constexpr std::string_view scan_int32_float32_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define NUMBER int
#define FROM_FORMAT r32i
#define FROM_IMAGE iimage3D
#define INTO_FORMAT r32f
#define INTO_IMAGE image3D
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
layout(binding = SKYBARK_SUMS_BINDING, FROM_FORMAT) readonly uniform FROM_IMAGE from_volume;
layout(binding = SKYBARK_TARGET_BINDING, INTO_FORMAT) writeonly uniform INTO_IMAGE into_volume;
#ifdef INTO_FLOAT16
float rounded(float value) {
uint bits = floatBitsToUint(value);
uint size = bits & 0x7fffffffu;
if (size >= 0x477ff000u) {
size = size > 0x7f800000u ? size : 0x477fe000u;
} else if (size < 0x38800000u) {
size = floatBitsToUint(roundEven(uintBitsToFloat(size) * 16777216.0) / 16777216.0);
} else {
size = (size + 0xfffu + ((size >> 13) & 1u)) & ~0x1fffu;
}
return uintBitsToFloat(size | (bits & 0x80000000u));
}
#else
float rounded(float value) { return value; }
#endif
#ifdef INTO_WHOLE_NUMBERS
ivec4 shared_out(int before, int own) {
return ivec4(skybark_header.z == 2u ? before : before + own);
}
#else
vec4 shared_out(NUMBER before, NUMBER own) {
float sum = skybark_header.z == 0u   ? float(before + own)
: skybark_header.z == 1u ? float(before) + 0.5 * float(own)
: float(before);
return vec4(rounded(sum * uintBitsToFloat(skybark_header.w)));
}
#endif
void main() {
ivec3 size = imageSize(from_volume);
ivec2 column = ivec2(gl_GlobalInvocationID.xy);
uint axis = skybark_header.x;
ivec3 at = axis == 1u   ? ivec3(0, column)
: axis == 3u ? ivec3(column, 0)
: ivec3(column.x, 0, column.y);
if (any(greaterThanEqual(at, size))) {
return;
}
ivec3 forward = axis == 1u ? ivec3(1, 0, 0) : axis == 3u ? ivec3(0, 0, 1) : ivec3(0, 1, 0);
int count = axis == 1u ? size.x : axis == 3u ? size.z : size.y;
if (skybark_header.y != 0u) {
at += forward * (count - 1);
forward = -forward;
}
NUMBER before = NUMBER(0);
for (int n = 0; n < count; ++n) {
NUMBER own = imageLoad(from_volume, at).x;
imageStore(into_volume, at, shared_out(before, own));
before = axis == 0u ? before : before + own;
at += forward;
}
}
)glsl", 3453};

} // namespace skybark::opengl
