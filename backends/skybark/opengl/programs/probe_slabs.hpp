// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 305e2b4f2a4604d8007fddfa29a305857e9ef038e1eb4eab827cd40dfc9998d4
#pragma once

#include <skybark/kernels/probe_slabs.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::probe_slabs> {
    static constexpr std::string_view accumulate_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_COMPUTE_STAGE
#ifdef SKYBARK_VULKAN
layout(local_size_x_id = 0) in;
#else
layout(local_size_x = 16) in;
#endif
#define KERNEL_PARAMETERS uint most; int per_x; int per_z; int factor;
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
struct probe_box {
ivec4 low;
ivec4 high;
};
layout(std430, binding = 0) readonly buffer boxes_buffer { probe_box boxes[]; };
uint kernel_slabs() { return most; }
uint kernel_slab_count(uint i) { return min(uint(max(boxes[i].high.z - boxes[i].low.z, 0)), most); }
voxel_slab kernel_slab(uint i, uint s) {
probe_box box = boxes[i];
int by = int(s);
return voxel_slab(ivec2(box.low.x + by, box.low.y), ivec2(box.high.x, box.high.y - by),
box.low.z + by);
}
float kernel_lateral(uint i, int x, int z) {
return float(boxes[i].low.w + per_x * x + per_z * z);
}
float kernel_row(uint i, int y) { return float(boxes[i].high.w * (y + 1)); }
int kernel_amount(float lateral, float row, float above) {
return int(lateral + 2.0 * row - above) * factor;
}
layout(std430, binding = 10) readonly buffer skybark_length_buffer { uint skybark_length[]; };
layout(binding = SKYBARK_SUMS_BINDING, r32i) uniform iimage3D skybark_sums;
int skybark_fetch(ivec2 low, ivec2 high, int slice, int row, int step) {
int all = 0;
for (int y = low.y + row; y < high.y; y += step) {
all |= imageLoad(skybark_sums, ivec3(low.x, y, slice)).x;
all |= imageLoad(skybark_sums, ivec3(high.x - 1, y, slice)).x;
}
return all & int(skybark_header.w & 0xfffcu);
}
void skybark_add(uint i, uint s, int column, int step, ivec3 size) {
voxel_slab slab = kernel_slab(i, s);
if (slab.slice < 0 || slab.slice >= size.z) {
return;
}
ivec2 low = clamp(slab.low, ivec2(0), size.xy);
ivec2 high = min(slab.high, size.xy);
int first = low.x + column;
if ((skybark_header.w & 2u) != 0u && low.x < high.x && high.y - low.y > 1) {
first += skybark_fetch(low, high, slab.slice, column, step);
}
for (int x = first; x < high.x; x += step) {
float lateral = kernel_lateral(i, x, slab.slice);
float row = kernel_row(i, low.y);
for (int y = low.y; y < high.y; ++y) {
float above = kernel_row(i, y + 1);
int amount = kernel_amount(lateral, row, above);
if (amount != 0) {
imageAtomicAdd(skybark_sums, ivec3(x, y, slab.slice), amount);
}
row = above;
}
}
}
void main() {
uint lanes = skybark_header.z & 0xffffu;
uint sharing = skybark_header.z >> 16;
uint each = skybark_header.w >> 16;
uint parts = (kernel_slabs() + each - 1u) / each * sharing;
uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
uint k = group / parts;
uint i = skybark_header.x + k;
bool counted = (skybark_header.w & 1u) != 0u;
if (k >= skybark_header.y || (counted && i >= skybark_length[0])) {
return;
}
uint part = group - k * parts;
uint slot = gl_LocalInvocationID.x / lanes;
uint column = part % sharing * lanes + gl_LocalInvocationID.x - slot * lanes;
uint first = part / sharing * each;
uint last = min(first + each, kernel_slab_count(i));
ivec3 size = imageSize(skybark_sums);
for (uint s = first + slot; s < last; s += gl_WorkGroupSize.x / lanes) {
skybark_add(i, s, int(column), int(lanes * sharing), size);
}
}
)glsl", 4537};
    static constexpr std::string_view slabs_vert{R"glsl(#version 450
#define SKYBARK_OPENGL
#define KERNEL_PARAMETERS uint most; int per_x; int per_z; int factor;
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
struct probe_box {
ivec4 low;
ivec4 high;
};
layout(std430, binding = 0) readonly buffer boxes_buffer { probe_box boxes[]; };
uint kernel_slabs() { return most; }
uint kernel_slab_count(uint i) { return min(uint(max(boxes[i].high.z - boxes[i].low.z, 0)), most); }
voxel_slab kernel_slab(uint i, uint s) {
probe_box box = boxes[i];
int by = int(s);
return voxel_slab(ivec2(box.low.x + by, box.low.y), ivec2(box.high.x, box.high.y - by),
box.low.z + by);
}
float kernel_lateral(uint i, int x, int z) {
return float(boxes[i].low.w + per_x * x + per_z * z);
}
float kernel_row(uint i, int y) { return float(boxes[i].high.w * (y + 1)); }
int kernel_amount(float lateral, float row, float above) {
return int(lateral + 2.0 * row - above) * factor;
}
layout(location = 0) uniform ivec4 skybark_layers;
layout(location = 1) uniform ivec4 skybark_tiles;
ivec2 skybark_origin(int n) {
return skybark_tiles.x == 0
? ivec2(0)
: ivec2(n % skybark_tiles.x, n / skybark_tiles.x) * skybark_layers.xy;
}
bool skybark_empty(voxel_slab slab) { return any(greaterThanEqual(slab.low, slab.high)); }
voxel_slab skybark_nothing() { return voxel_slab(ivec2(0), ivec2(0), skybark_layers.z); }
voxel_slab skybark_visible(uint i, uint s) {
voxel_slab slab = kernel_slab(i, s);
slab.low = max(slab.low, ivec2(0));
slab.high = min(slab.high, skybark_layers.xy);
bool inside =
slab.slice >= skybark_layers.z && slab.slice - skybark_layers.z < skybark_layers.w;
if (!inside || skybark_empty(slab)) {
return skybark_nothing();
}
return slab;
}
vec4 skybark_corner(voxel_slab slab, uint corner) {
ivec2 at = ivec2((corner & 1u) != 0u ? slab.high.x : slab.low.x,
(corner & 2u) != 0u ? slab.high.y : slab.low.y);
at += skybark_origin(slab.slice - skybark_layers.z);
return vec4(vec2(2 * at - skybark_tiles.zw) / vec2(skybark_tiles.zw), 0.0, 1.0);
}
layout(location = 0) flat out ivec2 skybark_cell;
void main() {
if ((skybark_header.w & 8u) != 0u) {
skybark_cell = ivec2(gl_VertexID, 0);
gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
return;
}
const uint corners[6] = uint[6](0u, 1u, 2u, 2u, 1u, 3u);
uint rectangle = uint(gl_VertexID) / 6u;
uint element = rectangle / kernel_slabs();
uint s = rectangle - element * kernel_slabs();
uint i = skybark_header.x + element;
voxel_slab slab = skybark_nothing();
if (s < kernel_slab_count(i)) {
slab = skybark_visible(i, s);
}
skybark_cell = ivec2(i, slab.slice);
gl_Position = skybark_corner(slab, corners[uint(gl_VertexID) - rectangle * 6u]);
}
)glsl", 4007};
    static constexpr std::string_view slabs_geom{R"glsl(#version 450
#define SKYBARK_OPENGL
#define KERNEL_PARAMETERS uint most; int per_x; int per_z; int factor;
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
struct probe_box {
ivec4 low;
ivec4 high;
};
layout(std430, binding = 0) readonly buffer boxes_buffer { probe_box boxes[]; };
uint kernel_slabs() { return most; }
uint kernel_slab_count(uint i) { return min(uint(max(boxes[i].high.z - boxes[i].low.z, 0)), most); }
voxel_slab kernel_slab(uint i, uint s) {
probe_box box = boxes[i];
int by = int(s);
return voxel_slab(ivec2(box.low.x + by, box.low.y), ivec2(box.high.x, box.high.y - by),
box.low.z + by);
}
float kernel_lateral(uint i, int x, int z) {
return float(boxes[i].low.w + per_x * x + per_z * z);
}
float kernel_row(uint i, int y) { return float(boxes[i].high.w * (y + 1)); }
int kernel_amount(float lateral, float row, float above) {
return int(lateral + 2.0 * row - above) * factor;
}
layout(location = 0) uniform ivec4 skybark_layers;
layout(location = 1) uniform ivec4 skybark_tiles;
ivec2 skybark_origin(int n) {
return skybark_tiles.x == 0
? ivec2(0)
: ivec2(n % skybark_tiles.x, n / skybark_tiles.x) * skybark_layers.xy;
}
bool skybark_empty(voxel_slab slab) { return any(greaterThanEqual(slab.low, slab.high)); }
voxel_slab skybark_nothing() { return voxel_slab(ivec2(0), ivec2(0), skybark_layers.z); }
voxel_slab skybark_visible(uint i, uint s) {
voxel_slab slab = kernel_slab(i, s);
slab.low = max(slab.low, ivec2(0));
slab.high = min(slab.high, skybark_layers.xy);
bool inside =
slab.slice >= skybark_layers.z && slab.slice - skybark_layers.z < skybark_layers.w;
if (!inside || skybark_empty(slab)) {
return skybark_nothing();
}
return slab;
}
vec4 skybark_corner(voxel_slab slab, uint corner) {
ivec2 at = ivec2((corner & 1u) != 0u ? slab.high.x : slab.low.x,
(corner & 2u) != 0u ? slab.high.y : slab.low.y);
at += skybark_origin(slab.slice - skybark_layers.z);
return vec4(vec2(2 * at - skybark_tiles.zw) / vec2(skybark_tiles.zw), 0.0, 1.0);
}
#ifndef SKYBARK_MAX_VERTICES
#define SKYBARK_MAX_VERTICES 16
#endif
layout(points) in;
layout(triangle_strip, max_vertices = SKYBARK_MAX_VERTICES) out;
layout(location = 0) flat in ivec2 skybark_point[1];
layout(location = 0) flat out ivec2 skybark_cell;
void skybark_emit(uint i, voxel_slab slab) {
for (uint corner = 0u; corner < 4u; ++corner) {
skybark_cell = ivec2(i, slab.slice);
gl_Layer = slab.slice - skybark_layers.z;
gl_Position = skybark_corner(slab, corner);
EmitVertex();
}
EndPrimitive();
}
void main() {
uint slabs = kernel_slabs();
uint parts = (slabs + skybark_header.z - 1u) / skybark_header.z;
uint element = uint(skybark_point[0].x) / parts;
uint i = skybark_header.x + element;
uint first = (uint(skybark_point[0].x) - element * parts) * skybark_header.z;
bool padded = (skybark_header.w & 2u) != 0u;
uint count = kernel_slab_count(i);
uint last = min(first + skybark_header.z, padded ? slabs : min(count, slabs));
for (uint s = first; s < last; ++s) {
voxel_slab slab = skybark_nothing();
if (s < count) {
slab = skybark_visible(i, s);
}
if (padded || !skybark_empty(slab)) {
skybark_emit(i, slab);
}
}
}
)glsl", 4499};
    static constexpr std::string_view slabs_frag{R"glsl(#version 450
#define SKYBARK_OPENGL
#define KERNEL_PARAMETERS uint most; int per_x; int per_z; int factor;
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
struct probe_box {
ivec4 low;
ivec4 high;
};
layout(std430, binding = 0) readonly buffer boxes_buffer { probe_box boxes[]; };
uint kernel_slabs() { return most; }
uint kernel_slab_count(uint i) { return min(uint(max(boxes[i].high.z - boxes[i].low.z, 0)), most); }
voxel_slab kernel_slab(uint i, uint s) {
probe_box box = boxes[i];
int by = int(s);
return voxel_slab(ivec2(box.low.x + by, box.low.y), ivec2(box.high.x, box.high.y - by),
box.low.z + by);
}
float kernel_lateral(uint i, int x, int z) {
return float(boxes[i].low.w + per_x * x + per_z * z);
}
float kernel_row(uint i, int y) { return float(boxes[i].high.w * (y + 1)); }
int kernel_amount(float lateral, float row, float above) {
return int(lateral + 2.0 * row - above) * factor;
}
layout(location = 0) uniform ivec4 skybark_layers;
layout(location = 1) uniform ivec4 skybark_tiles;
ivec2 skybark_origin(int n) {
return skybark_tiles.x == 0
? ivec2(0)
: ivec2(n % skybark_tiles.x, n / skybark_tiles.x) * skybark_layers.xy;
}
bool skybark_empty(voxel_slab slab) { return any(greaterThanEqual(slab.low, slab.high)); }
voxel_slab skybark_nothing() { return voxel_slab(ivec2(0), ivec2(0), skybark_layers.z); }
voxel_slab skybark_visible(uint i, uint s) {
voxel_slab slab = kernel_slab(i, s);
slab.low = max(slab.low, ivec2(0));
slab.high = min(slab.high, skybark_layers.xy);
bool inside =
slab.slice >= skybark_layers.z && slab.slice - skybark_layers.z < skybark_layers.w;
if (!inside || skybark_empty(slab)) {
return skybark_nothing();
}
return slab;
}
vec4 skybark_corner(voxel_slab slab, uint corner) {
ivec2 at = ivec2((corner & 1u) != 0u ? slab.high.x : slab.low.x,
(corner & 2u) != 0u ? slab.high.y : slab.low.y);
at += skybark_origin(slab.slice - skybark_layers.z);
return vec4(vec2(2 * at - skybark_tiles.zw) / vec2(skybark_tiles.zw), 0.0, 1.0);
}
layout(location = 0) flat in ivec2 skybark_cell;
layout(location = 0) out vec2 skybark_amount;
void main() {
int slice = skybark_cell.y;
ivec2 at = ivec2(gl_FragCoord.xy) - skybark_origin(slice - skybark_layers.z);
uint i = uint(skybark_cell.x);
int amount = kernel_amount(kernel_lateral(i, at.x, slice), kernel_row(i, at.y),
kernel_row(i, at.y + 1));
int low = amount & 255;
int carry = low >> 7;
skybark_amount = vec2(float((amount >> 8) + carry), float(low - 256 * carry));
}
)glsl", 3851};
};

} // namespace skybark::opengl
