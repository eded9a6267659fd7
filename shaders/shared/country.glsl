// Fields and woods seen from afar.
#include "records.glsl"
#include "noise.glsl"

// Noise of `size` metres that fades to its mean where it would be smaller than what can be seen.
float country_noise(float x, float z, float size, float layer, float distance) {
    float seen = clamp(2.0f - distance / (300.0f * size), 0.0f, 1.0f);
    if (seen == 0.0f) {
        return 0.5f;
    }
    float noise = value_noise(x / size, z / size, layer, 2097152u);
    return 0.5f + (noise - 0.5f) * seen;
}

// Albedo at (x, z), seen from `distance` metres.
vec3 country_albedo(float x, float z, float distance) {
    float wood = country_noise(x, z, 900.0f, 1.0f, distance) * 0.6f + country_noise(x, z, 240.0f, 2.0f, distance) * 0.4f;
    float field = country_noise(x + 0.6f * z, z - 0.6f * x, 170.0f, 3.0f, distance);
    float fine = country_noise(x, z, 22.0f, 4.0f, distance);
    float grain = country_noise(x, z, 3.5f, 5.0f, distance);
    float trees = clamp((wood - 0.5f) * 7.0f + (fine - 0.5f) * 1.5f, 0.0f, 1.0f);
    float straw = clamp((field - 0.45f) * 3.0f, 0.0f, 1.0f);
    float shade = 0.5f + 0.5f * fine + 0.5f * grain;
    return vec3(mix(mix(0.095f, 0.190f, straw), 0.036f, trees) * shade,
                mix(mix(0.125f, 0.165f, straw), 0.052f, trees) * shade,
                mix(0.042f + 0.03f * straw, 0.024f, trees) * shade);
}
