#pragma once
// A band of a bundle's samples against the triangles over it, sixteen lanes at a time (AVX-512F).
//
// Small triangles: sixteen of them stand side by side, the samples of their cells go one by one
// into a queue of pairs, and sixteen pairs are tested at once. Wide triangles: each of their rows
// of cells is cut to what the triangle reaches there, and sixteen of its samples are tested at
// once.
//
// The operations and their order are those of shared/bundle.hpp, lane by lane, so the bits are the
// same (a test compares them); no product goes into a fused multiply-add, whatever the compiler is
// told. What those formulas need of triangles is made from them anew in each band: reading them is
// what costs, and what is made is larger than what it is made from.

#include <skybark/cpu/bundle_grid.hpp>
#include <skybark/kernels/bundle_hits.hpp>

#include <bit>
#include <cstring>

#if defined(__GNUC__) && defined(__x86_64__)

#    define SKYBARK_HAS_SIXTEEN 1
#    include <immintrin.h>

// GCC 12 takes the undefined vectors in its own intrinsics for a mistake (its bug 105593).
#    if !defined(__clang__)
#        pragma GCC diagnostic push
#        pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#        pragma GCC diagnostic ignored "-Wuninitialized"
#    endif

namespace skybark::cpu::bundles::sixteen {

using f16 = __m512;
using i16 = __m512i;
using mask = __mmask16;

inline constexpr std::uint32_t lanes = 16;

/// A product that no compiler adds to anything before it is rounded.
[[gnu::target("avx512f"), gnu::always_inline]] inline f16 times(f16 x, f16 y) {
    f16 product = _mm512_mul_ps(x, y);
    asm("" : "+v"(product));
    return product;
}
[[gnu::target("avx512f"), gnu::always_inline]] inline f16 plus(f16 x, f16 y) {
    return _mm512_add_ps(x, y);
}
[[gnu::target("avx512f"), gnu::always_inline]] inline f16 minus(f16 x, f16 y) {
    return _mm512_sub_ps(x, y);
}
[[gnu::target("avx512f"), gnu::always_inline]] inline f16 all(float x) { return _mm512_set1_ps(x); }
[[gnu::target("avx512f"), gnu::always_inline]] inline i16 all(std::uint32_t x) {
    return _mm512_set1_epi32(static_cast<int>(x));
}
[[gnu::target("avx512f"), gnu::always_inline]] inline i16 load(const std::uint32_t* from) {
    return _mm512_loadu_si512(from);
}
[[gnu::target("avx512f"), gnu::always_inline]] inline f16 load(const float* from) {
    return _mm512_loadu_ps(from);
}
[[gnu::target("avx512f"), gnu::always_inline]] inline i16 bits(f16 x) {
    return _mm512_castps_si512(x);
}
[[gnu::target("avx512f"), gnu::always_inline]] inline f16 floats(i16 x) {
    return _mm512_castsi512_ps(x);
}
[[gnu::target("avx512f"), gnu::always_inline]] inline f16 signs(f16 x) {
    return floats(_mm512_and_si512(bits(x), _mm512_set1_epi32(static_cast<int>(against))));
}
[[gnu::target("avx512f"), gnu::always_inline]] inline f16 turned(f16 x, f16 sign) {
    return floats(_mm512_xor_si512(bits(x), bits(sign)));
}
[[gnu::target("avx512f"), gnu::always_inline]] inline f16 size_of(f16 x) {
    return floats(_mm512_andnot_si512(_mm512_set1_epi32(static_cast<int>(against)), bits(x)));
}
[[gnu::target("avx512f"), gnu::always_inline]] inline i16 ascending() {
    return _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}
[[gnu::target("avx512f"), gnu::always_inline]] inline mask first_lanes(std::uint32_t count) {
    return static_cast<mask>(count >= lanes ? 0xffffu : (1u << count) - 1u);
}
/// The first or the second of each two of 32 floats.
[[gnu::target("avx512f"), gnu::always_inline]] inline f16 firsts(f16 low, f16 high) {
    return _mm512_permutex2var_ps(
        low, _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30), high);
}
[[gnu::target("avx512f"), gnu::always_inline]] inline f16 seconds(f16 low, f16 high) {
    return _mm512_permutex2var_ps(
        low, _mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31), high);
}

struct quad {
    f16 x, y, z, w;
};

/// Rows and columns of the four 4 × 4 matrices in corresponding quarters change places.
[[gnu::target("avx512f"), gnu::always_inline]] inline quad transposed(const quad& q) {
    const __m512d a = _mm512_castps_pd(_mm512_unpacklo_ps(q.x, q.y));
    const __m512d b = _mm512_castps_pd(_mm512_unpackhi_ps(q.x, q.y));
    const __m512d c = _mm512_castps_pd(_mm512_unpacklo_ps(q.z, q.w));
    const __m512d d = _mm512_castps_pd(_mm512_unpackhi_ps(q.z, q.w));
    return {_mm512_castpd_ps(_mm512_unpacklo_pd(a, c)), _mm512_castpd_ps(_mm512_unpackhi_pd(a, c)),
            _mm512_castpd_ps(_mm512_unpacklo_pd(b, d)), _mm512_castpd_ps(_mm512_unpackhi_pd(b, d))};
}

