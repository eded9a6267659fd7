// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 dc82473f72fbd2e5b5a1f101cf84dbcaa157043ad5966c5f347893fe60eeeabb
#pragma once

#include <skybark/shared/glsl.hpp>
#include <skybark/shared/daylight.hpp>
#include <skybark/shared/noise.hpp>

namespace skybark::shared {

// Light on surfaces of the example pictures: a sun with a shadow, a sky, and wood and grass.

// Irradiance over pi for a surface with normal n, from the light's spherical harmonics up to l = 1,
// convolved with the cosine already.
inline vec3 ambient_light(vec4 h0, vec4 h1, vec4 h2, vec4 h3, vec3 n) {
    return vec3(max(h0.x + h1.x * n.x + h2.x * n.y + h3.x * n.z, 0.0f),
                max(h0.y + h1.y * n.x + h2.y * n.y + h3.y * n.z, 0.0f),
                max(h0.z + h1.z * n.x + h2.z * n.y + h3.z * n.z, 0.0f));
}

// Diffuse light that leaves a surface. `sun` is 0 in shadow and 1 in full light.
inline vec3 lit(vec3 albedo, vec3 n, daylight_sky sky, float sun, vec3 ambient) {
    float facing = max(n.x * sky.to_sun.x + n.y * sky.to_sun.y + n.z * sky.to_sun.z, 0.0f) * sun;
    return vec3(albedo.x * (ambient.x + sky.sunlight.x * facing),
                albedo.y * (ambient.y + sky.sunlight.y * facing),
                albedo.z * (ambient.z + sky.sunlight.z * facing));
}

// Height of furrowed bark at u (0 ... 1 around) and v (m along) of a branch whose girth is `cells`
// furrows: long cells along the branch, finer ones in them. 0 ... 1.
inline float bark_height(float u, float v, uint cells) {
    float around = u * float(cells);
    float warp = value_noise(around * 0.5f, v * 3.0f, 7.0f, max(cells / 2u, 1u));
    float furrow = value_noise(around + 2.0f * warp, v * 6.0f, 0.0f, cells);
    float fine = value_noise(around * 3.0f, v * 24.0f, 3.0f, cells * 3u);
    return 0.7f * furrow + 0.3f * fine;
}

inline vec3 bark_albedo(float height) {
    return vec3(mix(0.10f, 0.34f, height), mix(0.075f, 0.27f, height), mix(0.055f, 0.20f, height));
}

// A meadow, from far: patches of greens and straw.
inline vec3 grass_albedo(float x, float z) {
    float wide = value_noise(x * 0.13f, z * 0.13f, 1.0f, 2097152u);
    float middle = value_noise(x * 0.9f, z * 0.9f, 2.0f, 2097152u);
    float fine = value_noise(x * 9.0f, z * 9.0f, 5.0f, 2097152u);
    float straw = clamp(wide * 1.3f - 0.35f + 0.3f * middle, 0.0f, 1.0f);
    float shade = 0.55f + 0.55f * fine + 0.25f * middle;
    return vec3(mix(0.075f, 0.17f, straw) * shade, mix(0.105f, 0.155f, straw) * shade,
                mix(0.030f, 0.065f, straw) * shade);
}

// How much of a far surface the air hides at a distance in m.
inline float haze(float distance) {
    return 1.0f - exp_shared(-min(distance, 30000.0f) * (1.0f / 2500.0f));
}

// Display-referred value of a scene-referred one: Narkowicz' fit to the ACES film curve (2015), then
// the sRGB transfer function.
inline float srgb_encode(float x) {
    float c = clamp(x, 0.0f, 1.0f);
    return c <= 0.0031308f ? 12.92f * c : 1.055f * pow(c, 0.41666667f) - 0.055f;
}
inline float display(float x) {
    return srgb_encode(x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f));
}

} // namespace skybark::shared
