#pragma once
// bark, the three edges of a triangle at a time.
//
// Corners and edges lie in the lanes of one vector; the fourth is spare. The operations and their
// order are those of shaders/shared/bark.glsl, so the bits are the same as the plain kernel's (a
// test compares them). GCC's and clang's vector types; other compilers run the plain kernel.

#include <skybark/cpu/hermite_branch.hpp>
#include <skybark/kernels/bark.hpp>

#if defined(__GNUC__)

namespace skybark::cpu {
namespace lanes {

/// Lane k's successor around the triangle.
[[nodiscard]] inline f4 next(f4 v) { return __builtin_shufflevector(v, v, 1, 2, 0, 3); }
[[nodiscard]] inline v3 next(v3 v) { return {next(v.x), next(v.y), next(v.z)}; }

[[nodiscard]] inline f4 dot(v3 a, v3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
[[nodiscard]] inline v3 choose(i4 mask, v3 yes, v3 no) {
    return {choose(mask, yes.x, no.x), choose(mask, yes.y, no.y), choose(mask, yes.z, no.z)};
}
[[nodiscard]] inline v3 unit_or_itself(v3 v) {
    const f4 l2 = dot(v, v);
    return choose(l2 > splat(1e-30f), v * (1.0f / square_root(l2)), v);
}

/// floor: from 2^23 on, floats are whole.
[[nodiscard]] inline f4 floor(f4 v) {
    const f4 whole = __builtin_convertvector(__builtin_convertvector(v, i4), f4);
    const f4 low = choose(whole > v, whole - 1.0f, whole);
    return choose((v < splat(8388608.0f)) & (v > splat(-8388608.0f)), low, v);
}

/// Bits 0 … 2: which of the first three lanes are all ones.
[[nodiscard]] inline std::uint32_t first_three(i4 mask) {
#    if defined(__SSE2__)
    return static_cast<std::uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(mask))) & 7u;
#    else
    return (mask[0] != 0 ? 1u : 0u) | (mask[1] != 0 ? 2u : 0u) | (mask[2] != 0 ? 4u : 0u);
#    endif
}

} // namespace lanes

template <>
struct program<kernels::bark> : plain_program<kernels::bark> {
    using kernel_type = kernels::bark;
    using vertices_span = kernel_type::vertices_span;
    using indices_span = kernel_type::indices_span;
    using heights_span = kernel_type::heights_span;

    [[nodiscard]] static std::uint64_t count(const kernel_type& kernel, range elements,
                                             vertices_span vertices, indices_span indices,
                                             heights_span) {
        std::uint64_t triangles = 0;
        for (std::uint32_t i = elements.first; i < elements.first + elements.count; ++i) {
            lanes::f4 row[4];
            for (std::uint32_t k = 0; k < 3; ++k) {
                row[k] = lanes::load(&vertices[corner(kernel, i, k, indices)]);
            }
            row[3] = lanes::splat(0);
            lanes::transpose(row[0], row[1], row[2], row[3]);
            triangles += shared::bark_triangles(pattern({row[0], row[1], row[2]}, kernel));
        }
        return triangles;
    }

    template <class Sink>
    static void triangles(const kernel_type& kernel, range elements, Sink& sink,
                          vertices_span vertices, indices_span indices, heights_span heights) {
        static const corner_table table;
        for (std::uint32_t i = elements.first; i < elements.first + elements.count; ++i) {
            if (sink.room() < 4) {
                plain_program<kernel_type>::triangles(kernel, {i, 1}, sink, vertices, indices,
                                                      heights);
                continue;
            }
            points p;
            for (std::uint32_t k = 0; k < 3; ++k) {
                const surface_vertex* from = &vertices[corner(kernel, i, k, indices)];
                for (std::uint32_t row = 0; row < 3; ++row) {
                    p.rows[k][row] =
                        lanes::load(reinterpret_cast<const std::byte*>(from) + 16 * row);
                }
            }
            sink.skip(write(kernel, table, p, sink.place(), heights));
        }
    }

  private:
    /// shared::bark_corner of every pattern.
    struct corner_table {
        std::uint8_t codes[2][8][12];