/// Four floats from each of the places (in floats) at[j], at[j + 4], at[j + 8], at[j + 12].
[[gnu::target("avx512f"), gnu::always_inline]] inline f16 fours(const float* from,
                                                                const std::uint64_t* at, int j) {
    f16 all_four = _mm512_castps128_ps512(_mm_loadu_ps(from + at[j]));
    all_four = _mm512_insertf32x4(all_four, _mm_loadu_ps(from + at[j + 4]), 1);
    all_four = _mm512_insertf32x4(all_four, _mm_loadu_ps(from + at[j + 8]), 2);
    return _mm512_insertf32x4(all_four, _mm_loadu_ps(from + at[j + 12]), 3);
}
/// Four floats from each of sixteen places: sixteen x, y, z, w.
[[gnu::target("avx512f"), gnu::always_inline]] inline quad gathered(const float* from,
                                                                    const std::uint64_t* at) {
    return transposed(
        {fours(from, at, 0), fours(from, at, 1), fours(from, at, 2), fours(from, at, 3)});
}

/// The bundle's numbers in all lanes.
struct frame {
    const ray_bundle* bundle;

    struct place {
        f16 x, y, z;
    };

    [[gnu::target("avx512f"), gnu::always_inline]] static f16 along(f16 x, f16 y, f16 z,
                                                                    const glm::vec4& axis) {
        return plus(plus(times(x, all(axis.x)), times(y, all(axis.y))), times(z, all(axis.z)));
    }
    /// shared::across_bundle
    [[gnu::target("avx512f"), gnu::always_inline]] place across(const quad& q) const {
        const f16 x = minus(q.x, all(bundle->centre.x));
        const f16 y = minus(q.y, all(bundle->centre.y));
        const f16 z = minus(q.z, all(bundle->centre.z));
        return {along(x, y, z, bundle->right), along(x, y, z, bundle->up),
                along(x, y, z, bundle->direction)};
    }
    /// Its y alone.
    [[gnu::target("avx512f"), gnu::always_inline]] f16 height(const quad& q) const {
        const f16 x = minus(q.x, all(bundle->centre.x));
        const f16 y = minus(q.y, all(bundle->centre.y));
        const f16 z = minus(q.z, all(bundle->centre.z));
        return along(x, y, z, bundle->up);
    }
};

/// grid::cell
[[gnu::target("avx512f"), gnu::always_inline]] inline i16 cell(f16 place, float low, float scale,
                                                               std::uint32_t count) {
    const f16 cells = times(minus(place, all(low)), all(scale));
    const f16 most = all(static_cast<float>(count) - 0.5f);
    return _mm512_cvttps_epi32(_mm512_min_ps(_mm512_max_ps(cells, _mm512_setzero_ps()), most));
}

[[gnu::target("avx512f"), gnu::always_inline]] inline f16 least_of(f16 a, f16 b, f16 c) {
    return _mm512_min_ps(_mm512_min_ps(a, b), c);
}
[[gnu::target("avx512f"), gnu::always_inline]] inline f16 most_of(f16 a, f16 b, f16 c) {
    return _mm512_max_ps(_mm512_max_ps(a, b), c);
}

/// shared::place for `count` samples, and the band that each is in.
[[gnu::target("avx512f")]] inline void place_samples(const ray_bundle& bundle, const grid& g,
                                                     const gather_sample* samples,
                                                     std::uint32_t first, std::uint32_t count,
                                                     placed_sample* placed, std::uint32_t* bands) {
    const frame f{&bundle};
    const auto* from = reinterpret_cast<const float*>(samples + first);
    for (std::uint32_t i = 0; i < count; i += lanes) {
        std::uint64_t at[lanes];
        for (std::uint32_t j = 0; j < lanes; ++j) {
            at[j] = 8 * std::uint64_t{std::min(i + j, count - 1)};
        }
        const quad position = gathered(from, at);
        const quad normal = gathered(from + 4, at);
        const f16 lift = all(bundle.right.w);
        const auto origin = f.across({plus(position.x, times(lift, normal.x)),
                                      plus(position.y, times(lift, normal.y)),
                                      plus(position.z, times(lift, normal.z)), lift});
        const f16 towards = frame::along(normal.x, normal.y, normal.z, bundle.direction);
        const mask with = _mm512_cmp_ps_mask(towards, _mm512_setzero_ps(), _CMP_GE_OQ);
        i16 number = _mm512_add_epi32(ascending(), all(first + i));
        number = _mm512_mask_or_epi32(number, static_cast<mask>(~with), number, all(against));
        // Both have room for whole sixteens.
        const i16 row = cell(origin.y, g.bottom, g.scale, g.rows);
        _mm512_storeu_si512(bands + i, _mm512_i32gather_epi32(row, g.band_of_row.data(), 4));
        const quad four = transposed({origin.x, origin.y, origin.z, floats(number)});
        const f16 of[4] = {four.x, four.y, four.z, four.w};
        for (std::uint32_t j = 0; j < 4; ++j) {
            auto* const to = reinterpret_cast<float*>(placed + i + j);
            _mm_storeu_ps(to, _mm512_castps512_ps128(of[j]));
            _mm_storeu_ps(to + 16, _mm512_extractf32x4_ps(of[j], 1));
            _mm_storeu_ps(to + 32, _mm512_extractf32x4_ps(of[j], 2));
            _mm_storeu_ps(to + 48, _mm512_extractf32x4_ps(of[j], 3));
        }
    }
}

