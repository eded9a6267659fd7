#pragma once
// Running sums along an axis of a volume.
//
// Along y and z whole rows of x are summed at once, 512 voxels wide at most, so that the sums stay
// in the nearest cache and the inner loop runs over neighbours. Every voxel's sum is made in the
// order of the axis, whatever the strips and the threads. Whole numbers that become floats, as the
// clouds' do, are summed 64 at a time in AVX2's registers and written past the cache.

#include <skybark/cpu/half.hpp>
#include <skybark/cpu/memory.hpp>
#include <skybark/cpu/sinks.hpp>

#include <array>
#include <type_traits>

#if defined(__GNUC__) && defined(__x86_64__)
#    include <cpuid.h>
#    include <immintrin.h>
#endif

namespace skybark::cpu {
namespace sums {

/// How `In` is summed and becomes `Out`.
template <class In, class Out, scan_share Share>
struct step {
    using in = In;
    using out = Out;
    static constexpr scan_share share = Share;

    /// What the voxel becomes whose own value is `own`; `before` is the sum of those before it, and
    /// then that of those before the next.
    [[nodiscard]] static Out take(In& before, In own, float scale) {
        const In past = before;
        before = add(past, own);
        if constexpr (std::is_same_v<Out, std::int32_t>) {
            (void)scale;
            return Share == scan_share::none ? past : before;
        } else {
            float sum = 0;
            if constexpr (Share == scan_share::whole) {
                sum = static_cast<float>(before);
            } else if constexpr (Share == scan_share::none) {
                sum = static_cast<float>(past);
            } else {
                sum = static_cast<float>(past) + 0.5f * static_cast<float>(own);
            }
            if constexpr (std::is_same_v<Out, half>) {
                return to_finite_half(sum * scale);
            } else {
                return sum * scale;
            }
        }
    }

  private:
    [[nodiscard]] static In add(In a, In b) {
        if constexpr (std::is_same_v<In, std::int32_t>) {
            return static_cast<In>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
        } else {
            return a + b;
        }
    }
};

/// Rows of voxels, one after another along the axis.
template <class T>
struct sheet {
    T* data;
    std::uint64_t stride; ///< from a row to the next
    std::uint32_t rows;
    std::uint32_t columns;

