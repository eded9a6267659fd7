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
                return to_half(sum * scale);
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

/// The volumes' voxels with the types that their formats have, and the share: calls
/// `work.template operator()<step<…>>()`. Nothing where the contract has no such scan.
template <class In, class Out, class Work>
void with_share(scan_share share, Work&& work) {
    if (share == scan_share::whole) {
        work.template operator()<step<In, Out, scan_share::whole>>();
    } else if (share == scan_share::none) {
        work.template operator()<step<In, Out, scan_share::none>>();
    } else if constexpr (!std::is_same_v<Out, std::int32_t>) {
        work.template operator()<step<In, Out, scan_share::half>>();
    }
}
template <class Work>
void with_step_from_int32(volume_format to, scan_share share, Work&& work) {
    if (to == volume_format::int32) {
        with_share<std::int32_t, std::int32_t>(share, work);
    } else if (to == volume_format::float32) {
        with_share<std::int32_t, float>(share, work);
    } else {
        with_share<std::int32_t, half>(share, work);
    }
}
template <class Work>
void with_step(volume_format from, volume_format to, scan_share share, Work&& work) {
    if (from == volume_format::int32) {
        with_step_from_int32(to, share, work);
    } else if (from == volume_format::float32 && to == volume_format::float32) {
        with_share<float, float>(share, work);
    } else if (from == volume_format::float32 && to == volume_format::float16) {
        with_share<float, half>(share, work);
    }
}

} // namespace sums

/// The scan of a volume into another: see the contract in skybark/core/backend.hpp.
template <class Device>
void scan_volume(Device& device, const volume& from, const volume& to, const volume_scan& how) {
    const volume_description what = from.description();
    const std::uint64_t layer = std::uint64_t{what.width} * what.height;
    const bool descending = how.direction == scan_direction::descending;
    sums::with_step(what.format, to.description().format, how.share, [&]<class Step>() {
        const auto* const in = reinterpret_cast<const typename Step::in*>(from.data());
        auto* const out = reinterpret_cast<typename Step::out*>(to.data());
        using in_type = const typename Step::in;
        if (how.axis == scan_axis::y) {
            device.for_pieces(what.depth, 1, [&](std::uint64_t first, std::uint64_t count) {
                for (std::uint64_t at = first * layer; at < (first + count) * layer; at += layer) {
                    sums::down_rows<Step>(
                        sums::sheet<in_type>{in + at, what.width, what.height, what.width},
                        {out + at, what.width, what.height, what.width}, how);
                }
            });
        } else if (how.axis == scan_axis::z) {
            device.for_pieces(what.height, 1, [&](std::uint64_t first, std::uint64_t count) {
                for (std::uint64_t at = first * what.width; at < (first + count) * what.width;
                     at += what.width) {
                    sums::down_rows<Step>(
                        sums::sheet<in_type>{in + at, layer, what.depth, what.width},
                        {out + at, layer, what.depth, what.width}, how);
                }
            });
        } else {
            const std::uint64_t rows = std::uint64_t{what.height} * what.depth;
            device.for_pieces(rows, 16, [&](std::uint64_t first, std::uint64_t count) {
                for (std::uint64_t row = first * what.width; row < (first + count) * what.width;
                     row += what.width) {
                    if (how.axis == scan_axis::x) {
                        sums::along_row<Step>(in + row, out + row, what.width, descending,
                                              how.scale);
                    } else {
                        sums::each_of_row<Step>(in + row, out + row, what.width, how.scale);
                    }
                }
            });
        }
    });
}

} // namespace skybark::cpu