/// Which bands triangles [first, first + count) may have samples in. `ranges` has room for whole
/// sixteens.
[[gnu::target("avx512f")]] inline void band_ranges(const ray_bundle& bundle, const grid& g,
                                                   const gather_triangle* triangles,
                                                   std::uint32_t first, std::uint32_t count,
                                                   band_range* ranges) {
    const frame f{&bundle};
    const auto* from = reinterpret_cast<const float*>(triangles + first);
    const f16 slack = all(shared::meeting_slack(bundle));
    for (std::uint32_t i = 0; i < count; i += lanes) {
        std::uint64_t at[lanes];
        for (std::uint32_t j = 0; j < lanes; ++j) {
            at[j] = 12 * std::uint64_t{std::min(i + j, count - 1)};
        }
        const f16 a = f.height(gathered(from, at));
        const f16 b = f.height(gathered(from + 4, at));
        const f16 c = f.height(gathered(from + 8, at));
        const i16 low = cell(minus(least_of(a, b, c), slack), g.bottom, g.scale, g.rows);
        const i16 high = cell(plus(most_of(a, b, c), slack), g.bottom, g.scale, g.rows);
        const i16 first_band = _mm512_i32gather_epi32(low, g.band_of_row.data(), 4);
        const i16 last_band = _mm512_i32gather_epi32(high, g.band_of_row.data(), 4);
        _mm512_storeu_si512(ranges + first + i,
                            _mm512_or_si512(first_band, _mm512_slli_epi32(last_band, 16)));
    }
}

/// Puts those of triangles [first, first + count) that reach over the band into `numbers`, which
/// has room for sixteen more, and says how many.
[[gnu::target("avx512f,popcnt")]] inline std::uint32_t pick(const band_range* ranges,
                                                            std::uint32_t first,
                                                            std::uint32_t count, std::uint32_t band,
                                                            std::uint32_t* numbers) {
    const i16 low_half = _mm512_set1_epi32(0xffff);
    const i16 wanted = all(band);
    std::uint32_t found = 0;
    for (std::uint32_t i = 0; i < count; i += lanes) {
        const i16 range = _mm512_loadu_si512(ranges + first + i);
        mask in = _mm512_mask_cmple_epu32_mask(first_lanes(count - i),
                                               _mm512_and_si512(range, low_half), wanted);
        in = _mm512_mask_cmple_epu32_mask(in, wanted, _mm512_srli_epi32(range, 16));
        const i16 number = _mm512_add_epi32(ascending(), all(first + i));
        _mm512_storeu_si512(numbers + found, _mm512_maskz_compress_epi32(in, number));
        found += static_cast<std::uint32_t>(__builtin_popcount(in));
    }
    return found;
}

/// One band of samples.
class band_work {
  public:
    band_work(const ray_bundle& bundle, const grid& g, std::uint32_t band,
              std::span<const gather_triangle> triangles, std::span<const std::uint32_t> alpha,
              const band_memory& memory)
        : frame_{&bundle}, grid_(&g), triangles_(triangles), alpha_(alpha), memory_(memory),
          first_row_(g.first_row[band]), rows_(g.rows_of(band)),
          slack_(shared::meeting_slack(bundle)), lift_(bundle.right.w) {
        // As roundings displace an edge, by its triangle's reach: several times more than they do.
        margin_ = 4 * slack_;
    }

    /// Cells of samples that come in a row; they are `count` after those that came before.
    [[gnu::target("avx512f")]] void add_cells(std::span<const placed_sample> run) {
        for (std::size_t i = 0; i < run.size(); i += lanes) {
            const auto* from = reinterpret_cast<const float*>(run.data() + i);
            // Up to fifteen samples beyond the run are read; memory goes on that far.
            const quad q =
                transposed({load(from), load(from + 16), load(from + 32), load(from + 48)});
            const i16 column = cell(q.x, grid_->left, grid_->scale, grid_->columns);
            const i16 row = _mm512_sub_epi32(cell(q.y, grid_->bottom, grid_->scale, grid_->rows),
                                             all(first_row_));
            const i16 in_order =
                _mm512_setr_epi32(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15);
            const i16 at = _mm512_add_epi32(_mm512_mullo_epi32(row, all(grid_->columns)), column);
            _mm512_storeu_si512(memory_.cells + samples_ + i,
                                _mm512_permutexvar_epi32(in_order, at));
        }
        samples_ += static_cast<std::uint32_t>(run.size());
    }

    [[nodiscard]] std::uint32_t samples() const { return samples_; }

    /// Tests triangles of these numbers.
    [[gnu::target("avx512f,popcnt")]] void meet(const std::uint32_t* numbers, std::uint32_t count) {
        for (std::uint32_t i = 0; i < count; i += lanes) {
            meet_sixteen(numbers + i, std::min(count - i, lanes));
        }
    }

