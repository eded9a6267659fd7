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

} // namespace skybark
