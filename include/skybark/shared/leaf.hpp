// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 8bf5305fafffe4a9edde487a23ab311fb7e9b83b31826a50dac8f21ca2b84c6c
#pragma once

#include <skybark/shared/glsl.hpp>
#include <skybark/shared/quaternion.hpp>
#include <skybark/shared/pose.hpp>
#include <skybark/shared/frames.hpp>

namespace skybark::shared {

// One leaf: two half discs that meet at the midrib (Akagi and Kitajima, 3.4), carried by a segment,
// turned by the air, and thinned out with distance. + - * / sqrt and integers only; drivers may still
// multiply by constants in another order, so that backends differ by a few roundings.

// Random bits of a leaf, another set for each `salt` (lowbias32: Wellons 2018).
inline uint leaf_bits(uint seed, uint salt) {
    uint h = seed + (salt + 1u) * 0x9e3779b9u;
    h = (h ^ (h >> 16u)) * 0x7feb352du;
    h = (h ^ (h >> 15u)) * 0x846ca68bu;
    return h ^ (h >> 16u);
}

// 0 <= rank < 1: the leaves of lower rank stay longer as a tree gets far.
inline float leaf_rank(uint seed) { return float(leaf_bits(seed, 0u) >> 8u) * (1.0f / 16777216.0f); }

// sin(2 pi x) of a phase in 2^-32 turns: exactly periodic, absolute error below 2e-7.
inline float sine_of_phase(uint phase) {
    uint within = phase & 0x7fffffffu;
    uint quarter = within > 0x40000000u ? 0x80000000u - within : within;
    float s = sin_quarter(float(quarter >> 7u) * 1.8725352e-7f);
    return phase >= 0x80000000u ? -s : s;
}

// Oscillation `salt` of a leaf, -1 ... 1. The time is a phase as well, 2^32 to 64 s; a leaf makes
// 128 to 255 whole oscillations in that time, 2 to 4 a second.
inline float leaf_oscillation(uint seed, uint salt, uint time) {
    uint bits = leaf_bits(seed, salt);
    return sine_of_phase(time * (128u + (bits & 127u)) + bits);
}

// A leaf as these formulas take it: GLSL has no way to a member called `length`.
struct leaf_at_rest {
    vec3 position;
    float width;
    vec4 orientation;
    float along; // m, the leaf's length
    uint carrier;
    uint seed;
    float fold;
};

// How leaves answer to the air. Tangents of half an angle, and the speed where half of it is seen.
struct leaf_response {
    uint time;
    float flutter;
    float flutter_speed; // m/s, above 0
    float lean;
    float lean_speed; // m/s, above 0
};

// The turn that leans direction d with the air, by its moment on the blade: the axis is
// d x velocity, and nothing is singular. Without wind it is (0, 0, 0, 1), bit for bit.
inline vec4 leaf_lean(leaf_response r, vec3 d, vec4 air) {
    float k = r.lean * air.w / (air.w * air.w + r.lean_speed * r.lean_speed);
    float x = k * (d.y * air.z - d.z * air.y);
    float y = k * (d.z * air.x - d.x * air.z);
    float z = k * (d.x * air.y - d.y * air.x);
    float f = 1.0f / sqrt(1.0f + (x * x + y * y + z * z));
    return vec4(x * f, y * f, z * f, f);
}

// The flutter in the leaf's own axes: a twist about the midrib and half as much nodding.
inline vec4 leaf_flutter(leaf_response r, uint seed, float speed) {
    float k = r.flutter * (speed * speed / (speed * speed + r.flutter_speed * r.flutter_speed));
    float y = k * (0.7f * leaf_oscillation(seed, 1u, r.time) +
                   0.3f * leaf_oscillation(seed, 2u, r.time));
    float x = k * (0.5f * leaf_oscillation(seed, 3u, r.time));
    float f = 1.0f / sqrt(1.0f + (x * x + y * y));
    return vec4(x * f, y * f, 0.0f, f);
}

// How much of a leaf is drawn.
struct leaf_detail {
    float scale; // of its length and width; 0: it is dropped
    float morph; // 0: octagon ... 1: the quadrilateral of the same area
};

// Stochastic simplification (Cook, Halstead, Planck and Ryu 2007). `seen` is the leaf's size on the
// screen in pixels, and from `full` on all is there. Below, nu = 2 (seen / full)^2 falls: a leaf's
// area fades linearly from where its rank is half of nu to nothing where it is nu. What is left is
// enlarged by the reciprocal of the mean over all ranks, so that the area stays in expectation:
//   mean = 3/4 nu for nu <= 1,  1 - (1 - nu/2)^2 / nu for 1 <= nu <= 2.
// The number of leaves falls like the tree's area on the screen, down to one in 2048.
inline leaf_detail leaf_detail_of(float seen, float full, float quad, uint seed) {
    leaf_detail d;
    d.scale = 1.0f;
    d.morph = clamp(2.0f - seen / quad, 0.0f, 1.0f);
    float part = seen / full;
    float nu = max(2.0f * (part * part), 0.00048828125f);
    if (nu < 2.0f) {
        float rest = 1.0f - 0.5f * nu;
        float mean = nu <= 1.0f ? 0.75f * nu : 1.0f - rest * rest / nu;
        float area = clamp(2.0f * (nu - leaf_rank(seed)) / nu, 0.0f, 1.0f);
        d.scale = sqrt(area / mean);
    }
    return d;
}

// A leaf as it is now: its base, the axes of the two halves and of the midrib, scaled to half the
// width and half the length, and unit vectors for light.
struct leaf_frame {
    vec3 base;
    vec3 middle;      // half the length along the midrib
    vec3 right;       // half the width across, folded up
    vec3 left;        // the same, towards -x
    vec3 right_across;
    vec3 left_across; // towards growing u as well
    vec3 right_normal;
    vec3 left_normal;
    float axis;       // the corners on the axes and those between them, of a unit octagon
    float diagonal;
};

// Where the leaf's stalk begins, and how it is turned.
inline vec4 leaf_turn(leaf_at_rest l, segment_pose pose, vec4 air, leaf_response response) {
    vec4 q = quaternion_times(pose.rotation, l.orientation);
    vec4 leaning = leaf_lean(response, quaternion_y(q), air);
    return quaternion_times(quaternion_times(leaning, q),
                            leaf_flutter(response, l.seed, air.w));
}

inline leaf_frame leaf_frame_of(leaf_at_rest l, vec3 base, vec4 turn, leaf_detail detail) {
    leaf_frame f;
    vec3 x = quaternion_x(turn);
    vec3 y = quaternion_y(turn);
    vec3 z = quaternion_z(turn);
    // By half the angle: exactly 0 and 1 at no fold, and well conditioned up to a right angle.
    float half_fold = 0.5f * clamp(l.fold, -1.5707964f, 1.5707964f);
    float sine = half_fold < 0.0f ? -sin_quarter(-half_fold) : sin_quarter(half_fold);
    float up = 2.0f * sine * sqrt(1.0f - sine * sine);
    float level = 1.0f - 2.0f * (sine * sine);
    float half_width = 0.5f * l.width * detail.scale;
    float half_length = 0.5f * l.along * detail.scale;
    f.base = base;
    f.middle = y * half_length;
    f.right_across = x * level + z * up;
    f.left_across = x * level - z * up;
    f.right_normal = z * level - x * up;
    f.left_normal = z * level + x * up;
    f.right = f.right_across * half_width;
    f.left = f.left_across * -half_width;
    // Four times the product is the octagon's area: it stays 2 sqrt(2) while the corners between
    // the axes sink into the sides of the quadrilateral.
    f.axis = 1.0f + detail.morph * 0.18920712f;
    f.diagonal = 0.70710678f / f.axis;
    return f;
}

// Corner 0 ... 4 of a half, from the stalk to the tip.
inline surface_vertex leaf_vertex(leaf_frame f, bool left, uint corner) {
    surface_vertex s;
    bool between = (corner & 1u) == 1u;
    float across = between ? f.diagonal : (corner == 2u ? f.axis : 0.0f);
    float along = corner == 2u ? 0.0f : (between ? f.diagonal : f.axis);
    along = corner < 2u ? -along : along;
    vec3 side = left ? f.left : f.right;
    vec3 tangent = left ? f.left_across : f.right_across;
    s.position = f.base + (side * across + f.middle * (1.0f + along));
    s.u = left ? 0.5f - 0.5f * across : 0.5f + 0.5f * across;
    s.normal = left ? f.left_normal : f.right_normal;
    s.v = 0.5f + 0.5f * along;
    s.tangent = vec4(tangent.x, tangent.y, tangent.z, 1.0f);
    return s;
}

// The corner that vertex j of a half's strip is: 0 1 4 2 3, or 0 2 4 for the quadrilateral; for the
// left half from the tip, so that both wind counter-clockwise seen from above.
inline uint leaf_corner(uint j, bool left, bool quad) {
    uint even = j == 0u ? 0u : (j == 2u ? 4u : 3u);
    uint odd = j == 1u && !quad ? 1u : 2u;
    uint corner = (j & 1u) == 1u ? odd : even;
    return left ? 4u - corner : corner;
}

// Linear light from an sRGB texel (Chilliant's cubic, within 0.002).
inline float leaf_linear(float c) { return c * (c * (c * 0.305306011f + 0.682171111f) + 0.012522878f); }

// Light that leaves a thin leaf on the side of normal n, which looks at the eye: what falls on that
// side and is scattered back, and what falls on the other and comes through, yellower. (Leaves
// scatter about as much of the light forwards as back, and both ways diffusely: Jacquemoud and
// Baret 1990.) The ambients are those of n and of -n; `sun` is 0 in shadow and 1 in full light.
inline float leaf_lit(float reflected, float through, float sunlight, float facing, float ambient_here,
               float ambient_behind) {
    return reflected * (ambient_here + sunlight * max(facing, 0.0f)) +
           through * (ambient_behind + sunlight * max(-facing, 0.0f));
}

} // namespace skybark::shared