    /// Writes the hits of all samples.
    [[gnu::target("avx512f")]] void finish(gather_hit* hits) const {
        const auto* const from = reinterpret_cast<const float*>(triangles_.data());
        for (std::uint32_t k = 0; k < samples_; k += lanes) {
            const mask there = first_lanes(samples_ - k);
            const i16 triangle = load(memory_.nearest + k);
            const mask hit = _mm512_mask_cmpneq_epi32_mask(there, triangle, all(no_surface));
            quad out{all(no_distance), floats(all(no_surface)), all(0.0f), all(0.0f)};
            if (hit != 0) {
                alignas(64) std::uint32_t numbers[lanes];
                _mm512_store_si512(numbers, _mm512_maskz_mov_epi32(hit, triangle));
                const corners t = corners_at(from, numbers);
                const f16 xy0 = load(memory_.places + 2 * std::size_t{k});
                const f16 xy1 = load(memory_.places + 2 * std::size_t{k} + 16);
                const f16 zd0 = load(memory_.depths + 2 * std::size_t{k});
                const f16 zd1 = load(memory_.depths + 2 * std::size_t{k} + 16);
                const edges e = edges_of(t, firsts(xy0, xy1), seconds(xy0, xy1));
                const f16 area = plus(plus(e.a, e.b), e.c);
                const f16 depth = _mm512_div_ps(
                    plus(plus(times(e.a, t.az), times(e.b, t.bz)), times(e.c, t.cz)), area);
                const f16 side = signs(seconds(zd0, zd1));
                const f16 distance = turned(minus(depth, firsts(zd0, zd1)), side);
                const mask front =
                    _mm512_cmp_ps_mask(turned(area, side), _mm512_setzero_ps(), _CMP_LT_OQ);
                i16 surface = _mm512_add_epi32(triangle, triangle);
                surface =
                    _mm512_mask_or_epi32(surface, static_cast<mask>(~front), surface, all(1u));
                // Of two zeros the second comes out, with its sign, as from shared::max.
                out.x = _mm512_mask_max_ps(out.x, hit, _mm512_setzero_ps(), distance);
                out.y = _mm512_mask_mov_ps(out.y, hit, floats(surface));
                out.z = _mm512_mask_div_ps(out.z, hit, e.b, area);
                out.w = _mm512_mask_div_ps(out.w, hit, e.c, area);
            }
            store_hits(transposed(out), memory_.numbers + k, std::min(samples_ - k, lanes), hits);
        }
    }

  private:
    /// Columns and rows up to which triangles are tested by pairs.
    static constexpr std::uint32_t most_columns = 6;
    static constexpr std::uint32_t most_rows = 6;
    static constexpr std::uint32_t queue_size = 256;

    struct corners {
        f16 ax, ay, bx, by, cx, cy, az, bz, cz;
    };
    struct box {
        f16 low_x, high_x, low_y, high_y;
    };
    struct edges {
        f16 a, b, c;
    };

    /// Sixteen triangles in memory, and the pairs of them with samples that wait.
    struct alignas(64) block {
        float corner[9][lanes]; ///< as in corners
        float box[4][lanes];    ///< as in box
        std::uint32_t first_column[lanes], last_column[lanes];
        std::uint32_t first_row[lanes], last_row[lanes];
        std::uint32_t number[lanes];
        std::uint32_t alpha[lanes];
        std::uint32_t waiting = 0;
        std::uint32_t queued_lane[queue_size + lanes];
        std::uint32_t queued_sample[queue_size + lanes];
    };

    [[gnu::target("avx512f"), gnu::always_inline]] corners
    corners_at(const float* from, const std::uint32_t* numbers, f16* alpha = nullptr) const {
        std::uint64_t at[lanes];
        for (std::uint32_t j = 0; j < lanes; ++j) {
            at[j] = 12 * std::uint64_t{numbers[j]};
        }
        const auto a = frame_.across(gathered(from, at));
        const quad second = gathered(from + 4, at);
        const auto b = frame_.across(second);
        const auto c = frame_.across(gathered(from + 8, at));
        if (alpha != nullptr) {
            *alpha = second.w;
        }
        return {a.x, a.y, b.x, b.y, c.x, c.y, a.z, b.z, c.z};
    }

