#pragma once
// Where the segments of a skeleton are when each has turned about its base, in double precision.

#include <skybark/core/records.hpp>
#include <skybark/trees/skeleton.hpp>

#include "support/random.hpp"

#include <glm/gtc/quaternion.hpp>
#include <vector>

namespace skybark::support {

/// `turns[i]`: by how much segment i has turned about its base against its parent, as seen in the
/// world at rest. Parents carry their children along.
[[nodiscard]] inline std::vector<segment_pose> posed(const trees::skeleton& tree,
                                                     const std::vector<glm::dquat>& turns) {
    std::vector<segment_pose> poses(tree.size());
    std::vector<glm::dquat> rotation(tree.size());
    std::vector<glm::dvec3> shift(tree.size());
    for (std::size_t i = 0; i < tree.size(); ++i) {
        const std::uint32_t p = tree.parent[i];
        rotation[i] = turns[i];
        shift[i] = glm::dvec3(0);
        if (p != trees::none) {
            const glm::dvec3 arm = glm::dvec3(tree.position[i]) - glm::dvec3(tree.position[p]);
            rotation[i] = glm::normalize(rotation[p] * turns[i]);
            shift[i] = shift[p] + (rotation[p] * arm - arm);
        }
        poses[i].rotation = glm::vec4(rotation[i].x, rotation[i].y, rotation[i].z, rotation[i].w);
        poses[i].base = tree.position[i];
        poses[i].shift = glm::vec3(shift[i]);
    }
    return poses;
}

/// Every joint turned by up to `most_angle` rad about any axis.
[[nodiscard]] inline std::vector<segment_pose> random_poses(const trees::skeleton& tree,
                                                            double most_angle, std::uint32_t seed) {
    random_source random(seed);
    std::vector<glm::dquat> turns(tree.size());
    for (glm::dquat& turn : turns) {
        const glm::dvec4 q = random.rotation(most_angle);
        turn = glm::dquat(q.w, q.x, q.y, q.z);
    }
    return posed(tree, turns);
}

} // namespace skybark::support
