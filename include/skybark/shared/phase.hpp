// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 1b3b390958f5f8654dc0a5d2bb2885c195c3f695a623a1f75aef31d4df0a561c
#pragma once

#include <skybark/shared/glsl.hpp>

namespace skybark::shared {

// Phase functions, normalised to 1 over the sphere: the share of scattered light per steradian at
// the cosine u of the scattering angle (1: straight on). Only + - * / and sqrt, and 1 - u kept
// whole, so that a sharp lobe is right to a few units in the last place at every u.
//
// A phase function is four numbers, (1 - weight) Henyey-Greenstein + weight Draine:
//   x: g of Henyey-Greenstein, y: g of Draine, z: alpha of Draine, w: weight of Draine.

// Henyey and Greenstein 1941; -1 < g < 1.
inline float phase_henyey_greenstein(float g, float u) {
    float a = 1.0f - g;
    float s = a * a + 2.0f * g * (1.0f - u);
    return 0.079577472f * a * (1.0f + g) / (s * sqrt(s));
}

// Draine 2003; -1 < g < 1, alpha >= 0. Henyey-Greenstein at alpha 0, Rayleigh at g 0 and alpha 1.
inline float phase_draine(float g, float alpha, float u) {
    return phase_henyey_greenstein(g, u) * (1.0f + alpha * u * u) /
           (1.0f + alpha * (1.0f + 2.0f * g * g) * 0.33333333f);
}

// 1/sr at the cosine u of the scattering angle.
inline float phase_value(vec4 phase, float u) {
    return (1.0f - phase.w) * phase_henyey_greenstein(phase.x, u) +
           phase.w * phase_draine(phase.y, phase.z, u);
}

// The phase function with both lobes widened: each g times c, as in Wrenninge's octaves.
inline vec4 phase_widened(vec4 phase, float c) {
    return vec4(phase.x * c, phase.y * c, phase.z, phase.w);
}

} // namespace skybark::shared
