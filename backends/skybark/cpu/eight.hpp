#pragma once
// The formulas of shaders/shared/attenuation.glsl, eight at a time with AVX2, or four times eight.
//
// The operations and their order are those of the text, lane by lane, so the bits are the same (a
// test compares them). Both sides of a condition are computed, and chosen from. An exponential is
// one long chain of operations that wait for each other: four chains side by side take hardly
// longer than one.

#include <skybark/shared/attenuation.hpp>

#if defined(__GNUC__) && defined(__x86_64__)

#    define SKYBARK_HAS_EIGHT 1
#    include <immintrin.h>

namespace skybark::cpu::eight {

using f8 = __m256;
using i8 = __m256i;

/// Four vectors side by side.
struct f32 {
    f8 a, b, c, d;
};

// What both kinds of vectors can do. A mask is a vector whose lanes' sign bits say yes.
[[gnu::target("avx2"), gnu::always_inline]] inline f8 plus(f8 x, f8 y) {
    return _mm256_add_ps(x, y);
}
[[gnu::target("avx2"), gnu::always_inline]] inline f32 plus(f32 x, f32 y) {
    return {plus(x.a, y.a), plus(x.b, y.b), plus(x.c, y.c), plus(x.d, y.d)};
}
[[gnu::target("avx2"), gnu::always_inline]] inline f8 minus(f8 x, f8 y) {
    return _mm256_sub_ps(x, y);
}
[[gnu::target("avx2"), gnu::always_inline]] inline f32 minus(f32 x, f32 y) {
    return {minus(x.a, y.a), minus(x.b, y.b), minus(x.c, y.c), minus(x.d, y.d)};
}
[[gnu::target("avx2"), gnu::always_inline]] inline f8 times(f8 x, f8 y) {
    return _mm256_mul_ps(x, y);
}
[[gnu::target("avx2"), gnu::always_inline]] inline f32 times(f32 x, f32 y) {
    return {times(x.a, y.a), times(x.b, y.b), times(x.c, y.c), times(x.d, y.d)};
}
[[gnu::target("avx2"), gnu::always_inline]] inline f8 over(f8 x, f8 y) {
    return _mm256_div_ps(x, y);
}
[[gnu::target("avx2"), gnu::always_inline]] inline f32 over(f32 x, f32 y) {
    return {over(x.a, y.a), over(x.b, y.b), over(x.c, y.c), over(x.d, y.d)};
}
[[gnu::target("avx2"), gnu::always_inline]] inline f8 both(f8 x, f8 y) {
    return _mm256_and_ps(x, y);
}
[[gnu::target("avx2"), gnu::always_inline]] inline f32 both(f32 x, f32 y) {
    return {both(x.a, y.a), both(x.b, y.b), both(x.c, y.c), both(x.d, y.d)};
}
[[gnu::target("avx2"), gnu::always_inline]] inline f8 either(f8 x, f8 y) {
    return _mm256_or_ps(x, y);
}
[[gnu::target("avx2"), gnu::always_inline]] inline f32 either(f32 x, f32 y) {
    return {either(x.a, y.a), either(x.b, y.b), either(x.c, y.c), either(x.d, y.d)};
}
[[gnu::target("avx2"), gnu::always_inline]] inline f8 negative(f8 x) {
    return _mm256_xor_ps(x, _mm256_set1_ps(-0.0f));
}
[[gnu::target("avx2"), gnu::always_inline]] inline f32 negative(f32 x) {
    return {negative(x.a), negative(x.b), negative(x.c), negative(x.d)};
}
[[gnu::target("avx2"), gnu::always_inline]] inline f8 size_of(f8 x) {
    return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), x);
}
[[gnu::target("avx2"), gnu::always_inline]] inline f32 size_of(f32 x) {
    return {size_of(x.a), size_of(x.b), size_of(x.c), size_of(x.d)};
}
[[gnu::target("avx2"), gnu::always_inline]] inline f8 less(f8 x, f8 y) {
    return _mm256_cmp_ps(x, y, _CMP_LT_OQ);
}
[[gnu::target("avx2"), gnu::always_inline]] inline f32 less(f32 x, f32 y) {
    return {less(x.a, y.a), less(x.b, y.b), less(x.c, y.c), less(x.d, y.d)};
}
/// !(x >= y)
[[gnu::target("avx2"), gnu::always_inline]] inline f8 not_up_to(f8 x, f8 y) {
    return _mm256_cmp_ps(x, y, _CMP_NGE_UQ);
}
[[gnu::target("avx2"), gnu::always_inline]] inline f32 not_up_to(f32 x, f32 y) {
    return {not_up_to(x.a, y.a), not_up_to(x.b, y.b), not_up_to(x.c, y.c), not_up_to(x.d, y.d)};
}
[[gnu::target("avx2"), gnu::always_inline]] inline f8 choose(f8 mask, f8 yes, f8 no) {
    return _mm256_blendv_ps(no, yes, mask);
}
[[gnu::target("avx2"), gnu::always_inline]] inline f32 choose(f32 m, f32 yes, f32 no) {
    return {choose(m.a, yes.a, no.a), choose(m.b, yes.b, no.b), choose(m.c, yes.c, no.c),
            choose(m.d, yes.d, no.d)};
}
/// y < x ? y : x
[[gnu::target("avx2"), gnu::always_inline]] inline f8 least(f8 x, f8 y) {
    return _mm256_min_ps(y, x);
}
[[gnu::target("avx2"), gnu::always_inline]] inline f32 least(f32 x, f32 y) {
    return {least(x.a, y.a), least(x.b, y.b), least(x.c, y.c), least(x.d, y.d)};
}
/// x < y ? y : x
[[gnu::target("avx2"), gnu::always_inline]] inline f8 most(f8 x, f8 y) {
    return _mm256_max_ps(y, x);
}
[[gnu::target("avx2"), gnu::always_inline]] inline f32 most(f32 x, f32 y) {
    return {most(x.a, y.a), most(x.b, y.b), most(x.c, y.c), most(x.d, y.d)};
}
[[gnu::target("avx2"), gnu::always_inline]] inline f8 down(f8 x) { return _mm256_floor_ps(x); }
[[gnu::target("avx2"), gnu::always_inline]] inline f32 down(f32 x) {
    return {down(x.a), down(x.b), down(x.c), down(x.d)};
}
/// 2^−n for whole n from 0 to 126.
[[gnu::target("avx2"), gnu::always_inline]] inline f8 halved(f8 n) {
    const i8 exponent = _mm256_sub_epi32(_mm256_set1_epi32(127), _mm256_cvttps_epi32(n));
    return _mm256_castsi256_ps(_mm256_slli_epi32(exponent, 23));
}
[[gnu::target("avx2"), gnu::always_inline]] inline f32 halved(f32 n) {
    return {halved(n.a), halved(n.b), halved(n.c), halved(n.d)};
}
/// The power of two that brings x into [√½, √2) …
[[gnu::target("avx2"), gnu::always_inline]] inline i8 power_of(f8 x) {
    const i8 above = _mm256_sub_epi32(_mm256_castps_si256(x), _mm256_set1_epi32(0x3f3504f3));
    return _mm256_srai_epi32(above, 23);
}
/// … as a float …
[[gnu::target("avx2"), gnu::always_inline]] inline f8 twos(f8 x) {
    return _mm256_cvtepi32_ps(power_of(x));
}
[[gnu::target("avx2"), gnu::always_inline]] inline f32 twos(f32 x) {
    return {twos(x.a), twos(x.b), twos(x.c), twos(x.d)};
}
/// … and what it brings x to.
[[gnu::target("avx2"), gnu::always_inline]] inline f8 without_twos(f8 x) {
    return _mm256_castsi256_ps(
        _mm256_sub_epi32(_mm256_castps_si256(x), _mm256_slli_epi32(power_of(x), 23)));
}
[[gnu::target("avx2"), gnu::always_inline]] inline f32 without_twos(f32 x) {
    return {without_twos(x.a), without_twos(x.b), without_twos(x.c), without_twos(x.d)};
}
/// Whether the mask says yes in every lane.
[[gnu::target("avx2"), gnu::always_inline]] inline bool all_of(f8 mask) {
    return _mm256_movemask_ps(mask) == 0xff;
}
[[gnu::target("avx2"), gnu::always_inline]] inline bool all_of(f32 mask) {
    return all_of(both(both(mask.a, mask.b), both(mask.c, mask.d)));
}
template <class V>
[[gnu::target("avx2"), gnu::always_inline]] inline V splat(float x) {
    const f8 all = _mm256_set1_ps(x);
    if constexpr (sizeof(V) == sizeof(all)) {
        return all;
    } else {
        return {all, all, all, all};
    }
}