    [[nodiscard]] T* row(std::uint32_t i, bool descending) const {
        return data + (descending ? rows - 1 - i : i) * stride;
    }
};

/// Sums down the rows of a sheet; `to` has the strides of the destination.
template <class Step>
void along_rows(const sheet<const typename Step::in>& from, const sheet<typename Step::out>& to,
                bool descending, float scale) {
    constexpr std::uint32_t strip = 512;
    std::array<typename Step::in, strip> before;
    for (std::uint32_t first = 0; first < from.columns; first += strip) {
        const std::uint32_t columns = std::min(strip, from.columns - first);
        before.fill(0);
        for (std::uint32_t i = 0; i < from.rows; ++i) {
            const typename Step::in* const own = from.row(i, descending) + first;
            typename Step::out* const out = to.row(i, descending) + first;
            for (std::uint32_t x = 0; x < columns; ++x) {
                out[x] = Step::take(before[x], own[x], scale);
            }
        }
    }
}

#if defined(__GNUC__) && defined(__x86_64__)
/// `along_rows` for int32 in AVX2's registers, `Blocks` times eight columns at a time from `first`
/// on, as often as they fit; returns the first column that is left. Where `In` is not const, what
/// has been read is cleared. Writes past the cache where the rows lie in whole vectors.
template <class Step, std::size_t Blocks, class In>
[[gnu::target("avx2,f16c")]] std::uint32_t
blocks_along_rows(const sheet<In>& from, const sheet<typename Step::out>& to, std::uint32_t first,
                  bool descending, float scale) {
    constexpr std::uint32_t width = 8 * Blocks;
    const bool aligned = reinterpret_cast<std::uintptr_t>(to.data) % 32 == 0 &&
                         to.stride * sizeof(*to.data) % 32 == 0;
    const __m256 factor = _mm256_set1_ps(scale);
    for (; first + width <= from.columns; first += width) {
        __m256i before[Blocks];
        for (__m256i& b : before) {
            b = _mm256_setzero_si256();
        }
        for (std::uint32_t i = 0; i < from.rows; ++i) {
            In* const own = from.row(i, descending) + first;
            typename Step::out* const out = to.row(i, descending) + first;
            for (std::size_t k = 0; k < Blocks; ++k) {
                const __m256i value =
                    _mm256_loadu_si256(reinterpret_cast<const __m256i*>(own + 8 * k));
                const __m256i past = before[k];
                before[k] = _mm256_add_epi32(past, value);
                __m256 sum;
                if constexpr (Step::share == scan_share::half) {
                    sum = _mm256_add_ps(
                        _mm256_cvtepi32_ps(past),
                        _mm256_mul_ps(_mm256_set1_ps(0.5f), _mm256_cvtepi32_ps(value)));
                } else {
                    sum = _mm256_cvtepi32_ps(Step::share == scan_share::none ? past : before[k]);
                }
                sum = _mm256_mul_ps(sum, factor);
                if constexpr (std::is_same_v<typename Step::out, half>) {
                    sum = _mm256_max_ps(_mm256_set1_ps(-65504.0f),
                                        _mm256_min_ps(_mm256_set1_ps(65504.0f), sum));
                    const __m128i halves = _mm256_cvtps_ph(sum, _MM_FROUND_TO_NEAREST_INT);
                    auto* const place = reinterpret_cast<__m128i*>(out) + k;
                    aligned ? _mm_stream_si128(place, halves) : _mm_storeu_si128(place, halves);
                } else {
                    aligned ? _mm256_stream_ps(out + 8 * k, sum)
                            : _mm256_storeu_ps(out + 8 * k, sum);
                }
                if constexpr (!std::is_const_v<In>) {
                    _mm256_storeu_si256(reinterpret_cast<__m256i*>(own + 8 * k),
                                        _mm256_setzero_si256());
                }
            }
        }
    }
    return first;
}

/// Whether the machine can do the above.
[[nodiscard]] inline bool has_blocks() {
    static const bool has = [] {
        unsigned a = 0, b = 0, c = 0, d = 0;
        return __builtin_cpu_supports("avx2") && __get_cpuid(1, &a, &b, &c, &d) != 0 &&
               (c & bit_F16C) != 0;
    }();
    return has;
}
#endif

/// Down the rows, the fastest way that there is. Where `In` is not const, what has been read is
/// cleared.
template <class Step, class In>
void down_rows(const sheet<In>& from, const sheet<typename Step::out>& to, const volume_scan& how) {
    const bool descending = how.direction == scan_direction::descending;
    std::uint32_t first = 0;
#if defined(__GNUC__) && defined(__x86_64__)
    if constexpr (std::is_same_v<typename Step::in, std::int32_t> &&
                  !std::is_same_v<typename Step::out, std::int32_t>) {
        if (has_blocks()) {
            first = blocks_along_rows<Step, 8>(from, to, first, descending, how.scale);
            first = blocks_along_rows<Step, 1>(from, to, first, descending, how.scale);
            finish_streaming();
        }
    }
#endif
    const std::uint32_t left = from.columns - first;
    along_rows<Step>({from.data + first, from.stride, from.rows, left},
                     {to.data + first, to.stride, to.rows, left}, descending, how.scale);
    if constexpr (!std::is_const_v<In>) {
        for (std::uint32_t i = 0; i < from.rows && left != 0; ++i) {
            std::fill_n(from.row(i, false) + first, left, In{0});
        }
    }
}

/// Sums along a row.
template <class Step>
void along_row(const typename Step::in* from, typename Step::out* to, std::uint32_t columns,
               bool descending, float scale) {
    typename Step::in before = 0;
    for (std::uint32_t i = 0; i < columns; ++i) {
        const std::uint32_t x = descending ? columns - 1 - i : i;
        to[x] = Step::take(before, from[x], scale);
    }
}

/// Every voxel of a row for itself.
template <class Step>
void each_of_row(const typename Step::in* from, typename Step::out* to, std::uint32_t columns,
                 float scale) {
    for (std::uint32_t x = 0; x < columns; ++x) {
        typename Step::in before = 0;
        to[x] = Step::take(before, from[x], scale);
    }
}

/// Rows of two volumes, whatever their voxels are: what is summed and where to.
struct two_sheets {
    std::byte* from;
    std::byte* to;
    std::uint64_t from_stride; ///< voxels from a row to the next
    std::uint64_t to_stride;
    std::uint32_t rows;
    std::uint32_t columns;
};

/// What sums voxels of certain types: one call for many of them, so that all types share the rest
/// of a scan. None where the contract has no such scan.
struct summer {
    void (*down)(const two_sheets& rows, const volume_scan& how) = nullptr;
    /// Sums along each row or, without an axis, takes every voxel for itself.
    void (*across)(const two_sheets& rows, const volume_scan& how) = nullptr;
};

template <class Step, class In>
void sum_down(const two_sheets& rows, const volume_scan& how) {
    down_rows<Step>(
        sheet<In>{reinterpret_cast<In*>(rows.from), rows.from_stride, rows.rows, rows.columns},
        {reinterpret_cast<typename Step::out*>(rows.to), rows.to_stride, rows.rows, rows.columns},
        how);
}

template <class Step>
void sum_across(const two_sheets& rows, const volume_scan& how) {
    const auto* from = reinterpret_cast<const typename Step::in*>(rows.from);
    auto* to = reinterpret_cast<typename Step::out*>(rows.to);
    // Copies: what is written might be what the references refer to.
    const std::uint64_t from_stride = rows.from_stride;
    const std::uint64_t to_stride = rows.to_stride;
    const std::uint32_t count = rows.rows;
    const std::uint32_t columns = rows.columns;
    const float scale = how.scale;
    if (how.axis != scan_axis::x) {
        for (std::uint32_t i = 0; i < count; ++i) {
            each_of_row<Step>(from + i * from_stride, to + i * to_stride, columns, scale);
        }
        return;
    }
    const bool descending = how.direction == scan_direction::descending;
    for (std::uint32_t i = 0; i < count; ++i) {
        along_row<Step>(from + i * from_stride, to + i * to_stride, columns, descending, scale);
    }
}

/// `Clear` is for sums down rows that are scratch, cleared as they are read.
template <class Step, bool Clear>
[[nodiscard]] summer summer_with() {
    if constexpr (Clear) {
        return {&sum_down<Step, typename Step::in>, nullptr};
    } else {
        return {&sum_down<Step, const typename Step::in>, &sum_across<Step>};
    }
}
template <class In, class Out, bool Clear>
[[nodiscard]] summer summer_of(scan_share share) {
    if (share == scan_share::whole) {
        return summer_with<step<In, Out, scan_share::whole>, Clear>();
    }
    if (share == scan_share::none) {
        return summer_with<step<In, Out, scan_share::none>, Clear>();
    }
    if constexpr (std::is_same_v<Out, std::int32_t>) {
        return {};
    } else {
        return summer_with<step<In, Out, scan_share::half>, Clear>();
    }
}
template <bool Clear>
[[nodiscard]] summer summer_of_int32(volume_format to, scan_share share) {
    if (to == volume_format::int32) {
        return summer_of<std::int32_t, std::int32_t, Clear>(share);
    }
    return to == volume_format::float32 ? summer_of<std::int32_t, float, Clear>(share)
                                        : summer_of<std::int32_t, half, Clear>(share);
}
[[nodiscard]] inline summer summer_of(volume_format from, volume_format to, scan_share share) {
    if (from == volume_format::int32) {
        return summer_of_int32<false>(to, share);
    }
    if (from == volume_format::float32 && to == volume_format::float32) {
        return summer_of<float, float, false>(share);
    }
    if (from == volume_format::float32 && to == volume_format::float16) {
        return summer_of<float, half, false>(share);
    }
    return {};
}

} // namespace sums

/// The scan of a volume into another: see the contract in skybark/core/backend.hpp.
template <class Device>
void scan_volume(Device& device, const volume& from, const volume& to, const volume_scan& how) {
    const volume_description what = from.description();
    const sums::summer sum = sums::summer_of(what.format, to.description().format, how.share);
    if (sum.down == nullptr) {
        return;
    }
    const std::uint64_t in_bytes = bytes_per_voxel(what.format);
    const std::uint64_t out_bytes = bytes_per_voxel(to.description().format);
    const std::uint64_t layer = std::uint64_t{what.width} * what.height;
    const auto sheets_from = [&](std::uint64_t at, std::uint64_t stride, std::uint64_t rows) {
        return sums::two_sheets{from.data() + at * in_bytes,
                                to.data() + at * out_bytes,
                                stride,
                                stride,
                                static_cast<std::uint32_t>(rows),
                                what.width};
    };
    if (how.axis != scan_axis::y && how.axis != scan_axis::z) {
        device.for_pieces(std::uint64_t{what.height} * what.depth, 16,
                          [&](std::uint64_t first, std::uint64_t count) {
                              sum.across(sheets_from(first * what.width, what.width, count), how);
                          });
        return;
    }
    // The rows of a layer along y, one row of each layer along z.
    const bool along_y = how.axis == scan_axis::y;
    device.for_pieces(along_y ? what.depth : what.height, 1,
                      [&](std::uint64_t first, std::uint64_t count) {
                          for (std::uint64_t i = first; i < first + count; ++i) {
                              sum.down(along_y ? sheets_from(i * layer, what.width, what.height)
                                               : sheets_from(i * what.width, layer, what.depth),
                                       how);
                          }
                      });
}

} // namespace skybark::cpu
