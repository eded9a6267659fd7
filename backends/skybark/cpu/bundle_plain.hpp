#pragma once
// A band of a bundle's samples against the triangles over it, one at a time: shared/bundle.hpp as
// it stands, for machines without AVX-512.

#include <skybark/cpu/bundle_grid.hpp>
#include <skybark/kernels/bundle_hits.hpp>

#include <bit>
#include <cmath>

#if defined(__GNUC__) && defined(__x86_64__)
#    define SKYBARK_BUNDLES_HAVE_EIGHT 1
#    include <immintrin.h>
#endif

namespace skybark::cpu::bundles::plain {

/// place() for `count` samples, and the band that each is in.
inline void place_samples(const ray_bundle& bundle, const grid& g, const gather_sample* samples,
                          std::uint32_t first, std::uint32_t count, placed_sample* placed,
                          std::uint32_t* bands) {
    for (std::uint32_t i = 0; i < count; ++i) {
        placed[i] = place(bundle, samples[first + i], first + i);
        bands[i] = g.band_of_row[g.row(placed[i].y)];
    }
}

/// Which bands triangles [first, first + count) may have samples in.
inline void band_ranges(const ray_bundle& bundle, const grid& g, const gather_triangle* triangles,
                        std::uint32_t first, std::uint32_t count, band_range* ranges) {
    const float slack = shared::meeting_slack(bundle);
    for (std::uint32_t i = first; i < first + count; ++i) {
        const float a = shared::across_bundle(bundle, triangles[i].a).y;
        const float b = shared::across_bundle(bundle, triangles[i].b).y;
        const float c = shared::across_bundle(bundle, triangles[i].c).y;
        const std::uint32_t low = g.row(std::min({a, b, c}) - slack);
        const std::uint32_t high = g.row(std::max({a, b, c}) + slack);
        ranges[i] = {static_cast<std::uint16_t>(g.band_of_row[low]),
                     static_cast<std::uint16_t>(g.band_of_row[high])};
    }
}

/// Puts those of triangles [first, first + count) that reach over the band into `numbers`, and says
/// how many.
inline std::uint32_t pick(const band_range* ranges, std::uint32_t first, std::uint32_t count,
                          std::uint32_t band, std::uint32_t* numbers) {
    std::uint32_t found = 0;
    for (std::uint32_t i = first; i < first + count; ++i) {
        numbers[found] = i;
        found += ranges[i].first <= band && band <= ranges[i].last ? 1 : 0;
    }
    return found;
}

/// A triangle as a bundle sees it.
struct corners {
    glm::vec3 a, b, c;
};

/// Samples one after another.
struct one_at_a_time {
    /// Calls `meet(k)` for those of the samples [begin, end), x and y each at `places`, that may be
    /// inside the triangle.
    template <class Meet>
    static void visit(const corners& t, const float* places, std::uint32_t begin, std::uint32_t end,
                      const Meet& meet) {
        (void)t;
        (void)places;
        for (std::uint32_t k = begin; k < end; ++k) {
            meet(k);
        }
    }
};

#if defined(SKYBARK_BUNDLES_HAVE_EIGHT)

/// Eight at a time.
struct eight_at_a_time {
    template <class Meet>
    static void visit(const corners& t, const float* places, std::uint32_t begin, std::uint32_t end,
                      const Meet& meet) {
        for (std::uint32_t k = begin; k < end; k += 8) {
            const unsigned wanted = end - k < 8 ? (1u << (end - k)) - 1u : 0xffu;
            for (unsigned rest = inside(t, places + 2 * std::size_t{k}) & wanted; rest != 0;
                 rest &= rest - 1) {
                meet(k + static_cast<std::uint32_t>(std::countr_zero(rest)));
            }
        }
    }

  private:
    using f8 = __m256;

    /// A product that no compiler adds to anything before it is rounded.
    [[gnu::target("avx2"), gnu::always_inline]] static f8 times(f8 x, f8 y) {
        f8 product = _mm256_mul_ps(x, y);
        asm("" : "+x"(product));
        return product;
    }
    [[gnu::target("avx2"), gnu::always_inline]] static f8 cross(f8 ax, f8 ay, f8 bx, f8 by) {
        return _mm256_sub_ps(times(ax, by), times(ay, bx));
    }
    [[gnu::target("avx2"), gnu::always_inline]] static f8 both(f8 x, f8 y) {
        return _mm256_and_ps(x, y);
    }

