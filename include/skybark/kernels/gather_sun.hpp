#pragma once
// gather_sun: direct light of one distant source: what arrives of it, where nothing is met
// towards it.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/gathered_light.hpp>

namespace skybark::kernels {

/// Buffers: samples; hits along `direction`; what arrives, a vec4 a sample as light_at_points finds
/// it, y: the part of the beam (any buffer where `dimmed` is 0: then all of it); direct light,
/// before and after: the same buffer, a vec4 a sample: irradiance, W/m². Maps over samples. Those
/// that face away gain nothing.
struct gather_sun {
    using buffers = buffer_list<readonly<gather_sample>, readonly<gather_hit>, readonly<glm::vec4>,
                                readonly<glm::vec4>, writeonly<glm::vec4>>;

    glm::vec4 direction{0, 0, 1, 0}; ///< xyz: unit, to the source
    glm::vec4 irradiance{0};         ///< rgb: across the beam, W/m²
    std::uint32_t dimmed = 0;        ///< 1: not all of it arrives

    void map(std::uint32_t i, std::span<const gather_sample> samples,
             std::span<const gather_hit> hits, std::span<const glm::vec4> arriving,
             std::span<const glm::vec4> before, std::span<glm::vec4> direct) const {
        const glm::vec3 n = samples[i].normal;
        const float along = (n.x * direction.x + n.y * direction.y) + n.z * direction.z;
        const bool lit = along > 0.0f && shared::weight_of_sample(samples[i], direction) > 0.0f &&
                         hits[i].surface == no_surface;
        const float part = dimmed != 0 ? arriving[i].y : 1.0f;
        direct[i] = before[i] + irradiance * (lit ? along * part : 0.0f);
    }
};
static_assert(sizeof(gather_sun) == 36);

} // namespace skybark::kernels