    /// As in shared::meet_triangle.
    [[gnu::target("avx512f"), gnu::always_inline]] static edges edges_of(const corners& t, f16 x,
                                                                         f16 y) {
        const f16 ax = minus(t.ax, x);
        const f16 ay = minus(t.ay, y);
        const f16 bx = minus(t.bx, x);
        const f16 by = minus(t.by, y);
        const f16 cx = minus(t.cx, x);
        const f16 cy = minus(t.cy, y);
        return {minus(times(bx, cy), times(by, cx)), minus(times(cx, ay), times(cy, ax)),
                minus(times(ax, by), times(ay, bx))};
    }
    [[gnu::target("avx512f"), gnu::always_inline]] static mask inside(const edges& e) {
        const f16 zero = _mm512_setzero_ps();
        mask up = _mm512_cmp_ps_mask(e.a, zero, _CMP_GE_OQ);
        up = _mm512_mask_cmp_ps_mask(up, e.b, zero, _CMP_GE_OQ);
        up = _mm512_mask_cmp_ps_mask(up, e.c, zero, _CMP_GE_OQ);
        mask down = _mm512_cmp_ps_mask(e.a, zero, _CMP_LE_OQ);
        down = _mm512_mask_cmp_ps_mask(down, e.b, zero, _CMP_LE_OQ);
        down = _mm512_mask_cmp_ps_mask(down, e.c, zero, _CMP_LE_OQ);
        return static_cast<mask>(up | down);
    }
    [[gnu::target("avx512f"), gnu::always_inline]] static mask within(mask of, const box& b, f16 x,
                                                                      f16 y) {
        mask in = _mm512_mask_cmp_ps_mask(of, x, b.low_x, _CMP_GE_OQ);
        in = _mm512_mask_cmp_ps_mask(in, x, b.high_x, _CMP_LE_OQ);
        in = _mm512_mask_cmp_ps_mask(in, y, b.low_y, _CMP_GE_OQ);
        return _mm512_mask_cmp_ps_mask(in, y, b.high_y, _CMP_LE_OQ);
    }

    /// Of the lanes whose edges meet: those that are as near as the nearest, and how far.
    struct met {
        mask near_enough;
        f16 distance;
        f16 area;
    };
    [[gnu::target("avx512f"), gnu::always_inline]] met
    nearest_of(mask of, const edges& e, f16 az, f16 bz, f16 cz, f16 z, f16 signed_nearest) const {
        const f16 zero = _mm512_setzero_ps();
        const f16 area = plus(plus(e.a, e.b), e.c);
        const f16 depth =
            _mm512_div_ps(plus(plus(times(e.a, az), times(e.b, bz)), times(e.c, cz)), area);
        const f16 side = signs(signed_nearest);
        const f16 distance = turned(minus(depth, z), side);
        const mask front = _mm512_cmp_ps_mask(turned(area, side), zero, _CMP_LT_OQ);
        const f16 least = _mm512_mask_mov_ps(all(0.5f * lift_), front, all(-0.5f * lift_));
        mask near_enough = _mm512_mask_cmp_ps_mask(of, area, zero, _CMP_NEQ_UQ);
        near_enough = _mm512_mask_cmp_ps_mask(near_enough, distance, least, _CMP_GT_OQ);
        const f16 counted = _mm512_max_ps(distance, zero);
        near_enough =
            _mm512_mask_cmp_ps_mask(near_enough, counted, size_of(signed_nearest), _CMP_LE_OQ);
        return {near_enough, counted, area};
    }

    [[gnu::target("avx512f,popcnt")]] void meet_sixteen(const std::uint32_t* numbers,
                                                        std::uint32_t count) {
        block b;
        for (std::uint32_t j = 0; j < lanes; ++j) {
            b.number[j] = numbers[std::min(j, count - 1)];
        }
        f16 alpha;
        const corners t =
            corners_at(reinterpret_cast<const float*>(triangles_.data()), b.number, &alpha);
        const f16 slack = all(slack_);
        const box around{
            minus(least_of(t.ax, t.bx, t.cx), slack), plus(most_of(t.ax, t.bx, t.cx), slack),
            minus(least_of(t.ay, t.by, t.cy), slack), plus(most_of(t.ay, t.by, t.cy), slack)};
        const i16 left = cell(around.low_x, grid_->left, grid_->scale, grid_->columns);
        const i16 right = cell(around.high_x, grid_->left, grid_->scale, grid_->columns);
        const i16 first = all(first_row_);
        i16 low = cell(around.low_y, grid_->bottom, grid_->scale, grid_->rows);
        i16 high = cell(around.high_y, grid_->bottom, grid_->scale, grid_->rows);
        low = _mm512_sub_epi32(_mm512_max_epi32(low, first), first);
        high = _mm512_min_epi32(_mm512_sub_epi32(high, first), all(rows_ - 1));
        const mask there = _mm512_mask_cmple_epi32_mask(first_lanes(count), low, high);
        const mask wide =
            static_cast<mask>(_mm512_mask_cmp_epi32_mask(there, _mm512_sub_epi32(right, left),
                                                         all(most_columns), _MM_CMPINT_NLT) |
                              _mm512_mask_cmp_epi32_mask(there, _mm512_sub_epi32(high, low),
                                                         all(most_rows), _MM_CMPINT_NLT));
        const f16 stored[9] = {t.ax, t.ay, t.bx, t.by, t.cx, t.cy, t.az, t.bz, t.cz};
        for (std::uint32_t n = 0; n < 9; ++n) {
            _mm512_store_ps(b.corner[n], stored[n]);
        }
        _mm512_store_ps(b.box[0], around.low_x);
        _mm512_store_ps(b.box[1], around.high_x);
        _mm512_store_ps(b.box[2], around.low_y);
        _mm512_store_ps(b.box[3], around.high_y);
        _mm512_store_ps(b.alpha, alpha);
        queue_narrow(b, static_cast<mask>(there & ~wide), left, right, low, high);
        if (wide != 0) {
            _mm512_store_si512(b.first_column, left);
            _mm512_store_si512(b.last_column, right);
            _mm512_store_si512(b.first_row, low);
            _mm512_store_si512(b.last_row, high);
            for (std::uint32_t rest = wide; rest != 0; rest &= rest - 1) {
                meet_wide(b, static_cast<std::uint32_t>(std::countr_zero(rest)));
            }
        }
    }