        corner_table() {
            for (std::uint32_t i = 0; i < 2 * 8 * 12; ++i) {
                const std::uint32_t pattern = i / 12 % 8;
                const bool other = i >= 8 * 12;
                codes[i / 96][pattern][i % 12] = static_cast<std::uint8_t>(
                    shared::bark_corner(pattern, other, i % 12 / 3, i % 3));
            }
        }
    };

    /// Corners and midpoints 0 … 5 as in memory: three vectors each.
    struct points {
        lanes::f4 rows[6][3];
    };

    [[nodiscard]] static std::uint32_t corner(const kernel_type& kernel, std::uint32_t i,
                                              std::uint32_t k, indices_span indices) {
        return kernel.indexed != 0 ? kernel.base_vertex + indices[3 * i + k] : 3 * i + k;
    }

    [[nodiscard]] static std::uint32_t pattern(const lanes::v3& position,
                                               const kernel_type& kernel) {
        const lanes::v3 d = lanes::next(position) - position;
        return lanes::first_three(lanes::dot(d, d) >
                                  lanes::splat(kernel.threshold * kernel.threshold));
    }

    /// Writes the triangles of one, and says how many.
    [[nodiscard]] static std::uint32_t write(const kernel_type& kernel, const corner_table& table,
                                             points& p, std::byte* to, heights_span heights) {
        using namespace lanes;
        f4 c[3][4]; // the corners' columns: x, y, z, u; normal, v; tangent, w
        for (std::uint32_t row = 0; row < 3; ++row) {
            for (std::uint32_t k = 0; k < 3; ++k) {
                c[row][k] = p.rows[k][row];
            }
            c[row][3] = splat(0);
            transpose(c[row][0], c[row][1], c[row][2], c[row][3]);
        }
        const std::uint32_t split = pattern({c[0][0], c[0][1], c[0][2]}, kernel);
        if (split == 0) {
            put(p, 0, 1, 2, to);
            return 1;
        }
        add_midpoints(kernel, c, p, heights);
        const std::uint32_t count = shared::bark_triangles(split);
        const bool other = count == 3 && other_diagonal(p, split);
        const std::uint8_t* code = table.codes[other ? 1 : 0][split];
        for (std::uint32_t t = 0; t < count; ++t) {
            put(p, code[3 * t], code[3 * t + 1], code[3 * t + 2],
                to + t * 3 * sizeof(surface_vertex));
        }
        return count;
    }

    static void put(const points& p, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                    std::byte* to) {
        float* out = reinterpret_cast<float*>(to);
        for (const std::uint32_t code : {a, b, c}) {
            for (const lanes::f4& row : p.rows[code]) {
                lanes::stream(out, row);
                out += 4;
            }
        }
    }

    [[nodiscard]] static bool other_diagonal(const points& p, std::uint32_t split) {
        const auto square = [&](bool other) {
            const std::uint32_t from = shared::bark_corner(split, other, 1, other ? 0 : 1);
            const std::uint32_t to = shared::bark_corner(split, other, 1, 2);
            const lanes::f4 d = p.rows[to][0] - p.rows[from][0];
            return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        };
        return square(true) < square(false);
    }

