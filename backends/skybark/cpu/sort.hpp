#pragma once
// Sorts and running sums of 32-bit words.

#include <skybark/cpu/memory.hpp>

#include <array>
#include <limits>

namespace skybark::cpu {

/// Memory that sorts and running sums use again.
struct sort_scratch {
    const detail::memory_source* source = nullptr;
    detail::scratch_memory pairs{source};
    detail::scratch_memory counts{source};
};

namespace radix {

inline constexpr std::uint32_t bits = 8;
inline constexpr std::uint32_t digits = 1u << bits;
inline constexpr std::uint32_t least_of_piece = 1u << 13;
inline constexpr std::uint32_t most_pieces = 16;

struct pairs {
    std::uint32_t* keys;
    std::uint32_t* values;
};

/// The pieces of an array that threads work on: their number depends on its length alone.
struct cut {
    std::uint64_t count;
    std::uint32_t pieces;

    explicit cut(std::uint64_t of)
        : count(of), pieces(static_cast<std::uint32_t>(
                         std::clamp<std::uint64_t>(of / least_of_piece, 1, most_pieces))) {}
    [[nodiscard]] std::uint64_t start(std::uint32_t piece) const { return count * piece / pieces; }
};

/// Moves the pairs to `to`, by the digit of their keys at `shift`. False, and nothing is moved,
/// where all have the same digit. `counts` has room for a number a digit and piece.
template <class Device>
[[nodiscard]] bool pass(Device& device, const cut& c, std::uint32_t shift, const pairs& from,
                        const pairs& to, std::uint32_t* counts) {
    const auto digit = [&](std::uint32_t key) { return key >> shift & (digits - 1); };
    device.parallel(c.pieces, [&](std::uint32_t piece) {
        // Four tables: equal digits in a row need not wait for each other.
        std::array<std::array<std::uint32_t, digits>, 4> found{};
        const std::uint64_t end = c.start(piece + 1);
        std::uint64_t i = c.start(piece);
        for (; i + 4 <= end; i += 4) {
            for (std::size_t k = 0; k < 4; ++k) {
                ++found[k][digit(from.keys[i + k])];
            }
        }
        for (; i < end; ++i) {
            ++found[0][digit(from.keys[i])];
        }
        for (std::size_t d = 0; d < digits; ++d) {
            counts[d * c.pieces + piece] = found[0][d] + found[1][d] + found[2][d] + found[3][d];
        }
    });
    std::uint32_t sum = 0;
    for (std::uint32_t d = 0; d < digits; ++d) {
        const std::uint32_t before = sum;
        for (std::uint32_t piece = 0; piece < c.pieces; ++piece) {
            std::uint32_t& place = counts[d * c.pieces + piece];
            const std::uint32_t here = place;
            place = sum;
            sum += here;
        }
        if (sum - before == c.count) {
            return false;
        }
    }
    device.parallel(c.pieces, [&](std::uint32_t piece) {
        std::array<std::uint32_t, digits> place;
        for (std::size_t d = 0; d < digits; ++d) {
            place[d] = counts[d * c.pieces + piece];
        }
        for (std::uint64_t i = c.start(piece); i < c.start(piece + 1); ++i) {
            const std::uint32_t key = from.keys[i];
            const std::uint32_t at = place[digit(key)]++;
            to.keys[at] = key;
            to.values[at] = from.values[i];
        }
    });
    return true;
}

} // namespace radix

/// Sorts pairs by growing key, from the lowest digit to the highest, which keeps the order of equal
/// keys. At most 2^32 − 1 pairs, of keys below 2^key_bits. False where there is no memory.
template <class Device>
[[nodiscard]] bool sort_pairs(Device& device, sort_scratch& scratch, std::span<std::uint32_t> keys,
                              std::span<std::uint32_t> values, std::uint32_t key_bits = 32) {
    const radix::cut c(keys.size());
    auto* const spare = scratch.pairs.room_for<std::uint32_t>(2 * c.count);
    auto* const counts = scratch.counts.room_for<std::uint32_t>(radix::digits * radix::most_pieces);
    if (spare == nullptr || counts == nullptr) {
        return false;
    }
    radix::pairs from{keys.data(), values.data()};
    radix::pairs to{spare, spare + c.count};
    for (std::uint32_t shift = 0; shift < std::min(key_bits, 32u); shift += radix::bits) {
        if (c.count > 1 && radix::pass(device, c, shift, from, to, counts)) {
            std::swap(from, to);
        }
    }
    if (from.keys != keys.data()) {
        device.for_pieces(
            c.count, radix::least_of_piece, [&](std::uint64_t first, std::uint64_t n) {
                std::memcpy(to.keys + first, from.keys + first, n * sizeof(std::uint32_t));
                std::memcpy(to.values + first, from.values + first, n * sizeof(std::uint32_t));
            });
    }
    return true;
}

/// Each word becomes the sum of those before it, as far as 32 bits hold it; so is the result, of
/// all. False where there is no memory.
template <class Device>
[[nodiscard]] bool scan_words(Device& device, sort_scratch& scratch, std::span<std::uint32_t> words,
                              std::uint32_t& total) {
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    const radix::cut c(words.size());
    auto* const sums = scratch.counts.room_for<std::uint64_t>(radix::most_pieces + 1);
    if (sums == nullptr) {
        return false;
    }
    device.parallel(c.pieces, [&](std::uint32_t piece) {
        std::uint64_t sum = 0;
        for (std::uint64_t i = c.start(piece); i < c.start(piece + 1); ++i) {
            sum += words[i];
        }
        sums[piece + 1] = sum;
    });
    sums[0] = 0;
    for (std::uint32_t piece = 0; piece < c.pieces; ++piece) {
        sums[piece + 1] += sums[piece];
    }
    device.parallel(c.pieces, [&](std::uint32_t piece) {
        std::uint64_t sum = sums[piece];
        for (std::uint64_t i = c.start(piece); i < c.start(piece + 1); ++i) {
            const std::uint32_t own = words[i];
            words[i] = static_cast<std::uint32_t>(std::min(sum, most));
            sum += own;
        }
    });
    total = static_cast<std::uint32_t>(std::min(sums[c.pieces], most));
    return true;
}

} // namespace skybark::cpu
