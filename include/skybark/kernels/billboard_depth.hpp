#pragma once
// billboard_depth: sort keys that put particles back to front.
// Source: Shimada et al. 2008, section 2.2.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/cloud_lighting.hpp>

namespace skybark::kernels {

/// Buffers: particles, their numbers in some order, keys. Maps over that order: sorting the numbers
/// by growing key puts the farthest from the eye first and leaves those that are equally far in the
/// order in which they were. By distance, so that turning the camera changes nothing. A particle
/// whose distance is not a number comes first or last.
struct billboard_depth {
    using buffers =
        buffer_list<readonly<cloud_particle>, readonly<std::uint32_t>, writeonly<std::uint32_t>>;

    glm::vec4 eye{0}; ///< xyz: m

    void map(std::uint32_t i, std::span<const cloud_particle> particles,
             std::span<const std::uint32_t> order, std::span<std::uint32_t> keys) const {
        const glm::vec3 d = particles[order[i]].position - glm::vec3(eye);
        keys[i] = shared::farther_first(d.x * d.x + d.y * d.y + d.z * d.z);
    }
};

} // namespace skybark::kernels
