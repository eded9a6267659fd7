// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 324bc75f78370f3450ae20e5d23e193472147ce8a5c1b0511e80960061fb28ca
#pragma once

#include <skybark/shared/glsl.hpp>

namespace skybark::shared {

// Sort keys of numbers: whole numbers that grow, or fall, as the numbers do.

inline uint growing_key(float value)
{
    uint bits = floatBitsToUint(value);
    return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}

inline uint falling_key(float value)
{
    return ~growing_key(value);
}

} // namespace skybark::shared