    /// shared::bark_middle and bark_raised for all three edges.
    static void add_midpoints(const kernel_type& kernel, const lanes::f4 (&c)[3][4], points& p,
                              heights_span heights) {
        using namespace lanes;
        const v3 p1{c[0][0], c[0][1], c[0][2]}, p2 = next(p1);
        const v3 n1{c[1][0], c[1][1], c[1][2]}, n2 = next(n1);
        const v3 t1{c[2][0], c[2][1], c[2][2]}, t2 = next(t1);
        const i4 in_order =
            (p1.x < p2.x) | ((p1.x == p2.x) & ((p1.y < p2.y) | ((p1.y == p2.y) & (p1.z < p2.z))));
        const v3 a = choose(in_order, p1, p2);
        const v3 b = choose(in_order, p2, p1);
        const v3 na = choose(in_order, n1, n2);
        const v3 nb = choose(in_order, n2, n1);

        const v3 middle = (p1 + p2) * splat(0.5f);
        const f4 u = (c[0][3] + next(c[0][3])) * 0.5f;
        const f4 v = (c[1][3] + next(c[1][3])) * 0.5f;
        const v3 n = unit_or_itself(n1 + n2);
        const v3 t = unit_or_itself(t1 + t2);
        const f4 w1 = c[2][3];
        const f4 w2 = next(w1);
        const f4 w = choose((w1 == splat(0)) | (w2 == splat(0)), splat(0), (w1 + w2) * 0.5f);

        const v3 ab = b - a;
        const heights_of_both h = both_heights(kernel, c[0][3], c[1][3], u, v, heights);
        const f4 most = splat(kernel.steepest) * square_root(dot(ab, ab));
        const f4 wanted = kernel.relief * (h.middles - 0.5f * (h.corners + next(h.corners)));
        const f4 rise = choose(wanted > most, most, choose(wanted < -most, -most, wanted));
        const v3 round = na * dot(ab, na) - nb * dot(ab, nb);
        const v3 raised = middle - round * splat(0.125f * kernel.rounding) + n * rise;
        const v3 position = choose(w == splat(0), middle, raised);

        f4 rows[3][4] = {
            {position.x, position.y, position.z, u}, {n.x, n.y, n.z, v}, {t.x, t.y, t.z, w}};
        for (std::uint32_t row = 0; row < 3; ++row) {
            transpose(rows[row][0], rows[row][1], rows[row][2], rows[row][3]);
            for (std::uint32_t k = 0; k < 3; ++k) {
                p.rows[3 + k][row] = rows[row][k];
            }
        }
    }

    /// The map's heights at the corners and at the midpoints.
    struct heights_of_both {
        lanes::f4 corners, middles;
    };
    [[nodiscard]] static heights_of_both both_heights(const kernel_type& kernel, lanes::f4 u,
                                                      lanes::f4 v, lanes::f4 middle_u,
                                                      lanes::f4 middle_v, heights_span heights) {
#    if defined(__x86_64__)
        if (__builtin_cpu_supports("avx2")) {
            return both_heights_avx2(kernel, u, v, middle_u, middle_v, heights);
        }
#    endif
        return {heights_at(kernel, u, v, heights), heights_at(kernel, middle_u, middle_v, heights)};
    }

#    if defined(__x86_64__)
    [[gnu::target("avx2")]] static __m256 texel_avx2(__m256 coordinate, std::uint32_t size) {
        const __m256 part = _mm256_sub_ps(coordinate, _mm256_floor_ps(coordinate));
        const __m256 zero = _mm256_setzero_ps();
        const __m256 sure =
            _mm256_and_ps(part, _mm256_and_ps(_mm256_cmp_ps(part, zero, _CMP_GE_OQ),
                                              _mm256_cmp_ps(part, _mm256_set1_ps(1), _CMP_LE_OQ)));
        const __m256 n = _mm256_set1_ps(static_cast<float>(size));
        const __m256 x = _mm256_sub_ps(_mm256_mul_ps(sure, n), _mm256_set1_ps(0.5f));
        return _mm256_blendv_ps(x, _mm256_add_ps(x, n), _mm256_cmp_ps(x, zero, _CMP_LT_OQ));
    }

    /// 0 in place of `size`.
    [[gnu::target("avx2")]] static __m256i wrapped_avx2(__m256i at, std::uint32_t size) {
        const __m256i n = _mm256_set1_epi32(static_cast<std::int32_t>(size));
        return _mm256_and_si256(at, _mm256_cmpgt_epi32(n, at));
    }

    [[gnu::target("avx2")]] static __m256 mix_avx2(__m256 a, __m256 b, __m256 t) {
        return _mm256_add_ps(a, _mm256_mul_ps(_mm256_sub_ps(b, a), t));
    }

    [[gnu::target("avx2")]] static __m256 pair_avx2(lanes::f4 a, lanes::f4 b) {
        return _mm256_set_m128(reinterpret_cast<__m128>(b), reinterpret_cast<__m128>(a));
    }

