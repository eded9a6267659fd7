// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 6ef99f3439cbc40027c68994c83b5eb149859b7d05d0606afd868b3033fc1870
#pragma once

#include <skybark/kernels/gather_light.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::gather_light> {
    static constexpr std::string_view map_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 64) in;
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
#define KERNEL_PARAMETERS vec4 direction; vec4 sky_along; vec4 sky_against; uint first;
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
vec3 across_bundle(ray_bundle bundle, vec3 place)
{
precise float x = place.x - bundle.centre.x;
precise float y = place.y - bundle.centre.y;
precise float z = place.z - bundle.centre.z;
precise float right = (x * bundle.right.x + y * bundle.right.y) + z * bundle.right.z;
precise float up = (x * bundle.up.x + y * bundle.up.y) + z * bundle.up.z;
precise float along =
(x * bundle.direction.x + y * bundle.direction.y) + z * bundle.direction.z;
return vec3(right, up, along);
}
vec3 ray_origin(ray_bundle bundle, gather_sample at)
{
precise float x = at.position.x + bundle.right.w * at.normal.x;
precise float y = at.position.y + bundle.right.w * at.normal.y;
precise float z = at.position.z + bundle.right.w * at.normal.z;
return vec3(x, y, z);
}
float side_of_bundle(ray_bundle bundle, vec3 normal)
{
precise float along = (normal.x * bundle.direction.x + normal.y * bundle.direction.y) +
normal.z * bundle.direction.z;
return along >= 0.0f ? 1.0f : -1.0f;
}
struct bundle_meeting {
float facing;
float depth;
float u;
float v;
};
float meeting_slack(ray_bundle bundle)
{
precise float slack = 1e-6f * bundle.centre.w;
return slack;
}
bool is_between(float a, float b, float c, float at, float slack)
{
precise float low = min(a, min(b, c)) - slack;
precise float high = max(a, max(b, c)) + slack;
return at >= low && at <= high;
}
bundle_meeting meet_triangle(vec3 a, vec3 b, vec3 c, float x, float y, float slack)
{
precise float ax = a.x - x;
precise float ay = a.y - y;
precise float bx = b.x - x;
precise float by = b.y - y;
precise float cx = c.x - x;
precise float cy = c.y - y;
precise float e0 = bx * cy - by * cx;
precise float e1 = cx * ay - cy * ax;
precise float e2 = ax * by - ay * bx;
precise float area = (e0 + e1) + e2;
bool inside = (e0 >= 0.0f && e1 >= 0.0f && e2 >= 0.0f) ||
(e0 <= 0.0f && e1 <= 0.0f && e2 <= 0.0f);
inside = inside && is_between(a.x, b.x, c.x, x, slack) && is_between(a.y, b.y, c.y, y, slack);
bundle_meeting found;
found.facing = 0.0f;
found.depth = 0.0f;
found.u = 0.0f;
found.v = 0.0f;
if (inside && area != 0.0f) {
precise float depth = ((e0 * a.z + e1 * b.z) + e2 * c.z) / area;
precise float u = e1 / area;
precise float v = e2 / area;
found.facing = area;
found.depth = depth;
found.u = u;
found.v = v;
}
return found;
}
float facing_of_triangle(vec3 a, vec3 b, vec3 c)
{
precise float facing = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
return facing;
}
float distance_along(bundle_meeting met, float side, float z, float lift)
{
precise float distance = side * (met.depth - z);
bool front = side * met.facing < 0.0f;
float least = front ? -0.5f * lift : 0.5f * lift;
bool counts = met.facing != 0.0f && distance > least;
return counts ? max(distance, 0.0f) : -1.0f;
}
float depth_of_layer(float z, float reach)
{
precise float depth = 0.5f + 0.49f * (z / reach);
return depth;
}
float place_of_layer(float depth, float reach)
{
precise float z = (depth - 0.5f) * (reach / 0.49f);
return z;
}
float rise_in_pixel(ray_bundle bundle, vec3 normal, float apart)
{
float right = abs((normal.x * bundle.right.x + normal.y * bundle.right.y) +
normal.z * bundle.right.z);
float up = abs((normal.x * bundle.up.x + normal.y * bundle.up.y) + normal.z * bundle.up.z);
float along = abs((normal.x * bundle.direction.x + normal.y * bundle.direction.y) +
normal.z * bundle.direction.z);
return apart * (right + up) / max(along, 0.001f);
}
uint bundle_levels(uint cells)
{
uint levels = 1u;
for (uint n = cells; n > 1u; n = n / 2u) {
levels = levels + 1u;
}
return levels;
}
uint first_cell(uint cells, uint level)
{
uint first = 0u;
for (uint l = 0u; l < level; ++l) {
first = first + (cells >> l) * (cells >> l);
}
return first;
}
float bundle_cells(ray_bundle bundle, float across)
{
precise float cells = (across + bundle.centre.w) * bundle.up.w;
return cells;
}
int cell_within(float place, int count)
{
return place >= 1.0f ? int(min(place, float(count) - 0.5f)) : 0;
}
uint bundle_level(float extent, uint levels)
{
uint level = 0u;
float widest = 1.99f;
while (level + 1u < levels && !(extent <= widest)) {
level = level + 1u;
widest = widest * 2.0f;
}
return level;
}
uint bundle_cell(ray_bundle bundle, vec3 a, vec3 b, vec3 c)
{
uint cells = uint(bundle.direction.w);
float low_x = min(a.x, min(b.x, c.x));
float low_y = min(a.y, min(b.y, c.y));
float high_x = max(a.x, max(b.x, c.x));
float high_y = max(a.y, max(b.y, c.y));
float extent = max(high_x - low_x, high_y - low_y) * bundle.up.w;
uint level = bundle_level(extent, bundle_levels(cells));
int count = int(cells >> level);
float share = float(count) / float(cells);
int x = cell_within(bundle_cells(bundle, 0.5f * (low_x + high_x)) * share, count);
int y = cell_within(bundle_cells(bundle, 0.5f * (low_y + high_y)) * share, count);
return first_cell(cells, level) + uint(y * count + x);
}
uint patch_at(uint rows, float u, float v)
{
int n = int(rows);
float x = u * float(n);
float y = v * float(n);
int j = cell_within(y, n);
int i = cell_within(x, n - j);
bool upper = i + j + 1 < n && (x - float(i)) + (y - float(j)) > 1.0f;
return uint(j * (2 * n - j) + 2 * i + (upper ? 1 : 0));
}
struct barycentric {
float u;
float v;
};
barycentric patch_middle(uint rows, uint number)
{
int n = int(rows);
int m = int(number);
int left = n * n - m;
int k = int(ceil(sqrt(float(left))));
k = (k - 1) * (k - 1) >= left ? k - 1 : k;
k = k * k < left ? k + 1 : k;
int j = n - k;
int within = m - j * (2 * n - j);
float third = within % 2 == 1 ? 2.0f / 3.0f : 1.0f / 3.0f;
barycentric middle;
middle.u = (float(within / 2) + third) / float(n);
middle.v = (float(j) + third) / float(n);
return middle;
}
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
layout(std430, binding = 2) readonly buffer tables_buffer { patch_table tables[]; };
layout(std430, binding = 3) readonly buffer radiance_buffer { vec4 radiance[]; };
layout(std430, binding = 4) readonly buffer before_buffer { vec4 before[]; };
layout(std430, binding = 5) writeonly buffer sums_buffer { vec4 sums[]; };
float side_of(vec3 normal) {
precise float along =
(normal.x * direction.x + normal.y * direction.y) + normal.z * direction.z;
return along >= 0.0 ? 1.0 : -1.0;
}
vec4 light_seen(gather_hit hit, vec3 normal) {
if (hit.surface == 0xffffffffu) {
return side_of(normal) > 0.0 ? sky_along : sky_against;
}
patch_table table = tables[hit.surface / 2u];
uint patches = hit.surface % 2u == 0u ? table.front : table.back;
if (patches == 0xffffffffu) {
return vec4(0.0);
}
return radiance[patches + patch_at(table.rows, hit.u, hit.v)];
}
void kernel_map(uint i) {
vec3 normal = samples[i].normal;
vec4 seen = light_seen(hits[i], normal);
sums[first + i] = light_sum(before[first + i], seen, weight_of_sample(samples[i], direction));
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
)glsl", 12041};
    static constexpr std::string_view levels_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
