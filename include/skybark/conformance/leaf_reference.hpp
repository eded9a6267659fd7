#pragma once
// Leaves in double precision, from what the kernel's documentation says: rotations by angle and
// axis, trigonometry by the library's, means by integrals.

#include <skybark/kernels/leaf_blade.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace skybark::conformance::reference {

struct leaf_corner {
    glm::dvec3 position{0}, normal{0}, tangent{0};
    double u = 0, v = 0;
};

/// Ten corners as the ring form has them: the right half from the stalk to the tip, then the left.
struct leaf_blade_now {
    std::array<leaf_corner, 10> corners;
    double scale = 1; ///< of length and width
    double morph = 0; ///< 1: a quadrilateral
};

[[nodiscard]] inline std::uint32_t leaf_random(std::uint32_t seed, std::uint32_t salt) {
    std::uint32_t h = seed + (salt + 1) * 0x9e3779b9u;
    h ^= h >> 16;
    h *= 0x7feb352du;
    h ^= h >> 15;
    h *= 0x846ca68bu;
    return h ^ h >> 16;
}

/// Oscillation `salt` of a leaf at a time in seconds.
[[nodiscard]] inline double leaf_oscillation(std::uint32_t seed, std::uint32_t salt,
                                             double seconds) {
    const std::uint32_t bits = leaf_random(seed, salt);
    const double cycles = 128 + (bits & 127u);
    const double turns = cycles * seconds / 64 + bits / 4294967296.0;
    return std::sin(2 * 3.14159265358979323846 * (turns - std::floor(turns)));
}

[[nodiscard]] inline glm::dquat quaternion_of(const glm::vec4& q) {
    return {double{q.w}, double{q.x}, double{q.y}, double{q.z}};
}
/// The turn about an axis whose length is the tangent of half the angle.
[[nodiscard]] inline glm::dquat turn_by_half_tangent(const glm::dvec3& axis) {
    const double t = glm::length(axis);
    return t > 0 ? glm::angleAxis(2 * std::atan(t), axis / t) : glm::dquat(1, 0, 0, 0);
}

/// The part of a leaf's area that is left, and the mean of it over all ranks: full where the rank
/// is below half of nu, none from nu on, linear between.
[[nodiscard]] inline double leaf_part(double nu, double rank) {
    return std::clamp((nu - rank) / (nu / 2), 0.0, 1.0);
}
[[nodiscard]] inline double mean_leaf_part(double nu) {
    const double breaks[] = {0, std::min(nu / 2, 1.0), std::min(nu, 1.0), 1};
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
        sum += (breaks[i + 1] - breaks[i]) *
               (leaf_part(nu, breaks[i]) + leaf_part(nu, breaks[i + 1])) / 2;
    }
    return sum;
}

[[nodiscard]] inline leaf_blade_now leaf_now(const kernels::leaf_blade& k, const leaf& l,
                                             const segment_pose& pose, const glm::vec4& air) {
    const double seconds = k.time / 4294967296.0 * 64;
    const glm::dquat carried = glm::normalize(quaternion_of(pose.rotation));
    const glm::dvec3 pivot(pose.base);
    const glm::dvec3 base =
        pivot + glm::dvec3(pose.shift) + carried * (glm::dvec3(l.position) - pivot);
    const glm::dquat grown = carried * glm::normalize(quaternion_of(l.orientation));

    const double speed = air.w;
    const glm::dvec3 along = grown * glm::dvec3(0, 1, 0);
    const double leaning = k.lean * speed / (speed * speed + std::pow(double{k.lean_speed}, 2));
    const glm::dquat lean = turn_by_half_tangent(leaning * glm::cross(along, glm::dvec3(air)));
    const double most =
        k.flutter * speed * speed / (speed * speed + std::pow(double{k.flutter_speed}, 2));
    const glm::dvec3 wave(
        0.5 * leaf_oscillation(l.seed, 3, seconds),
        0.7 * leaf_oscillation(l.seed, 1, seconds) + 0.3 * leaf_oscillation(l.seed, 2, seconds), 0);
    const glm::dquat turn = lean * grown * turn_by_half_tangent(most * wave);

    leaf_blade_now now;
    if (k.camera.w > 0) {
        const double distance = glm::distance(base, glm::dvec3(k.camera));
        const double seen = k.camera.w * std::sqrt(double{l.width} * l.length) / distance;
        const double nu = std::max(2 * std::pow(seen / k.full, 2), 1.0 / 2048);
        const double rank = (leaf_random(l.seed, 0) >> 8) / 16777216.0;
        now.scale = nu < 2 ? std::sqrt(leaf_part(nu, rank) / mean_leaf_part(nu)) : 1;
        now.morph = std::clamp(2 - seen / k.quad, 0.0, 1.0);
    }
    const double axis = 1 + now.morph * (std::pow(2.0, 0.25) - 1);
    const double diagonal = std::sqrt(0.5) / axis;
    const double across[] = {0, diagonal, axis, diagonal, 0};
    const double up[] = {-axis, -diagonal, 0, diagonal, axis};
    for (std::size_t i = 0; i < 10; ++i) {
        const double side = i < 5 ? 1 : -1;
        // The right half turns about -Y to rise, the left about +Y.
        const glm::dquat fold = glm::angleAxis(-side * l.fold, glm::dvec3(0, 1, 0));
        const glm::dvec3 flat(side * across[i % 5] * l.width / 2, 0, 0);
        const glm::dvec3 place = fold * flat + glm::dvec3(0, (1 + up[i % 5]) * l.length / 2, 0);
        now.corners[i] = {base + turn * place * now.scale, turn * (fold * glm::dvec3(0, 0, 1)),
                          turn * (fold * glm::dvec3(1, 0, 0)), 0.5 + 0.5 * side * across[i % 5],
                          0.5 + 0.5 * up[i % 5]};
    }
    return now;
}

} // namespace skybark::conformance::reference