    /// Pairs of the triangles with all samples in the cells of their boxes.
    [[gnu::target("avx512f,popcnt")]] void queue_narrow(block& b, mask narrow, i16 left, i16 right,
                                                        i16 low, i16 high) {
        const i16 stride = all(grid_->columns);
        const i16 one = _mm512_set1_epi32(1);
        i16 begin = _mm512_add_epi32(_mm512_mullo_epi32(low, stride), left);
        i16 end = _mm512_add_epi32(_mm512_sub_epi32(begin, left), _mm512_add_epi32(right, one));
        const auto* const starts = memory_.starts;
        const i16 zero = _mm512_setzero_si512();
        std::uint32_t waiting = 0;
        while (narrow != 0) {
            i16 sample = _mm512_mask_i32gather_epi32(zero, narrow, begin, starts, 4);
            const i16 last = _mm512_mask_i32gather_epi32(zero, narrow, end, starts, 4);
            mask some = _mm512_cmplt_epi32_mask(sample, last);
            while (some != 0) {
                _mm512_storeu_si512(b.queued_lane + waiting,
                                    _mm512_maskz_compress_epi32(some, ascending()));
                _mm512_storeu_si512(b.queued_sample + waiting,
                                    _mm512_maskz_compress_epi32(some, sample));
                waiting += static_cast<std::uint32_t>(__builtin_popcount(some));
                if (waiting > queue_size - lanes) {
                    meet_pairs(b, waiting);
                    waiting = 0;
                }
                sample = _mm512_add_epi32(sample, one);
                some = _mm512_cmplt_epi32_mask(sample, last);
            }
            begin = _mm512_add_epi32(begin, stride);
            end = _mm512_add_epi32(end, stride);
            low = _mm512_add_epi32(low, one);
            narrow = _mm512_mask_cmple_epi32_mask(narrow, low, high);
        }
        if (waiting != 0) {
            meet_pairs(b, waiting);
        }
    }

    [[gnu::target("avx512f"), gnu::always_inline]] static f16 of_lanes(i16 lane,
                                                                       const float* values) {
        return _mm512_permutexvar_ps(lane, _mm512_load_ps(values));
    }
    /// Both floats of each of sixteen pairs.
    [[gnu::target("avx512f"), gnu::always_inline]] static void pairs_at(const float* from, i16 at,
                                                                        f16& first, f16& second) {
        const f16 low = _mm512_castpd_ps(_mm512_i32gather_pd(_mm512_castsi512_si256(at), from, 8));
        const f16 high =
            _mm512_castpd_ps(_mm512_i32gather_pd(_mm512_extracti64x4_epi64(at, 1), from, 8));
        first = firsts(low, high);
        second = seconds(low, high);
    }

    [[gnu::target("avx512f,popcnt")]] void meet_pairs(block& b, std::uint32_t count) {
        // Pairs that only fill up the last sixteen: any sample does.
        _mm512_storeu_si512(b.queued_sample + count, _mm512_setzero_si512());
        for (std::uint32_t q = 0; q < count; q += lanes) {
            const i16 lane = load(b.queued_lane + q);
            const i16 sample = load(b.queued_sample + q);
            f16 x;
            f16 y;
            pairs_at(memory_.places, sample, x, y);
            const corners flat{of_lanes(lane, b.corner[0]),
                               of_lanes(lane, b.corner[1]),
                               of_lanes(lane, b.corner[2]),
                               of_lanes(lane, b.corner[3]),
                               of_lanes(lane, b.corner[4]),
                               of_lanes(lane, b.corner[5]),
                               x,
                               x,
                               x};
            const edges e = edges_of(flat, x, y);
            mask in = static_cast<mask>(inside(e) & first_lanes(count - q));
            if (in == 0) {
                continue;
            }
            in = within(in,
                        {of_lanes(lane, b.box[0]), of_lanes(lane, b.box[1]),
                         of_lanes(lane, b.box[2]), of_lanes(lane, b.box[3])},
                        x, y);
            f16 z;
            f16 nearest;
            pairs_at(memory_.depths, sample, z, nearest);
            const met m =
                nearest_of(in, e, of_lanes(lane, b.corner[6]), of_lanes(lane, b.corner[7]),
                           of_lanes(lane, b.corner[8]), z, nearest);
            if (m.near_enough != 0) {
                take(b, m, e, b.queued_lane + q, b.queued_sample + q);
            }
        }
    }

