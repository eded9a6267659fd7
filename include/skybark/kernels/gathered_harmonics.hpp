#pragma once
// gathered_harmonics: what the moments of a directional gather say.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/gathered_light.hpp>

namespace skybark::kernels {

/// Buffers: moments (directional_light's), three vec4s a sample, for red, green and blue; found, as
/// many: the coefficients c_m = ∫ L Y_m of the real spherical harmonics up to l = 1, in the order
/// 1, y, z, x, W/m². Maps over samples.
struct gathered_harmonics {
    using buffers = buffer_list<readonly<glm::vec4>, writeonly<glm::vec4>>;

    float each = 0; ///< solid angle that each direction stands for, sr

    void map(std::uint32_t i, std::span<const glm::vec4> moments,
             std::span<glm::vec4> found) const {
        for (std::size_t k = 3 * std::size_t{i}; k < 3 * std::size_t{i} + 3; ++k) {
            found[k] = shared::harmonics_of(moments[k], each);
        }
    }
};
static_assert(sizeof(gathered_harmonics) == 4);

} // namespace skybark::kernels
