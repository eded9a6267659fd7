#pragma once
// wave_wind, four waves at a time.
//
// The operations and their order are those of shaders/shared/wind.glsl, whose sums have four lanes
// already, so the bits are the same as the plain kernel's (a test compares them). GCC's and clang's
// vector types; other compilers run the plain kernel.

#include <skybark/cpu/bark.hpp> // lanes::floor
#include <skybark/kernels/wave_wind.hpp>

#if defined(__GNUC__)

namespace skybark::cpu {
namespace lanes {

/// shared::wave_cosine.
[[nodiscard]] inline f4 wave_cosine(f4 p) {
    const f4 r = p - floor(p + 0.5f);
    const f4 s = r * r;
    const f4 h =
        r * (3.1415926400772f +
             s * (-5.16771007666832f +
                  s * (2.55007738652892f + s * (-0.598290411283619f + s * 0.0776559122767420f))));
    return 1.0f - 2.0f * (h * h);
}

} // namespace lanes

template <>
struct program<kernels::wave_wind> : plain_program<kernels::wave_wind> {
    static void map(const kernels::wave_wind& kernel, range elements,
                    std::span<const glm::vec4> places, std::span<const shared::wind_waves> waves,
                    std::span<const glm::vec4> phases, std::span<glm::vec4> air) {
        using namespace lanes;
        for (std::uint32_t i = elements.first; i < elements.first + elements.count; ++i) {
            const glm::vec4 place = places[i];
            const f4 px = splat(place.x);
            const f4 py = splat(place.y);
            const f4 pz = splat(place.z);
            f4 x = splat(0);
            f4 y = splat(0);
            f4 z = splat(0);
            for (std::uint32_t g = 0; g < kernel.groups; ++g) {
                const shared::wind_waves& w = waves[g];
                const f4 c = wave_cosine(load(&phases[g]) -
                                         (load(&w.kx) * px + load(&w.ky) * py + load(&w.kz) * pz));
                x = x + load(&w.ax) * c;
                y = y + load(&w.ay) * c;
                z = z + load(&w.az) * c;
            }
            air[i] = shared::wind_total({as_vec4(x), as_vec4(y), as_vec4(z)}, kernel.mean, place.w);
        }
    }

  private:
    [[nodiscard]] static glm::vec4 as_vec4(lanes::f4 v) { return {v[0], v[1], v[2], v[3]}; }
};

} // namespace skybark::cpu

#endif
