#pragma once
// wave_wind: the air's velocity at places, as a mean and a sum of plane waves.
// Source: spectral representation of a random field (Shinozuka and Jan 1972, eq. 23).

#include <skybark/core/kernel.hpp>
#include <skybark/shared/wind.hpp>

namespace skybark::kernels {

static_assert(record<shared::wind_waves> && sizeof(shared::wind_waves) == 96);

/// Buffers: places (xyz m, w: factor of the mean there), waves in groups of four, their phases at
/// this moment (cycles, 0 … 1), air (xyz m/s, w: speed). Maps over places.
///
/// u = w · mean + Σ amplitude · cos 2π(phase − k · x), the waves of a group in four sums that are
/// added last. The same bits on every backend that doesn't fuse multiply-adds.
struct wave_wind {
    using buffers = buffer_list<readonly<glm::vec4>, readonly<shared::wind_waves>,
                                readonly<glm::vec4>, writeonly<glm::vec4>>;

    glm::vec4 mean{0};        ///< m/s, w unused
    std::uint32_t groups = 0; ///< of four waves, at most 65,535

    void map(std::uint32_t i, std::span<const glm::vec4> places,
             std::span<const shared::wind_waves> waves, std::span<const glm::vec4> phases,
             std::span<glm::vec4> air) const {
        const glm::vec4 place = places[i];
        shared::wind_sums sum{glm::vec4(0), glm::vec4(0), glm::vec4(0)};
        for (std::uint32_t g = 0; g < groups; ++g) {
            sum = shared::wind_add(sum, waves[g], phases[g], place);
        }
        air[i] = shared::wind_total(sum, mean, place.w);
    }
};

} // namespace skybark::kernels