    [[gnu::target("avx2")]] static heights_of_both
    both_heights_avx2(const kernel_type& kernel, lanes::f4 u, lanes::f4 v, lanes::f4 middle_u,
                      lanes::f4 middle_v, heights_span heights) {
        const __m256 x =
            texel_avx2(_mm256_mul_ps(pair_avx2(u, middle_u), _mm256_set1_ps(kernel.repeats_around)),
                       kernel.width);
        const __m256 y =
            texel_avx2(_mm256_mul_ps(pair_avx2(v, middle_v), _mm256_set1_ps(kernel.repeats_along)),
                       kernel.height);
        const __m256 left = _mm256_floor_ps(x);
        const __m256 low = _mm256_floor_ps(y);
        const __m256i one = _mm256_set1_epi32(1);
        const __m256i width = _mm256_set1_epi32(static_cast<std::int32_t>(kernel.width));
        const __m256i x0 = wrapped_avx2(_mm256_cvttps_epi32(left), kernel.width);
        const __m256i x1 = wrapped_avx2(_mm256_add_epi32(x0, one), kernel.width);
        const __m256i y0 = wrapped_avx2(_mm256_cvttps_epi32(low), kernel.height);
        const __m256i y1 = wrapped_avx2(_mm256_add_epi32(y0, one), kernel.height);
        const __m256i row0 = _mm256_mullo_epi32(y0, width);
        const __m256i row1 = _mm256_mullo_epi32(y1, width);
        const float* map = heights.data();
        const __m256 h00 = _mm256_i32gather_ps(map, _mm256_add_epi32(row0, x0), 4);
        const __m256 h10 = _mm256_i32gather_ps(map, _mm256_add_epi32(row0, x1), 4);
        const __m256 h01 = _mm256_i32gather_ps(map, _mm256_add_epi32(row1, x0), 4);
        const __m256 h11 = _mm256_i32gather_ps(map, _mm256_add_epi32(row1, x1), 4);
        const __m256 tx = _mm256_sub_ps(x, left);
        const __m256 h =
            mix_avx2(mix_avx2(h00, h10, tx), mix_avx2(h01, h11, tx), _mm256_sub_ps(y, low));
        return {reinterpret_cast<lanes::f4>(_mm256_castps256_ps128(h)),
                reinterpret_cast<lanes::f4>(_mm256_extractf128_ps(h, 1))};
    }
#    endif

    /// shared::bark_texel.
    [[nodiscard]] static lanes::f4 texel(lanes::f4 coordinate, std::uint32_t size) {
        using namespace lanes;
        const f4 part = coordinate - floor(coordinate);
        const f4 sure = choose((part >= splat(0)) & (part <= splat(1)), part, splat(0));
        const float n = static_cast<float>(size);
        const f4 x = sure * n - 0.5f;
        return choose(x < splat(0), x + n, x);
    }

    /// kernels::bark::height_at in the first three lanes.
    [[nodiscard]] static lanes::f4 heights_at(const kernel_type& kernel, lanes::f4 u, lanes::f4 v,
                                              heights_span heights) {
        using namespace lanes;
        const f4 x = texel(u * kernel.repeats_around, kernel.width);
        const f4 y = texel(v * kernel.repeats_along, kernel.height);
        const f4 left = floor(x);
        const f4 low = floor(y);
        const auto wrapped = [](i4 at, std::uint32_t size) {
            const auto n = static_cast<std::int32_t>(size);
            return at & (at < i4{n, n, n, n});
        };
        const i4 x0 = wrapped(__builtin_convertvector(left, i4), kernel.width);
        const i4 x1 = wrapped(x0 + 1, kernel.width);
        const i4 y0 = wrapped(__builtin_convertvector(low, i4), kernel.height);
        const i4 y1 = wrapped(y0 + 1, kernel.height);
        const auto gather = [&](i4 column, i4 row) {
            const auto at = [&](int k) {
                return heights[static_cast<std::size_t>(row[k]) * kernel.width +
                               static_cast<std::size_t>(column[k])];
            };
            return f4{at(0), at(1), at(2), 0};
        };
        const f4 h00 = gather(x0, y0);
        const f4 h10 = gather(x1, y0);
        const f4 h01 = gather(x0, y1);
        const f4 h11 = gather(x1, y1);
        const f4 tx = x - left;
        const f4 ty = y - low;
        const f4 bottom = h00 + (h10 - h00) * tx;
        const f4 top = h01 + (h11 - h01) * tx;
        return bottom + (top - bottom) * ty;
    }
};

} // namespace skybark::cpu

#endif