    /// Several lanes may have the same sample: one after another.
    [[gnu::target("avx512f"), gnu::always_inline]] void take(const block& b, const met& m,
                                                             const edges& e,
                                                             const std::uint32_t* lane_of,
                                                             const std::uint32_t* sample_of) {
        alignas(64) float distances[lanes];
        _mm512_store_ps(distances, m.distance);
        for (std::uint32_t rest = m.near_enough; rest != 0; rest &= rest - 1) {
            const auto q = static_cast<std::uint32_t>(std::countr_zero(rest));
            const std::uint32_t lane = lane_of[q];
            const std::uint32_t sample = sample_of[q];
            const std::uint32_t triangle = b.number[lane];
            float& kept = memory_.depths[2 * std::size_t{sample} + 1];
            const float nearest = std::abs(kept);
            const float distance = distances[q];
            if (distance > nearest ||
                (distance == nearest && triangle >= memory_.nearest[sample]) ||
                (b.alpha[lane] != 0 && !alpha_.empty() && hole(b.alpha[lane], m, e, q))) {
                continue;
            }
            kept = std::copysign(distance, kept);
            memory_.nearest[sample] = triangle;
        }
    }

    /// Whether the lane's triangle has a hole where it is met.
    [[gnu::target("avx512f"), gnu::noinline]] bool hole(std::uint32_t number, const met& m,
                                                        const edges& e, std::uint32_t lane) const {
        alignas(64) float u[lanes];
        alignas(64) float v[lanes];
        _mm512_store_ps(u, _mm512_div_ps(e.b, m.area));
        _mm512_store_ps(v, _mm512_div_ps(e.c, m.area));
        return is_hole(number, u[lane], v[lane], alpha_);
    }

    /// A triangle that reaches over many cells.
    [[gnu::target("avx512f,popcnt")]] void meet_wide(const block& b, std::uint32_t lane) {
        const auto at = [&b, lane](int n) { return b.corner[n][lane]; };
        const corners t{all(at(0)), all(at(1)), all(at(2)), all(at(3)), all(at(4)),
                        all(at(5)), all(at(6)), all(at(7)), all(at(8))};
        const box around{all(b.box[0][lane]), all(b.box[1][lane]), all(b.box[2][lane]),
                         all(b.box[3][lane])};
        const float width = b.box[1][lane] - b.box[0][lane];
        const float height = b.box[3][lane] - b.box[2][lane];
        const float area = (at(2) - at(0)) * (at(5) - at(1)) - (at(3) - at(1)) * (at(4) - at(0));
        // Roundings displace the edges of very thin triangles far: those keep their boxes.
        const bool cut = std::abs(area) > 1e-3f * (width * width + height * height);
        const float margin = margin_ + 2e-6f * (width + height);
        for (std::uint32_t row = b.first_row[lane]; row <= b.last_row[lane]; row += lanes) {
            const i16 rows = _mm512_add_epi32(all(row), ascending());
            i16 left = all(b.first_column[lane]);
            i16 right = all(b.last_column[lane]);
            if (cut) {
                cut_rows(t, _mm512_add_epi32(rows, all(first_row_)), margin, left, right);
            }
            const mask there = _mm512_cmple_epi32_mask(rows, all(b.last_row[lane]));
            const i16 first = _mm512_mullo_epi32(rows, all(grid_->columns));
            const i16 zero = _mm512_setzero_si512();
            alignas(64) std::uint32_t begin[lanes];
            alignas(64) std::uint32_t end[lanes];
            const i16 begins = _mm512_mask_i32gather_epi32(
                zero, there, _mm512_add_epi32(first, left), memory_.starts, 4);
            const i16 ends = _mm512_mask_i32gather_epi32(
                zero, there, _mm512_add_epi32(_mm512_add_epi32(first, right), _mm512_set1_epi32(1)),
                memory_.starts, 4);
            _mm512_store_si512(begin, begins);
            _mm512_store_si512(end, ends);
            for (std::uint32_t some = _mm512_cmplt_epi32_mask(begins, ends); some != 0;
                 some &= some - 1) {
                const auto r = static_cast<std::uint32_t>(std::countr_zero(some));
                meet_run(t, around, b.number[lane], b.alpha[lane], begin[r], end[r]);
            }
        }
    }

    /// The columns that a triangle reaches in each of these rows, and a little more.
    [[gnu::target("avx512f"), gnu::always_inline]] void
    cut_rows(const corners& t, i16 rows, float margin, i16& left, i16& right) const {
        const float side = 1.0f / grid_->scale;
        const f16 row = _mm512_cvtepi32_ps(rows);
        f16 low = plus(all(grid_->bottom - margin), times(row, all(side)));
        f16 high = plus(all(grid_->bottom + margin), times(plus(row, all(1.0f)), all(side)));
        // The outer rows go on without end.
        const f16 endless = all(3e38f);
        low = _mm512_mask_mov_ps(low, _mm512_cmpeq_epi32_mask(rows, _mm512_setzero_si512()),
                                 minus(_mm512_setzero_ps(), endless));
        high =
            _mm512_mask_mov_ps(high, _mm512_cmpeq_epi32_mask(rows, all(grid_->rows - 1)), endless);
        f16 least = endless;
        f16 most = minus(_mm512_setzero_ps(), endless);
        cut_edge(t.ax, t.ay, t.bx, t.by, low, high, margin, least, most);
        cut_edge(t.bx, t.by, t.cx, t.cy, low, high, margin, least, most);
        cut_edge(t.cx, t.cy, t.ax, t.ay, low, high, margin, least, most);
        left = _mm512_max_epi32(
            left, cell(minus(least, all(margin)), grid_->left, grid_->scale, grid_->columns));
        right = _mm512_min_epi32(
            right, cell(plus(most, all(margin)), grid_->left, grid_->scale, grid_->columns));
    }
    /// Where an edge lies between two heights. Nearly level ones don't count: their ends are those
    /// of the others too.
    [[gnu::target("avx512f"), gnu::always_inline]] static void cut_edge(f16 ax, f16 ay, f16 bx,
                                                                        f16 by, f16 low, f16 high,
                                                                        float margin, f16& least,
                                                                        f16& most) {
        const f16 reach = all(margin);
        const f16 bottom = _mm512_min_ps(ay, by);
        const f16 top = _mm512_max_ps(ay, by);
        const f16 from = _mm512_max_ps(minus(low, reach), bottom);
        const f16 until = _mm512_min_ps(plus(high, reach), top);
        mask counts = _mm512_cmp_ps_mask(from, until, _CMP_LE_OQ);
        counts = _mm512_mask_cmp_ps_mask(counts, minus(top, bottom), reach, _CMP_GT_OQ);
        const f16 slope = _mm512_div_ps(minus(bx, ax), minus(by, ay));
        const f16 x0 = plus(ax, times(slope, minus(from, ay)));
        const f16 x1 = plus(ax, times(slope, minus(until, ay)));
        least = _mm512_mask_min_ps(least, counts, least, _mm512_min_ps(x0, x1));
        most = _mm512_mask_max_ps(most, counts, most, _mm512_max_ps(x0, x1));
    }

