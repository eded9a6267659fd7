#pragma once
// billboard_depth: sort keys that put particles back to front.
// Source: Shimada et al. 2008, section 2.2.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/cloud_lighting.hpp>

namespace skybark::kernels {

/// Buffers: particles, keys, values. Maps over particles: sorting the pairs by growing key gives
/// the particles' numbers, the farthest from the eye first. By distance, so that turning the camera
/// changes nothing. A particle whose distance is not a number comes first or last.
struct billboard_depth {
    using buffers =
        buffer_list<readonly<cloud_particle>, writeonly<std::uint32_t>, writeonly<std::uint32_t>>;

    glm::vec4 eye{0}; ///< xyz: m

    void map(std::uint32_t i, std::span<const cloud_particle> particles,
             std::span<std::uint32_t> keys, std::span<std::uint32_t> order) const {
        const glm::vec3 d = particles[i].position - glm::vec3(eye);
        keys[i] = shared::farther_first(d.x * d.x + d.y * d.y + d.z * d.z);
        order[i] = i;
    }
};

} // namespace skybark::kernels
