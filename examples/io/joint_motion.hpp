#pragma once
// joint_motion: what a skeleton's poses are to a file that knows a hierarchy of joints.

#include <skybark/core/records.hpp>
#include <skybark/core/result.hpp>
#include <skybark/trees/skeleton.hpp>

#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

namespace skybark::io {

/// A joint at rest: the base of a segment, turned as the segment is.
struct joint {
    std::uint32_t parent = trees::none; ///< < own index, or `none`
    glm::vec3 base{0};                  ///< m
    glm::vec4 orientation{0, 0, 0, 1};  ///< unit quaternion x, y, z, w; local +Y is the growth
};

/// One joint a segment, in the skeleton's order: joint i is what segment_pose i moves.
[[nodiscard]] std::vector<joint> joints_of(const trees::skeleton& from);

/// Joints and their keys, each against its parent.
struct joint_motion {
    static constexpr std::uint32_t still = 0xffffffffu;

    std::vector<glm::vec3> rest_translation; ///< one a joint
    std::vector<glm::vec4> rest_rotation;    ///< one a joint: unit quaternion x, y, z, w
    std::vector<glm::mat4> inverse_bind;     ///< one a joint: from the world to the joint at rest

    std::uint32_t frames = 0;
    /// Where a joint's keys begin: track · frames; or `still`.
    std::vector<std::uint32_t> rotation_track;
    std::vector<std::uint32_t> translation_track;
    std::vector<glm::vec4> rotations;    ///< neighbours in time have the nearer of two signs
    std::vector<glm::vec3> translations; ///< of joints whose base leaves its place on the parent
};

/// Finds the keys. `poses` are frame after frame, one pose a joint each. A joint gets no track for
/// what it doesn't do: by 10⁻⁶ of the skeleton's extent at most what the tracks say differs from
/// the poses, however long the chain is, because each key is taken against what a player has found
/// for the parent.
/// Errors: a parent that doesn't come before its child, poses that are no whole frames, numbers
/// that aren't finite, a rotation without length.
[[nodiscard]] result<joint_motion> find_motion(std::span<const joint> joints,
                                               std::span<const segment_pose> poses);

} // namespace skybark::io
