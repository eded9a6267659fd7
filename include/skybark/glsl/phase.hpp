// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 3ba455694654a49ecc7b3442f48937f0e141124a7c48cdef1f626ed9deaf30e7
#pragma once

#include <string_view>

namespace skybark::glsl {

/// Phase functions of clouds, 1/sr, for a shader of your own: isotropic, Henyey and Greenstein's,
/// Draine's, and by skybark::clouds::phase_function::mie(diameter).parameters() that of droplets.
///
/// Defines phase_henyey_greenstein, phase_draine, phase_value, phase_widened.
inline constexpr std::string_view phase{R"glsl(// Phase functions of clouds, 1/sr, for a shader of your own: isotropic, Henyey and Greenstein's,
// Draine's, and by skybark::clouds::phase_function::mie(diameter).parameters() that of droplets.
//
// Defines phase_henyey_greenstein, phase_draine, phase_value, phase_widened.

#ifndef SKYBARK_PHASE_HENYEY_GREENSTEIN
#define SKYBARK_PHASE_HENYEY_GREENSTEIN
// Henyey and Greenstein 1941; -1 < g < 1.
float phase_henyey_greenstein(float g, float u) {
    float a = 1.0f - g;
    float s = a * a + 2.0f * g * (1.0f - u);
    return 0.079577472f * a * (1.0f + g) / (s * sqrt(s));
}
#endif

#ifndef SKYBARK_PHASE_DRAINE
#define SKYBARK_PHASE_DRAINE
// Draine 2003; -1 < g < 1, alpha >= 0. Henyey-Greenstein at alpha 0, Rayleigh at g 0 and alpha 1.
float phase_draine(float g, float alpha, float u) {
    return phase_henyey_greenstein(g, u) * (1.0f + alpha * u * u) /
           (1.0f + alpha * (1.0f + 2.0f * g * g) * 0.33333333f);
}
#endif

#ifndef SKYBARK_PHASE_VALUE
#define SKYBARK_PHASE_VALUE
// 1/sr at the cosine u of the scattering angle.
float phase_value(vec4 phase, float u) {
    return (1.0f - phase.w) * phase_henyey_greenstein(phase.x, u) +
           phase.w * phase_draine(phase.y, phase.z, u);
}
#endif

#ifndef SKYBARK_PHASE_WIDENED
#define SKYBARK_PHASE_WIDENED
// The phase function with both lobes widened: each g times c, as in Wrenninge's octaves.
vec4 phase_widened(vec4 phase, float c) {
    return vec4(phase.x * c, phase.y * c, phase.z, phase.w);
}
#endif
)glsl", 1482};

} // namespace skybark::glsl
