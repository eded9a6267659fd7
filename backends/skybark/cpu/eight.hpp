#pragma once
// The formulas of shaders/shared/attenuation.glsl, eight at a time with AVX2.
//
// The operations and their order are those of the text, lane by lane, so the bits are the same (a
// test compares them). Both sides of a condition are computed, and chosen from.

#include <skybark/shared/attenuation.hpp>

#if defined(__GNUC__) && defined(__x86_64__)

#    define SKYBARK_HAS_EIGHT 1
#    include <immintrin.h>

namespace skybark::cpu::eight {

using f8 = __m256;
using i8 = __m256i;

[[gnu::target("avx2")]] inline f8 splat(float x) { return _mm256_set1_ps(x); }
[[gnu::target("avx2")]] inline f8 times(f8 a, f8 b) { return _mm256_mul_ps(a, b); }
[[gnu::target("avx2")]] inline f8 plus(f8 a, f8 b) { return _mm256_add_ps(a, b); }
[[gnu::target("avx2")]] inline f8 minus(f8 a, f8 b) { return _mm256_sub_ps(a, b); }
[[gnu::target("avx2")]] inline f8 over(f8 a, f8 b) { return _mm256_div_ps(a, b); }
/// Lanes of `yes` where the mask's sign bits are set.
[[gnu::target("avx2")]] inline f8 choose(f8 mask, f8 yes, f8 no) {
    return _mm256_blendv_ps(no, yes, mask);
}
[[gnu::target("avx2")]] inline f8 less(f8 a, f8 b) { return _mm256_cmp_ps(a, b, _CMP_LT_OQ); }

/// 1 + r · (1/n) · p
[[gnu::target("avx2")]] inline f8 next_term(f8 r, float n, f8 p) {
    return plus(splat(1.0f), times(times(r, splat(1.0f / n)), p));
}

[[gnu::target("avx2")]] inline f8 exp_minus(f8 x) {
    const f8 within = _mm256_min_ps(splat(87.0f), x);
    const f8 halvings = _mm256_floor_ps(plus(times(within, splat(1.44269504f)), splat(0.5f)));
    f8 r = minus(times(halvings, splat(0.693145752f)), within);
    r = plus(r, times(halvings, splat(1.42860677e-6f)));
    f8 p = plus(splat(1.0f), times(r, splat(1.0f / 7.0f)));
    p = next_term(r, 6.0f, p);
    p = next_term(r, 5.0f, p);
    p = next_term(r, 4.0f, p);
    p = next_term(r, 3.0f, p);
    p = next_term(r, 2.0f, p);
    p = plus(splat(1.0f), times(r, p));
    const i8 exponent = _mm256_sub_epi32(_mm256_set1_epi32(127), _mm256_cvttps_epi32(halvings));
    const f8 power = _mm256_castsi256_ps(_mm256_slli_epi32(exponent, 23));
    return _mm256_and_ps(less(x, splat(87.0f)), times(p, power));
}

/// 1 − x · (1/n) · p
[[gnu::target("avx2")]] inline f8 falling_term(f8 x, float n, f8 p) {
    return minus(splat(1.0f), times(times(x, splat(1.0f / n)), p));
}

[[gnu::target("avx2")]] inline f8 one_minus_exp(f8 x) {
    f8 p = minus(splat(1.0f), times(x, splat(1.0f / 9.0f)));
    p = falling_term(x, 8.0f, p);
    p = falling_term(x, 7.0f, p);
    p = falling_term(x, 6.0f, p);
    p = falling_term(x, 5.0f, p);
    p = falling_term(x, 4.0f, p);
    p = falling_term(x, 3.0f, p);
    p = falling_term(x, 2.0f, p);
    return choose(less(x, splat(0.5f)), times(x, p), minus(splat(1.0f), exp_minus(x)));
}

[[gnu::target("avx2")]] inline f8 log_of_sum(f8 sum, f8 less_one) {
    const f8 reduced = _mm256_or_ps(less(less_one, splat(-0.25f)), less(splat(0.4f), less_one));
    const i8 bits = _mm256_castps_si256(_mm256_max_ps(splat(1.2e-38f), sum));
    const i8 power = _mm256_srai_epi32(_mm256_sub_epi32(bits, _mm256_set1_epi32(0x3f3504f3)), 23);
    const f8 mantissa = _mm256_castsi256_ps(_mm256_sub_epi32(bits, _mm256_slli_epi32(power, 23)));
    const f8 twos = _mm256_and_ps(reduced, _mm256_cvtepi32_ps(power));
    const f8 part = choose(reduced, minus(mantissa, splat(1.0f)), less_one);
    const f8 s = over(part, plus(splat(2.0f), part));
    const f8 s2 = times(s, s);
    f8 p = plus(times(s2, splat(1.0f / 11.0f)), splat(1.0f / 9.0f));
    p = plus(times(s2, p), splat(1.0f / 7.0f));
    p = plus(times(s2, p), splat(1.0f / 5.0f));
    p = plus(times(s2, p), splat(1.0f / 3.0f));
    p = plus(times(s2, p), splat(1.0f));
    return plus(times(times(splat(2.0f), s), p), times(twos, splat(0.693147181f)));
}

[[gnu::target("avx2")]] inline f8 gaussian_above(f8 u) {
    const f8 sign = splat(-0.0f);
    const f8 x = times(_mm256_andnot_ps(sign, u), splat(0.707106781f));
    const f8 t = over(splat(1.0f), plus(splat(1.0f), times(splat(0.3275911f), x)));
    f8 p = minus(times(splat(1.061405429f), t), splat(1.453152027f));
    p = plus(times(p, t), splat(1.421413741f));
    p = minus(times(p, t), splat(0.284496736f));
    p = plus(times(p, t), splat(0.254829592f));
    const f8 tail = times(splat(0.5f), times(times(p, t), exp_minus(times(x, x))));
    return choose(less(u, splat(0.0f)), minus(splat(1.0f), tail), tail);
}

/// Whole numbers of quanta.
[[gnu::target("avx2")]] inline i8 quanta(f8 amount) {
    return _mm256_cvttps_epi32(_mm256_floor_ps(plus(amount, splat(0.5f))));
}

} // namespace skybark::cpu::eight

#endif