    /// A bit for each of eight samples that has the triangle's edges all on one side.
    [[gnu::target("avx2")]] static unsigned inside(const corners& t, const float* places) {
        const f8 low = _mm256_loadu_ps(places);
        const f8 high = _mm256_loadu_ps(places + 8);
        // Samples 0, 1, 4, 5, 2, 3, 6, 7.
        const f8 x = _mm256_shuffle_ps(low, high, 0x88);
        const f8 y = _mm256_shuffle_ps(low, high, 0xdd);
        const f8 ax = _mm256_sub_ps(_mm256_set1_ps(t.a.x), x);
        const f8 ay = _mm256_sub_ps(_mm256_set1_ps(t.a.y), y);
        const f8 bx = _mm256_sub_ps(_mm256_set1_ps(t.b.x), x);
        const f8 by = _mm256_sub_ps(_mm256_set1_ps(t.b.y), y);
        const f8 cx = _mm256_sub_ps(_mm256_set1_ps(t.c.x), x);
        const f8 cy = _mm256_sub_ps(_mm256_set1_ps(t.c.y), y);
        const f8 e0 = cross(bx, by, cx, cy);
        const f8 e1 = cross(cx, cy, ax, ay);
        const f8 e2 = cross(ax, ay, bx, by);
        const f8 zero = _mm256_setzero_ps();
        const f8 up =
            both(both(_mm256_cmp_ps(e0, zero, _CMP_GE_OQ), _mm256_cmp_ps(e1, zero, _CMP_GE_OQ)),
                 _mm256_cmp_ps(e2, zero, _CMP_GE_OQ));
        const f8 down =
            both(both(_mm256_cmp_ps(e0, zero, _CMP_LE_OQ), _mm256_cmp_ps(e1, zero, _CMP_LE_OQ)),
                 _mm256_cmp_ps(e2, zero, _CMP_LE_OQ));
        const auto mixed = static_cast<unsigned>(_mm256_movemask_ps(_mm256_or_ps(up, down)));
        return (mixed & 0xc3u) | (mixed & 0x0cu) << 2 | (mixed & 0x30u) >> 2;
    }
};

#endif

/// One band of samples.
template <class Visitor>
class band_work {
  public:
    band_work(const ray_bundle& bundle, const grid& g, std::uint32_t band,
              std::span<const gather_triangle> triangles, std::span<const std::uint32_t> alpha,
              const band_memory& memory)
        : bundle_(&bundle), grid_(&g), triangles_(triangles), alpha_(alpha), memory_(memory),
          first_row_(g.first_row[band]), end_row_(g.first_row[band + 1]),
          slack_(shared::meeting_slack(bundle)) {}

    /// Cells of samples that come in a row; they are `count` after those that came before.
    void add_cells(std::span<const placed_sample> run) {
        for (const placed_sample& at : run) {
            memory_.cells[samples_++] =
                (grid_->row(at.y) - first_row_) * grid_->columns + grid_->column(at.x);
        }
    }

    [[nodiscard]] std::uint32_t samples() const { return samples_; }

    /// Tests triangles of these numbers.
    void meet(const std::uint32_t* numbers, std::uint32_t count) {
        for (std::uint32_t i = 0; i < count; ++i) {
            meet_triangle(numbers[i]);
        }
    }

    /// Writes the hits of all samples.
    void finish(gather_hit* hits) const {
        for (std::uint32_t k = 0; k < samples_; ++k) {
            gather_hit& hit = hits[memory_.numbers[k]];
            hit = gather_hit{};
            if (memory_.nearest[k] != no_surface) {
                const corners t = corners_of(memory_.nearest[k]);
                const float side = side_of(k);
                const shared::bundle_meeting met = meeting(t, k);
                hit.distance = shared::distance_along(met, side, memory_.depths[2 * std::size_t{k}],
                                                      bundle_->right.w);
                hit.surface = 2 * memory_.nearest[k] + (side * met.facing < 0.0f ? 0u : 1u);
                hit.u = met.u;
                hit.v = met.v;
            }
        }
    }

  private:
    [[nodiscard]] corners corners_of(std::uint32_t number) const {
        const gather_triangle& t = triangles_[number];
        return {shared::across_bundle(*bundle_, t.a), shared::across_bundle(*bundle_, t.b),
                shared::across_bundle(*bundle_, t.c)};
    }
    [[nodiscard]] float side_of(std::uint32_t sample) const {
        return std::signbit(memory_.depths[2 * std::size_t{sample} + 1]) ? -1.0f : 1.0f;
    }
    [[nodiscard]] shared::bundle_meeting meeting(const corners& t, std::uint32_t sample) const {
        const float* const at = memory_.places + 2 * std::size_t{sample};
        return shared::meet_triangle(t.a, t.b, t.c, at[0], at[1], slack_);
    }

    void meet_triangle(std::uint32_t number) {
        const corners t = corners_of(number);
        const std::uint32_t left = grid_->column(std::min({t.a.x, t.b.x, t.c.x}) - slack_);
        const std::uint32_t right = grid_->column(std::max({t.a.x, t.b.x, t.c.x}) + slack_);
        const std::uint32_t low = grid_->row(std::min({t.a.y, t.b.y, t.c.y}) - slack_);
        const std::uint32_t high = grid_->row(std::max({t.a.y, t.b.y, t.c.y}) + slack_);
        for (std::uint32_t row = std::max(low, first_row_); row < end_row_ && row <= high; ++row) {
            const std::size_t first = std::size_t{row - first_row_} * grid_->columns;
            Visitor::visit(t, memory_.places, memory_.starts[first + left],
                           memory_.starts[first + right + 1],
                           [&](std::uint32_t k) { meet_sample(number, t, k); });
        }
    }

    void meet_sample(std::uint32_t number, const corners& t, std::uint32_t k) {
        const shared::bundle_meeting met = meeting(t, k);
        float& kept = memory_.depths[2 * std::size_t{k} + 1];
        const float distance = shared::distance_along(
            met, side_of(k), memory_.depths[2 * std::size_t{k}], bundle_->right.w);
        const float nearest = std::abs(kept);
        if (!(distance >= 0.0f && distance <= nearest) ||
            (distance == nearest && number >= memory_.nearest[k])) {
            return;
        }
        const std::uint32_t alpha = triangles_[number].alpha;
        if (alpha != 0 && !alpha_.empty() && is_hole(alpha, met.u, met.v, alpha_)) {
            return;
        }
        // Its sign says where the sample looks.
        kept = std::copysign(distance, kept);
        memory_.nearest[k] = number;
    }

    const ray_bundle* bundle_;
    const grid* grid_;
    std::span<const gather_triangle> triangles_;
    std::span<const std::uint32_t> alpha_;
    band_memory memory_;
    std::uint32_t first_row_;
    std::uint32_t end_row_;
    std::uint32_t samples_ = 0;
    float slack_;
};

} // namespace skybark::cpu::bundles::plain
