#pragma once
// The skeleton: what is known of a tree before it is meshed.
//
// Branch segments in flat arrays, sorted by level (all roots, then all their children, …), so that
// the children of one segment are consecutive and a pass over levels sees parents before children.
// Source: Akagi and Kitajima, section 2.1 (core length and radius, one parent, any number of
// children, orientation as a unit quaternion).

#include <skybark/core/result.hpp>

#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace skybark::trees {

/// Marks "no parent" and "no continuing child".
inline constexpr std::uint32_t none = 0xffffffffu;

/// One segment as a reader finds it, in any order: a straight piece of wood from `base` to `tip`.
struct segment {
    glm::vec3 base{0};           ///< m
    glm::vec3 tip{0};            ///< m
    float base_radius = 0;       ///< m, at `base`; matters where a branch starts
    float radius = 0;            ///< m, at `tip`
    std::uint32_t parent = none; ///< index of the parent in the same array, or `none`
};

/// A tree, or a whole stand of trees: every array has one entry a segment, in level order.
struct skeleton {
    std::vector<std::uint32_t> parent;      ///< index < own index, or `none` for a root
    std::vector<std::uint32_t> first_child; ///< children are consecutive: [first, first + count)
    std::vector<std::uint32_t> child_count;
    /// The child that shares its ring at this segment's tip, or `none`: where the two bases differ
    /// by a little (scans), the shared ring belongs at the tip.
    std::vector<std::uint32_t> continuation;
    std::vector<glm::quat> orientation; ///< world space; local +Y runs from base to tip
    std::vector<glm::vec3> position;    ///< m, of the base
    std::vector<float> length;          ///< m
    std::vector<float> base_radius;     ///< m, at the base
    std::vector<float> radius;          ///< m, at the tip
    std::vector<std::uint32_t> levels; ///< level l is [levels[l], levels[l + 1]); size = levels + 1

    [[nodiscard]] std::size_t size() const noexcept { return parent.size(); }
    [[nodiscard]] bool empty() const noexcept { return parent.empty(); }
    /// The end of segment `i`: position + length along the orientation's +Y.
    [[nodiscard]] glm::vec3 tip(std::size_t i) const noexcept {
        return position[i] + orientation[i] * glm::vec3(0, length[i], 0);
    }
};

} // namespace skybark::trees
