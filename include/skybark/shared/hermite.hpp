// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 2abeebff25c33b2ccf5c933e067173154b98b328a6804c83861ab5d125088788
#pragma once

#include <skybark/shared/glsl.hpp>

namespace skybark::shared {

// The centreline of a branch (Akagi and Kitajima, eq. 1). Both tangents point along the growth, so
// the last term is subtracted.
inline vec3 hermite_point(vec3 p1, vec3 n1, vec3 p2, vec3 n2, float t) {
    float s = 1.0f - t;
    return (p1 * ((1.0f + 2.0f * t) * (s * s)) + n1 * (t * (s * s))) +
           (p2 * ((t * t) * (1.0f + 2.0f * s)) - n2 * ((t * t) * s));
}

// Its derivative by t.
inline vec3 hermite_derivative(vec3 p1, vec3 n1, vec3 p2, vec3 n2, float t) {
    float s = 1.0f - t;
    return (p2 - p1) * (6.0f * t * s) + (n1 * (s * (1.0f - 3.0f * t)) + n2 * (t * (3.0f * t - 2.0f)));
}

} // namespace skybark::shared