    /// One triangle and the samples [begin, end).
    [[gnu::target("avx512f"), gnu::always_inline]] void
    meet_run(const corners& t, const box& around, std::uint32_t triangle, std::uint32_t alpha,
             std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t k = begin; k < end; k += lanes) {
            float* const places = memory_.places + 2 * std::size_t{k};
            const f16 xy0 = load(places);
            const f16 xy1 = load(places + 16);
            const f16 x = firsts(xy0, xy1);
            const f16 y = seconds(xy0, xy1);
            const edges e = edges_of(t, x, y);
            mask in = static_cast<mask>(inside(e) & first_lanes(end - k));
            if (in == 0) {
                continue;
            }
            in = within(in, around, x, y);
            float* const depths = memory_.depths + 2 * std::size_t{k};
            const f16 zd0 = load(depths);
            const f16 zd1 = load(depths + 16);
            const f16 z = firsts(zd0, zd1);
            const f16 nearest = seconds(zd0, zd1);
            const met m = nearest_of(in, e, t.az, t.bz, t.cz, z, nearest);
            mask taken = m.near_enough;
            const mask equal =
                _mm512_mask_cmp_ps_mask(taken, m.distance, size_of(nearest), _CMP_EQ_OQ);
            if (equal != 0) {
                const mask lower = _mm512_mask_cmp_epu32_mask(equal, load(memory_.nearest + k),
                                                              all(triangle), _MM_CMPINT_LE);
                taken = static_cast<mask>(taken & ~lower);
            }
            if (alpha != 0 && !alpha_.empty()) {
                for (std::uint32_t rest = taken; rest != 0; rest &= rest - 1) {
                    const auto lane = static_cast<std::uint32_t>(std::countr_zero(rest));
                    if (hole(alpha, m, e, lane)) {
                        taken = static_cast<mask>(taken & ~(1u << lane));
                    }
                }
            }
            if (taken != 0) {
                const f16 now =
                    _mm512_mask_mov_ps(nearest, taken, turned(m.distance, signs(nearest)));
                _mm512_storeu_ps(depths, _mm512_permutex2var_ps(z, low_pairs(), now));
                _mm512_storeu_ps(depths + 16, _mm512_permutex2var_ps(z, high_pairs(), now));
                _mm512_mask_storeu_epi32(memory_.nearest + k, taken, all(triangle));
            }
        }
    }
    [[gnu::target("avx512f"), gnu::always_inline]] static i16 low_pairs() {
        return _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    }
    [[gnu::target("avx512f"), gnu::always_inline]] static i16 high_pairs() {
        return _mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
    }

    [[gnu::target("avx512f"), gnu::always_inline]] static void
    store_hits(const quad& four, const std::uint32_t* numbers, std::uint32_t count,
               gather_hit* hits) {
        const f16 of[4] = {four.x, four.y, four.z, four.w};
        alignas(64) float whole[4][lanes];
        for (std::uint32_t j = 0; j < 4; ++j) {
            _mm512_store_ps(whole[j], of[j]);
        }
        for (std::uint32_t j = 0; j < count; ++j) {
            _mm_storeu_ps(reinterpret_cast<float*>(hits + numbers[j]),
                          _mm_load_ps(&whole[j % 4][j / 4 * 4]));
        }
    }

    frame frame_;
    const grid* grid_;
    std::span<const gather_triangle> triangles_;
    std::span<const std::uint32_t> alpha_;
    band_memory memory_;
    std::uint32_t first_row_;
    std::uint32_t rows_;
    std::uint32_t samples_ = 0;
    float slack_;
    float lift_;
    float margin_ = 0;
};

} // namespace skybark::cpu::bundles::sixteen

#    if !defined(__clang__)
#        pragma GCC diagnostic pop
#    endif

#endif
