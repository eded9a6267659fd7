#pragma once
// The records that cross between host and device. Each has the std430 layout that its GLSL twin in
// shaders/shared/records.glsl has; the assertions below hold the two together.

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <type_traits>

namespace skybark {

/// A type that may lie in a device buffer: plain bytes, in whole 32-bit words.
template <class T>
concept record = std::is_trivially_copyable_v<T> && std::is_standard_layout_v<T> && sizeof(T) % 4 ==
                 0;

/// Consecutive elements [first, first + count) of an array.
struct range {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
};

/// How much an `expand` wrote, and how much it would have written into a large enough buffer.
/// In triangles. It stays on the device, where the next pattern or `draw` takes it as its length.
struct count_record {
    std::uint32_t written = 0;
    std::uint32_t required = 0;
    std::uint32_t reserved[2] = {0, 0};
};
static_assert(sizeof(count_record) == 16);

/// A vertex of a surface that can be lit and textured.
struct surface_vertex {
    glm::vec3 position{0}; ///< m
    float u = 0;           ///< texture coordinate around the branch, 0…1
    glm::vec3 normal{0};   ///< unit, outwards
    float v = 0;           ///< texture coordinate along the branch, m
    glm::vec4 tangent{
        0}; ///< xyz: unit, towards growing u; w: bitangent = w · cross(normal, tangent)
};
static_assert(sizeof(surface_vertex) == 48);
static_assert(offsetof(surface_vertex, u) == 12 && offsetof(surface_vertex, normal) == 16 &&
              offsetof(surface_vertex, v) == 28 && offsetof(surface_vertex, tangent) == 32);

/// The end of a branch segment, or the joint that two segments share (Akagi and Kitajima, 3.2).
struct branch_end {
    glm::vec3 position{0};             ///< m
    float radius = 0;                  ///< m
    glm::vec4 orientation{0, 0, 0, 1}; ///< unit quaternion x, y, z, w; local +Y is the growth
    float path = 0;                    ///< m along the wood from the root; becomes v
    float slope = 0;                   ///< change of radius along the growth; tilts the normal
    float reserved[2] = {0, 0};
};
static_assert(sizeof(branch_end) == 48);
static_assert(offsetof(branch_end, radius) == 12 && offsetof(branch_end, orientation) == 16 &&
              offsetof(branch_end, path) == 32 && offsetof(branch_end, slope) == 36);

/// A branch segment: two ends, and which of them a cap closes.
struct branch_segment {
    std::uint32_t start = 0; ///< index of a branch_end
    std::uint32_t end = 0;   ///< index of a branch_end
    std::uint32_t caps = 0;  ///< bit 0: a cap at the start, bit 1: one at the end
    std::uint32_t reserved = 0;
};
static_assert(sizeof(branch_segment) == 16);

inline constexpr std::uint32_t cap_start = 1;
inline constexpr std::uint32_t cap_end = 2;

/// Where a segment of the skeleton is now, against its rest. What it carries moves from x to
/// x + shift + (rotation · y − y) with y = x − base: exactly x where nothing has moved.
struct segment_pose {
    glm::vec4 rotation{0, 0, 0, 1}; ///< unit quaternion x, y, z, w: from rest to now, in the world
    glm::vec3 base{0};              ///< m, the base of the segment at rest
    float reserved0 = 0;
    glm::vec3 shift{0}; ///< m, how far the base has moved
    float reserved1 = 0;
};
static_assert(sizeof(segment_pose) == 48);
static_assert(offsetof(segment_pose, base) == 16 && offsetof(segment_pose, shift) == 32);

/// Which segments move and turn a branch_end. At a joint the ring lies half way between the two.
struct end_carrier {
    std::uint32_t moved_by = 0;  ///< index of a segment_pose
    std::uint32_t turned_by = 0; ///< index of a segment_pose: half of the turn is its …
    std::uint32_t and_by = 0;    ///< … and half this one's; the same at a free end
    std::uint32_t reserved = 0;
};
static_assert(sizeof(end_carrier) == 16);

/// A leaf at rest (Akagi and Kitajima, 3.2 and 3.4), and which segment carries it.
struct leaf {
    glm::vec3 position{0};             ///< m, where its stalk begins
    float width = 0;                   ///< m, of both halves together
    glm::vec4 orientation{0, 0, 0, 1}; ///< unit quaternion: +Y to the tip, +Z off the upper face
    float length = 0;                  ///< m
    std::uint32_t carrier = 0;         ///< index of a segment_pose
    std::uint32_t seed = 0;            ///< random bits of its own: flutter, level of detail
    float fold = 0;                    ///< rad, how far each half is folded up about the midrib
};
static_assert(sizeof(leaf) == 48);
static_assert(offsetof(leaf, width) == 12 && offsetof(leaf, orientation) == 16 &&
              offsetof(leaf, length) == 32 && offsetof(leaf, seed) == 40);

/// What the wind does to a segment that carries leaves: a force at its middle, and how that force
/// falls as the segment yields, which damps it.
struct segment_load {
    glm::vec3 force{0}; ///< N, on the segment if it stood still
    float drag = 0;     ///< kg/s ≥ 0: the force falls by `drag` · the velocity of the middle
};
static_assert(sizeof(segment_load) == 16);

/// A part of a cloud: water that thins out from a centre like a Gaussian and ends at `radius`.
struct cloud_particle {
    glm::vec3 position{0};   ///< m
    float radius = 0;        ///< m, > 0
    float optical_depth = 0; ///< along a straight line through the centre, ≥ 0
    float albedo = 1;        ///< what is scattered of what is taken out, 0…1
    float reserved[2] = {0, 0};
};
static_assert(sizeof(cloud_particle) == 32);
static_assert(offsetof(cloud_particle, radius) == 12 &&
              offsetof(cloud_particle, optical_depth) == 16 &&
              offsetof(cloud_particle, albedo) == 20);

/// A grid of voxels in the light's frame: +y towards the sun, x, y, z right-handed. A place in the
/// world has the voxel coordinates `cells(p) = offset + rows · (p − anchor)`, where voxel (i, j, k)
/// reaches from i, j, k to i + 1, j + 1, k + 1.
struct light_grid {
    glm::vec4 anchor{0};         ///< xyz: in the middle of the cloud, m
    glm::vec4 row_x{1, 0, 0, 0}; ///< xyz: towards growing x, one over the voxel's width (1/m);
                                 ///< w: where the anchor is, in voxels
    glm::vec4 row_y{0, 1, 0, 0}; ///< the same for y: xyz points to the sun
    glm::vec4 row_z{0, 0, 1, 0}; ///< the same for z
    glm::vec4 voxel{1, 1, 1, 0}; ///< xyz: the sides of a voxel, m; w: one quantum of attenuation
};
static_assert(sizeof(light_grid) == 80);

/// A triangle that light meets. Its front is where a, b, c go round counter-clockwise.
struct gather_triangle {
    glm::vec3 a{0};             ///< m
    std::uint32_t material = 0; ///< index of a gather_material
    glm::vec3 b{0};             ///< m
    std::uint32_t alpha = 0;    ///< 0: no holes; n: the n-th alpha_coordinates (from 1) say where
    glm::vec3 c{0};             ///< m
    std::uint32_t reserved = 0;
};
static_assert(sizeof(gather_triangle) == 48);
static_assert(offsetof(gather_triangle, material) == 12 && offsetof(gather_triangle, b) == 16 &&
              offsetof(gather_triangle, alpha) == 28 && offsetof(gather_triangle, c) == 32);

/// What a surface does with light. Diffuse: both parts leave evenly in all directions.
struct gather_material {
    glm::vec3 diffuse{0.5f};     ///< reflected of what arrives, 0…1
    std::uint32_t two_sided = 0; ///< 1: the back reflects and emits as well; 0: it is black
    glm::vec3 emission{0};       ///< radiance that leaves by itself, W/(m² sr)
    float reserved0 = 0;
    glm::vec3 transmission{0}; ///< leaves on the other side, of what arrives, 0…1; needs two sides
    float reserved1 = 0;
};
static_assert(sizeof(gather_material) == 48);
static_assert(offsetof(gather_material, two_sided) == 12 &&
              offsetof(gather_material, emission) == 16 &&
              offsetof(gather_material, transmission) == 32);

/// Where a triangle's holes are: its corners' places in an alpha map, and where that map lies in
/// the same buffer of words: one word a texel, a float, row after row from `map` on. Places 0…1 are
/// edge to edge of the map and repeat beyond it; row 0 is v = 0. There is a hole where the nearest
/// texel is below `cutoff`.
struct alpha_coordinates {
    glm::vec2 a{0};
    glm::vec2 b{0};
    glm::vec2 c{0};
    std::uint32_t map = 0;  ///< index of the first texel's word
    std::uint32_t size = 0; ///< width + 65536 · height, texels
    float cutoff = 0.5f;
    std::uint32_t reserved[3] = {0, 0, 0};
};
static_assert(sizeof(alpha_coordinates) == 48);
static_assert(offsetof(alpha_coordinates, map) == 24 && offsetof(alpha_coordinates, cutoff) == 32);

/// A point that asks for light.
struct gather_sample {
    glm::vec3 position{0}; ///< m
    float reserved0 = 0;
    glm::vec3 normal{0}; ///< unit: it sees the half space that this points into
    float reserved1 = 0;
};
static_assert(sizeof(gather_sample) == 32);
static_assert(offsetof(gather_sample, normal) == 16);

/// What a sample meets along one direction.
struct gather_hit {
    float distance = 1e30f; ///< m; 1e30: nothing
    std::uint32_t surface =
        0xffffffffu; ///< 2 · triangle, + 1 where its back is seen; all bits: none
    float u = 0;     ///< barycentric weight of the triangle's b
    float v = 0;     ///< … and of its c
};
static_assert(sizeof(gather_hit) == 16);
inline constexpr std::uint32_t no_surface = 0xffffffffu;
inline constexpr float no_distance = 1e30f;

/// Rays that are all parallel: one direction for all samples (Hachisuka 2005, "global ray bundle").
/// What lies across it is measured from the middle of the scene: x and y in metres, z towards
/// growing distance; the scene's x and y lie in −half … half.
struct ray_bundle {
    glm::vec4 centre{0};             ///< xyz: middle of the scene, m; w: half, m
    glm::vec4 right{1, 0, 0, 0};     ///< xyz: unit, +x; w: the lift: how far, in m, samples stand
                                     ///< off along their normals
    glm::vec4 up{0, 1, 0, 0};        ///< xyz: unit, +y; w: cells of the finest grid in a metre
    glm::vec4 direction{0, 0, 1, 0}; ///< xyz: unit, +z; w: cells on a side of the finest grid
};
static_assert(sizeof(ray_bundle) == 64);

/// Where the light that leaves a triangle is kept: patches, `rows`² equal triangles a side. Those
/// of the front begin at `front`, those of the back at `back`, or no_surface: the back is black.
struct patch_table {
    std::uint32_t front = 0;
    std::uint32_t back = no_surface;
    std::uint32_t rows = 1;
    std::uint32_t reserved = 0;
};
static_assert(sizeof(patch_table) == 16);

} // namespace skybark