/// 1 + r · (1/n) · p
template <class V>
[[gnu::target("avx2"), gnu::always_inline]] inline V rising_term(V r, float n, V p) {
    return plus(splat<V>(1.0f), times(times(r, splat<V>(1.0f / n)), p));
}
/// 1 − x · (1/n) · p
template <class V>
[[gnu::target("avx2"), gnu::always_inline]] inline V falling_term(V x, float n, V p) {
    return minus(splat<V>(1.0f), times(times(x, splat<V>(1.0f / n)), p));
}

template <class V>
[[gnu::target("avx2"), gnu::always_inline]] inline V exp_minus(V x) {
    const V within = least(x, splat<V>(87.0f));
    const V halvings = down(plus(times(within, splat<V>(1.44269504f)), splat<V>(0.5f)));
    V r = minus(times(halvings, splat<V>(0.693145752f)), within);
    r = plus(r, times(halvings, splat<V>(1.42860677e-6f)));
    V p = plus(splat<V>(1.0f), times(r, splat<V>(1.0f / 7.0f)));
    p = rising_term(r, 6.0f, p);
    p = rising_term(r, 5.0f, p);
    p = rising_term(r, 4.0f, p);
    p = rising_term(r, 3.0f, p);
    p = rising_term(r, 2.0f, p);
    p = plus(splat<V>(1.0f), times(r, p));
    return both(less(x, splat<V>(87.0f)), times(p, halved(halvings)));
}

