// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 4378508f745bd72f04b885201bab1290a577dd8b2dab59bb5d6e5b6e344124c3
#pragma once

#include <skybark/shared/glsl.hpp>

namespace skybark::shared {

// The sky of a clear day: Preetham, Shirley and Smits, "A practical analytic model for daylight",
// SIGGRAPH 1999. Luminance Y in kcd/m^2 and chromaticities x, y by Perez' formula.

struct daylight_sky {
    vec4 a; // Perez' coefficients: x for Y, y for x, z for y
    vec4 b;
    vec4 c;
    vec4 d;
    vec4 e;
    vec4 zenith;     // Y, x, y at the zenith over Perez' function there
    vec4 to_sun;     // xyz: unit
    vec4 sunlight;   // rgb: irradiance of a surface that faces the sun over pi
};

// exp x for -30 <= x <= 10: 2^n by squaring, the rest by its series. The squaring multiplies the
// relative error by 64: below 1e-5 for |x| <= 10, below 2e-3 at -30, where nothing is left of it.
inline float exp_shared(float x) {
    float s = x * (1.0f / 64.0f);
    float p = 1.0f + s * (1.0f + s * (0.5f + s * (0.16666667f + s * (0.041666667f + s * 0.0083333333f))));
    p = p * p;
    p = p * p;
    p = p * p;
    p = p * p;
    p = p * p;
    return p * p;
}

inline float arccos_shared(float x) {
    float c = clamp(x, -1.0f, 1.0f);
    return atan(sqrt((1.0f - c) * (1.0f + c)), c);
}

inline float perez(float a, float b, float c, float d, float e, float cos_zenith, float gamma) {
    float cos_gamma = cos(gamma);
    return (1.0f + a * exp_shared(b / cos_zenith)) *
           (1.0f + c * exp_shared(d * gamma) + e * cos_gamma * cos_gamma);
}

inline vec3 srgb_from_xyY(float luminance, float x, float y) {
    float X = luminance * x / y;
    float Z = luminance * (1.0f - x - y) / y;
    return vec3(3.2406f * X - 1.5372f * luminance - 0.4986f * Z,
                -0.9689f * X + 1.8758f * luminance + 0.0415f * Z,
                0.0557f * X - 0.2040f * luminance + 1.0570f * Z);
}

// Radiance of the sky in direction `to` (unit), linear sRGB. Below the horizon it is the horizon's.
inline vec3 sky_radiance(daylight_sky sky, vec3 to) {
    float up = max(to.y, 0.01f);
    float flat_length = sqrt(max(1.0f - up * up, 0.0f) /
                             max(to.x * to.x + to.z * to.z, 1e-12f));
    float cos_gamma = to.x * flat_length * sky.to_sun.x + up * sky.to_sun.y +
                      to.z * flat_length * sky.to_sun.z;
    float gamma = arccos_shared(cos_gamma);
    float luminance = sky.zenith.x * perez(sky.a.x, sky.b.x, sky.c.x, sky.d.x, sky.e.x, up, gamma);
    float x = sky.zenith.y * perez(sky.a.y, sky.b.y, sky.c.y, sky.d.y, sky.e.y, up, gamma);
    float y = sky.zenith.z * perez(sky.a.z, sky.b.z, sky.c.z, sky.d.z, sky.e.z, up, gamma);
    vec3 rgb = srgb_from_xyY(luminance, x, y);
    return vec3(max(rgb.x, 0.0f), max(rgb.y, 0.0f), max(rgb.z, 0.0f));
}

} // namespace skybark::shared