#define readonly coherent readonly
#define writeonly coherent writeonly
#define SKYBARK_COMPUTE_STAGE
layout(local_size_x = 256) in;
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
#define KERNEL_PARAMETERS vec4 direction; vec4 sky_along; vec4 sky_against; uint first;
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
vec3 across_bundle(ray_bundle bundle, vec3 place)
{
precise float x = place.x - bundle.centre.x;
precise float y = place.y - bundle.centre.y;
precise float z = place.z - bundle.centre.z;
precise float right = (x * bundle.right.x + y * bundle.right.y) + z * bundle.right.z;
precise float up = (x * bundle.up.x + y * bundle.up.y) + z * bundle.up.z;
precise float along =
(x * bundle.direction.x + y * bundle.direction.y) + z * bundle.direction.z;
return vec3(right, up, along);
}
vec3 ray_origin(ray_bundle bundle, gather_sample at)
{
precise float x = at.position.x + bundle.right.w * at.normal.x;
precise float y = at.position.y + bundle.right.w * at.normal.y;
precise float z = at.position.z + bundle.right.w * at.normal.z;
return vec3(x, y, z);
}
float side_of_bundle(ray_bundle bundle, vec3 normal)
{
precise float along = (normal.x * bundle.direction.x + normal.y * bundle.direction.y) +
normal.z * bundle.direction.z;
return along >= 0.0f ? 1.0f : -1.0f;
}
struct bundle_meeting {
float facing;
float depth;
float u;
float v;
};
float meeting_slack(ray_bundle bundle)
{
precise float slack = 1e-6f * bundle.centre.w;
return slack;
}
bool is_between(float a, float b, float c, float at, float slack)
{
precise float low = min(a, min(b, c)) - slack;
precise float high = max(a, max(b, c)) + slack;
return at >= low && at <= high;
}
bundle_meeting meet_triangle(vec3 a, vec3 b, vec3 c, float x, float y, float slack)
{
precise float ax = a.x - x;
precise float ay = a.y - y;
precise float bx = b.x - x;
precise float by = b.y - y;
precise float cx = c.x - x;
precise float cy = c.y - y;
precise float e0 = bx * cy - by * cx;
precise float e1 = cx * ay - cy * ax;
precise float e2 = ax * by - ay * bx;
precise float area = (e0 + e1) + e2;
bool inside = (e0 >= 0.0f && e1 >= 0.0f && e2 >= 0.0f) ||
(e0 <= 0.0f && e1 <= 0.0f && e2 <= 0.0f);
inside = inside && is_between(a.x, b.x, c.x, x, slack) && is_between(a.y, b.y, c.y, y, slack);
bundle_meeting found;
found.facing = 0.0f;
found.depth = 0.0f;
found.u = 0.0f;
found.v = 0.0f;
if (inside && area != 0.0f) {
precise float depth = ((e0 * a.z + e1 * b.z) + e2 * c.z) / area;
precise float u = e1 / area;
precise float v = e2 / area;
found.facing = area;
found.depth = depth;
found.u = u;
found.v = v;
}
return found;
}
float facing_of_triangle(vec3 a, vec3 b, vec3 c)
{
precise float facing = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
return facing;
}
float distance_along(bundle_meeting met, float side, float z, float lift)
{
precise float distance = side * (met.depth - z);
bool front = side * met.facing < 0.0f;
float least = front ? -0.5f * lift : 0.5f * lift;
bool counts = met.facing != 0.0f && distance > least;
return counts ? max(distance, 0.0f) : -1.0f;
}
float depth_of_layer(float z, float reach)
{
precise float depth = 0.5f + 0.49f * (z / reach);
return depth;
}
float place_of_layer(float depth, float reach)
{
precise float z = (depth - 0.5f) * (reach / 0.49f);
return z;
}
float rise_in_pixel(ray_bundle bundle, vec3 normal, float apart)
{
float right = abs((normal.x * bundle.right.x + normal.y * bundle.right.y) +
normal.z * bundle.right.z);
float up = abs((normal.x * bundle.up.x + normal.y * bundle.up.y) + normal.z * bundle.up.z);
float along = abs((normal.x * bundle.direction.x + normal.y * bundle.direction.y) +
normal.z * bundle.direction.z);
return apart * (right + up) / max(along, 0.001f);
}
uint bundle_levels(uint cells)
{
uint levels = 1u;
for (uint n = cells; n > 1u; n = n / 2u) {
levels = levels + 1u;
}
return levels;
}
uint first_cell(uint cells, uint level)
{
uint first = 0u;
for (uint l = 0u; l < level; ++l) {
first = first + (cells >> l) * (cells >> l);
}
return first;
}
float bundle_cells(ray_bundle bundle, float across)
{
precise float cells = (across + bundle.centre.w) * bundle.up.w;
return cells;
}
int cell_within(float place, int count)
{
return place >= 1.0f ? int(min(place, float(count) - 0.5f)) : 0;
}
uint bundle_level(float extent, uint levels)
{
uint level = 0u;
float widest = 1.99f;
while (level + 1u < levels && !(extent <= widest)) {
level = level + 1u;
widest = widest * 2.0f;
}
return level;
}
uint bundle_cell(ray_bundle bundle, vec3 a, vec3 b, vec3 c)
{
uint cells = uint(bundle.direction.w);
float low_x = min(a.x, min(b.x, c.x));
float low_y = min(a.y, min(b.y, c.y));
float high_x = max(a.x, max(b.x, c.x));
float high_y = max(a.y, max(b.y, c.y));
float extent = max(high_x - low_x, high_y - low_y) * bundle.up.w;
uint level = bundle_level(extent, bundle_levels(cells));
int count = int(cells >> level);
float share = float(count) / float(cells);
int x = cell_within(bundle_cells(bundle, 0.5f * (low_x + high_x)) * share, count);
int y = cell_within(bundle_cells(bundle, 0.5f * (low_y + high_y)) * share, count);
return first_cell(cells, level) + uint(y * count + x);
}
uint patch_at(uint rows, float u, float v)
{
int n = int(rows);
float x = u * float(n);
float y = v * float(n);
int j = cell_within(y, n);
int i = cell_within(x, n - j);
bool upper = i + j + 1 < n && (x - float(i)) + (y - float(j)) > 1.0f;
return uint(j * (2 * n - j) + 2 * i + (upper ? 1 : 0));
}
struct barycentric {
float u;
float v;
};
barycentric patch_middle(uint rows, uint number)
{
int n = int(rows);
int m = int(number);
int left = n * n - m;
int k = int(ceil(sqrt(float(left))));
k = (k - 1) * (k - 1) >= left ? k - 1 : k;
k = k * k < left ? k + 1 : k;
int j = n - k;
int within = m - j * (2 * n - j);
float third = within % 2 == 1 ? 2.0f / 3.0f : 1.0f / 3.0f;
barycentric middle;
middle.u = (float(within / 2) + third) / float(n);
middle.v = (float(j) + third) / float(n);
return middle;
}
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
layout(std430, binding = 2) readonly buffer tables_buffer { patch_table tables[]; };
layout(std430, binding = 3) readonly buffer radiance_buffer { vec4 radiance[]; };
layout(std430, binding = 4) readonly buffer before_buffer { vec4 before[]; };
layout(std430, binding = 5) writeonly buffer sums_buffer { vec4 sums[]; };
float side_of(vec3 normal) {
precise float along =
(normal.x * direction.x + normal.y * direction.y) + normal.z * direction.z;
return along >= 0.0 ? 1.0 : -1.0;
}
vec4 light_seen(gather_hit hit, vec3 normal) {
if (hit.surface == 0xffffffffu) {
return side_of(normal) > 0.0 ? sky_along : sky_against;
}
patch_table table = tables[hit.surface / 2u];
uint patches = hit.surface % 2u == 0u ? table.front : table.back;
if (patches == 0xffffffffu) {
return vec4(0.0);
}
return radiance[patches + patch_at(table.rows, hit.u, hit.v)];
}
void kernel_map(uint i) {
vec3 normal = samples[i].normal;
vec4 seen = light_seen(hits[i], normal);
sums[first + i] = light_sum(before[first + i], seen, weight_of_sample(samples[i], direction));
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
)glsl", 12056};
};

} // namespace skybark::opengl
