#pragma once
// IEEE 754 binary16 to and from float, in integers and additions: for machines with and without
// instructions for it. Rounded to nearest, ties to even.

#include <cstdint>
#include <cstring>

namespace skybark::cpu {

/// A 16-bit float in memory.
struct half {
    std::uint16_t bits = 0;
};

[[nodiscard]] inline std::uint32_t bits_of(float value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
}
[[nodiscard]] inline float float_of(std::uint32_t bits) {
    float value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

/// From 65520 on it is infinity; below 2^-25 and at it, zero.
[[nodiscard]] inline half to_half(float value) {
    constexpr std::uint32_t infinity = 255u << 23;
    constexpr std::uint32_t too_large = 143u << 23;       // 65536
    constexpr std::uint32_t smallest_normal = 113u << 23; // 2^-14
    constexpr std::uint32_t one_half = 126u << 23; // whose last bit is a subnormal half's: 2^-24
    const std::uint32_t signed_bits = bits_of(value);
    const std::uint32_t bits = signed_bits & 0x7fffffffu;
    std::uint32_t out = 0;
    if (bits >= too_large) {
        out = bits > infinity ? 0x7e00u : 0x7c00u;
    } else if (bits < smallest_normal) {
        out = bits_of(float_of(bits) + float_of(one_half)) - one_half;
    } else {
        const std::uint32_t odd = bits >> 13 & 1u;
        out = (bits - (112u << 23) + 0xfffu + odd) >> 13;
    }
    return {static_cast<std::uint16_t>(out | (signed_bits >> 16 & 0x8000u))};
}

/// As above, but what is too large becomes the largest finite number of its sign, as sums do.
[[nodiscard]] inline half to_finite_half(float value) {
    const half nearest = to_half(value);
    const bool infinite = (nearest.bits & 0x7fffu) == 0x7c00u;
    return infinite ? half{static_cast<std::uint16_t>(nearest.bits - 1u)} : nearest; // ±65504
}

[[nodiscard]] inline float to_float(half value) {
    const std::uint32_t magnitude = value.bits & 0x7fffu;
    const std::uint32_t sign = (value.bits & 0x8000u) << 16;
    if (magnitude >= 0x7c00u) {
        return float_of(sign | 0x7f800000u | (magnitude & 0x3ffu) << 13);
    }
    if (magnitude < 0x400u) {
        const float subnormal = static_cast<float>(magnitude) * 0x1p-24f;
        return sign != 0 ? -subnormal : subnormal;
    }
    return float_of(sign | ((magnitude << 13) + (112u << 23)));
}

} // namespace skybark::cpu
