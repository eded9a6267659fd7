#pragma once
// directional_light: what each sample sees along one direction, added to what it has gathered,
// and to the moments of it.

#include <skybark/core/kernel.hpp>
#include <skybark/kernels/gather_light.hpp>

namespace skybark::kernels {

/// Buffers: samples; hits; tables, one a triangle; radiance, one vec4 a patch; sums, before and
/// after: the same buffer, where sample i has its vec4 at `first` + i: ΣL |n·d| in red, green and
/// blue, Σ|n·d|; moments, before and after: the same buffer, three vec4s a sample, for red,
/// green and blue: the sum of what the directions bring, and of that times the direction's x, y, z
/// (the moments of the spherical harmonics up to l = 1). Maps over samples. Where a sample meets
/// nothing it sees the sky.
struct directional_light {
    using buffers = buffer_list<readonly<gather_sample>, readonly<gather_hit>,
                                readonly<patch_table>, readonly<glm::vec4>, readonly<glm::vec4>,
                                writeonly<glm::vec4>, readonly<glm::vec4>, writeonly<glm::vec4>>;

    glm::vec4 direction{0, 0, 1, 0}; ///< xyz: unit
    glm::vec4 sky_along{0};          ///< rgb: radiance of the sky in that direction, W/(m² sr)
    glm::vec4 sky_against{0};        ///< … and in the opposite one
    std::uint32_t first = 0;

    void map(std::uint32_t i, std::span<const gather_sample> samples,
             std::span<const gather_hit> hits, std::span<const patch_table> tables,
             std::span<const glm::vec4> radiance, std::span<const glm::vec4> before,
             std::span<glm::vec4> sums, std::span<const glm::vec4> moments_before,
             std::span<glm::vec4> moments) const {
        const gather_light looking{direction, sky_along, sky_against, first};
        const glm::vec3 normal = samples[i].normal;
        const float weight = shared::weight_of_sample(samples[i], direction);
        const glm::vec4 seen =
            weight > 0.0f ? looking.light_seen(hits[i], normal, tables, radiance) : glm::vec4(0);
        sums[first + i] = shared::light_sum(before[first + i], seen, weight);
        const float side = looking.side_of(normal);
        const std::size_t at = 3 * std::size_t{i};
        moments[at] = shared::moment_sum(moments_before[at], seen.x, direction, side);
        moments[at + 1] = shared::moment_sum(moments_before[at + 1], seen.y, direction, side);
        moments[at + 2] = shared::moment_sum(moments_before[at + 2], seen.z, direction, side);
    }
};
static_assert(sizeof(directional_light) == 52);

} // namespace skybark::kernels
