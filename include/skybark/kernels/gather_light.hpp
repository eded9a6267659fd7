#pragma once
// gather_light: what each sample sees along one direction, added to what it has gathered.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/bundle.hpp>
#include <skybark/shared/gathered_light.hpp>

namespace skybark::kernels {

/// Buffers: samples; hits; tables, one a triangle; radiance, one vec4 a patch; sums, before and
/// after: the same buffer, where sample i has its vec4 at `first` + i: ΣL |n·d| in red, green and
/// blue, Σ|n·d|. Maps over samples. Where a sample meets nothing it sees the sky.
struct gather_light {
    using buffers =
        buffer_list<readonly<gather_sample>, readonly<gather_hit>, readonly<patch_table>,
                    readonly<glm::vec4>, readonly<glm::vec4>, writeonly<glm::vec4>>;

    glm::vec4 direction{0, 0, 1, 0}; ///< xyz: unit
    glm::vec4 sky_along{0};          ///< rgb: radiance of the sky in that direction, W/(m² sr)
    glm::vec4 sky_against{0};        ///< … and in the opposite one
    std::uint32_t first = 0;

    void map(std::uint32_t i, std::span<const gather_sample> samples,
             std::span<const gather_hit> hits, std::span<const patch_table> tables,
             std::span<const glm::vec4> radiance, std::span<const glm::vec4> before,
             std::span<glm::vec4> sums) const {
        const glm::vec3 normal = samples[i].normal;
        const glm::vec4 seen = light_seen(hits[i], normal, tables, radiance);
        sums[first + i] = shared::light_sum(before[first + i], seen,
                                            shared::weight_of_sample(samples[i], direction));
    }

    /// 1: such a sample looks along the direction; −1: against it.
    [[nodiscard]] float side_of(glm::vec3 normal) const {
        const float along =
            (normal.x * direction.x + normal.y * direction.y) + normal.z * direction.z;
        return along >= 0.0f ? 1.0f : -1.0f;
    }

    /// What a sample of this normal sees where it meets that.
    [[nodiscard]] glm::vec4 light_seen(const gather_hit& hit, glm::vec3 normal,
                                       std::span<const patch_table> tables,
                                       std::span<const glm::vec4> radiance) const {
        if (hit.surface == no_surface) {
            return side_of(normal) > 0.0f ? sky_along : sky_against;
        }
        const patch_table table = tables[hit.surface / 2];
        const std::uint32_t patches = hit.surface % 2 == 0 ? table.front : table.back;
        return patches == no_surface
                   ? glm::vec4(0)
                   : radiance[patches + shared::patch_at(table.rows, hit.u, hit.v)];
    }
};
static_assert(sizeof(gather_light) == 52);

} // namespace skybark::kernels
