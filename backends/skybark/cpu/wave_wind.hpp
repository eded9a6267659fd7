#pragma once
// wave_wind, four waves at a time; at two places at once where there is AVX2.
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
        std::uint32_t first = elements.first;
        const std::uint32_t last = elements.first + elements.count;
#    if defined(__x86_64__)
        if (__builtin_cpu_supports("avx2")) {
            for (; last - first >= 2; first += 2) {
                two_places_avx2(kernel, &places[first], waves, phases, &air[first]);
            }
        }
#    endif
        using namespace lanes;
        for (std::uint32_t i = first; i < last; ++i) {
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
#    if defined(__x86_64__)
    /// A group of waves beside itself, as the two places' lanes meet it.
    [[gnu::target("avx2")]] static __m256 twice(const glm::vec4& group) {
        return _mm256_broadcast_ps(reinterpret_cast<const __m128*>(&group));
    }
    [[gnu::target("avx2")]] static __m256 both(float a, float b) {
        return _mm256_set_m128(_mm_set1_ps(b), _mm_set1_ps(a));
    }

    [[gnu::target("avx2")]] static __m256 constant(float x) { return _mm256_set1_ps(x); }

    [[gnu::target("avx2")]] static __m256 wave_cosine_avx2(__m256 p) {
        const __m256 r = _mm256_sub_ps(p, _mm256_floor_ps(_mm256_add_ps(p, constant(0.5f))));
        const __m256 s = _mm256_mul_ps(r, r);
        __m256 h = _mm256_mul_ps(s, constant(0.0776559122767420f));
        h = _mm256_mul_ps(s, _mm256_add_ps(constant(-0.598290411283619f), h));
        h = _mm256_mul_ps(s, _mm256_add_ps(constant(2.55007738652892f), h));
        h = _mm256_mul_ps(s, _mm256_add_ps(constant(-5.16771007666832f), h));
        h = _mm256_mul_ps(r, _mm256_add_ps(constant(3.1415926400772f), h));
        return _mm256_sub_ps(constant(1.0f), _mm256_mul_ps(constant(2.0f), _mm256_mul_ps(h, h)));
    }

    [[gnu::target("avx2")]] static void two_places_avx2(const kernels::wave_wind& kernel,
                                                        const glm::vec4* place,
                                                        std::span<const shared::wind_waves> waves,
                                                        std::span<const glm::vec4> phases,
                                                        glm::vec4* air) {
        const __m256 px = both(place[0].x, place[1].x);
        const __m256 py = both(place[0].y, place[1].y);
        const __m256 pz = both(place[0].z, place[1].z);
        __m256 x = _mm256_setzero_ps();
        __m256 y = _mm256_setzero_ps();
        __m256 z = _mm256_setzero_ps();
        for (std::uint32_t g = 0; g < kernel.groups; ++g) {
            const shared::wind_waves& w = waves[g];
            const __m256 level =
                _mm256_add_ps(_mm256_mul_ps(twice(w.kx), px), _mm256_mul_ps(twice(w.ky), py));
            const __m256 along = _mm256_add_ps(level, _mm256_mul_ps(twice(w.kz), pz));
            const __m256 c = wave_cosine_avx2(_mm256_sub_ps(twice(phases[g]), along));
            x = _mm256_add_ps(x, _mm256_mul_ps(twice(w.ax), c));
            y = _mm256_add_ps(y, _mm256_mul_ps(twice(w.ay), c));
            z = _mm256_add_ps(z, _mm256_mul_ps(twice(w.az), c));
        }
        glm::vec4 sums[3][2];
        _mm256_storeu_ps(&sums[0][0].x, x);
        _mm256_storeu_ps(&sums[1][0].x, y);
        _mm256_storeu_ps(&sums[2][0].x, z);
        for (int i = 0; i < 2; ++i) {
            air[i] =
                shared::wind_total({sums[0][i], sums[1][i], sums[2][i]}, kernel.mean, place[i].w);
        }
    }
#    endif

    [[nodiscard]] static glm::vec4 as_vec4(lanes::f4 v) { return {v[0], v[1], v[2], v[3]}; }
};

} // namespace skybark::cpu

#endif
