// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 a6c829d9f61b5a8d69fc00e1618ea8f9aa50f7f36358c3c4a68af9b89ce6bafe
#pragma once

#include <skybark/shared/glsl.hpp>

namespace skybark::shared {

// Where in an alpha map a place is.

// The texel, of `count` along one side, that the place lies in: 0…1 from edge to edge, repeated.
inline uint alpha_texel(float place, uint count)
{
    float within = place - floor(place);
    float texel = within * float(count);
    return texel > 0.0f ? min(uint(min(texel, 65535.0f)), count - 1u) : 0u;
}

// Between the places of three corners, by the weights of the second and third.
inline float alpha_place(float a, float b, float c, float u, float v)
{
    float place = (a + u * (b - a)) + v * (c - a);
    return place;
}

} // namespace skybark::shared