/// 1 − e^−x where x is less than ½.
template <class V>
[[gnu::target("avx2"), gnu::always_inline]] inline V one_minus_exp_of_small(V x) {
    V p = minus(splat<V>(1.0f), times(x, splat<V>(1.0f / 9.0f)));
    p = falling_term(x, 8.0f, p);
    p = falling_term(x, 7.0f, p);
    p = falling_term(x, 6.0f, p);
    p = falling_term(x, 5.0f, p);
    p = falling_term(x, 4.0f, p);
    p = falling_term(x, 3.0f, p);
    p = falling_term(x, 2.0f, p);
    return times(x, p);
}

/// The series of ln(1 + x) for x between −¼ and 0.4, or for mantissas of others.
template <class V>
[[gnu::target("avx2"), gnu::always_inline]] inline V log_series(V x) {
    const V s = over(x, plus(splat<V>(2.0f), x));
    const V s2 = times(s, s);
    V p = plus(times(s2, splat<V>(1.0f / 11.0f)), splat<V>(1.0f / 9.0f));
    p = plus(times(s2, p), splat<V>(1.0f / 7.0f));
    p = plus(times(s2, p), splat<V>(1.0f / 5.0f));
    p = plus(times(s2, p), splat<V>(1.0f / 3.0f));
    p = plus(times(s2, p), splat<V>(1.0f));
    return times(times(splat<V>(2.0f), s), p);
}

template <class V>
[[gnu::target("avx2"), gnu::always_inline]] inline V log_of_sum(V sum, V less_one) {
    const V reduced = either(less(less_one, splat<V>(-0.25f)), less(splat<V>(0.4f), less_one));
    const V positive = most(sum, splat<V>(1.2e-38f));
    const V part = choose(reduced, minus(without_twos(positive), splat<V>(1.0f)), less_one);
    return plus(log_series(part), times(both(reduced, twos(positive)), splat<V>(0.693147181f)));
}

/// ln(e^−tau + on). Thin particles, which most are, need no second exponential.
template <class V>
[[gnu::target("avx2"), gnu::always_inline]] inline V log_of_product(V tau, V on) {
    const V lost = one_minus_exp_of_small(tau);
    const V less_one = minus(on, lost);
    const V thin = both(less(tau, splat<V>(0.5f)),
                        both(less(splat<V>(-0.25f), less_one), less(less_one, splat<V>(0.4f))));
    if (all_of(thin)) {
        return plus(log_series(less_one), splat<V>(0.0f));
    }
    const V through = exp_minus(tau);
    const V whole_loss = choose(less(tau, splat<V>(0.5f)), lost, minus(splat<V>(1.0f), through));
    return log_of_sum(plus(through, on), minus(on, whole_loss));
}

template <class V>
[[gnu::target("avx2"), gnu::always_inline]] inline V gaussian_above(V u) {
    const V x = times(size_of(u), splat<V>(0.707106781f));
    const V t = over(splat<V>(1.0f), plus(splat<V>(1.0f), times(splat<V>(0.3275911f), x)));
    V p = minus(times(splat<V>(1.061405429f), t), splat<V>(1.453152027f));
    p = plus(times(p, t), splat<V>(1.421413741f));
    p = minus(times(p, t), splat<V>(0.284496736f));
    p = plus(times(p, t), splat<V>(0.254829592f));
    const V tail = times(splat<V>(0.5f), times(times(p, t), exp_minus(times(x, x))));
    return choose(less(u, splat<V>(0.0f)), minus(splat<V>(1.0f), tail), tail);
}

template <class V>
[[gnu::target("avx2"), gnu::always_inline]] inline V summable(V amount) {
    const V dark = both(less(splat<V>(0.0f), amount), splat<V>(67108864.0f));
    return choose(less(amount, splat<V>(2147483520.0f)), amount, dark);
}

/// Whole numbers of quanta.
[[gnu::target("avx2"), gnu::always_inline]] inline i8 quanta(f8 amount) {
    return _mm256_cvttps_epi32(down(plus(amount, _mm256_set1_ps(0.5f))));
}

} // namespace skybark::cpu::eight

#endif
