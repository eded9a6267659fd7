#pragma once
// gathered_irradiance: what the sums of a final gather say.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/gathered_light.hpp>

#include <cmath>

namespace skybark::kernels {

/// Buffers: sums, `replicates` times `samples` vec4s (replicate after replicate: ΣL c in red, green
/// and blue, Σc with c = |n·d|); direct light, a vec4 a sample; found, a vec4 a sample: irradiance
/// E = π ΣL c / Σc over all replicates plus the direct light, W/m², and in w the standard error of
/// its luminance, by the spread of the replicates about the ratio (Cochran 1977, "Sampling
/// Techniques", 6.3: var E = n/(n−1) Σ(π L_j − E c_j)² / (Σc)²). Maps over samples. Without any
/// sums the irradiance is the direct light and the error 1e30.
struct gathered_irradiance {
    using buffers = buffer_list<readonly<glm::vec4>, readonly<glm::vec4>, writeonly<glm::vec4>>;

    std::uint32_t samples = 0;
    std::uint32_t replicates = 8; ///< ≥ 2

    void map(std::uint32_t i, std::span<const glm::vec4> sums, std::span<const glm::vec4> direct,
             std::span<glm::vec4> found) const {
        constexpr float pi = 3.14159265f;
        glm::vec4 all(0);
        for (std::uint32_t j = 0; j < replicates; ++j) {
            all += sums[std::size_t{j} * samples + i];
        }
        if (!(all.w > 0.0f)) {
            found[i] = glm::vec4(direct[i].x, direct[i].y, direct[i].z, 1e30f);
            return;
        }
        const float mean = shared::luminance_of(all) / all.w;
        float squares = 0;
        for (std::uint32_t j = 0; j < replicates; ++j) {
            const glm::vec4 one = sums[std::size_t{j} * samples + i];
            const float apart = shared::luminance_of(one) - mean * one.w;
            squares += apart * apart;
        }
        const auto n = static_cast<float>(replicates);
        const float scale = pi / all.w;
        found[i] =
            glm::vec4(all.x * scale + direct[i].x, all.y * scale + direct[i].y,
                      all.z * scale + direct[i].z, scale * std::sqrt(squares * n / (n - 1.0f)));
    }
};
static_assert(sizeof(gathered_irradiance) == 8);

} // namespace skybark::kernels
