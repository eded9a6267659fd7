// Clouds' particles with torn outlines, and their light in the plane in which they are drawn.
#include "records.glsl"
#include "noise.glsl"

// The light of a particle as it is seen: radiance in its middle, and by how much it grows over a
// radius to the right and upwards; and that of the air before it.
struct puff_radiance {
    vec4 middle;
    vec4 right;
    vec4 up;
    vec4 air;
};

// Where a billboard is drawn: unit vectors to the right and upwards of the one from the eye.
vec3 puff_right(vec3 ahead) {
    bool steep = ahead.y * ahead.y > 0.98f;
    float x = steep ? 0.0f : -ahead.z;
    float y = steep ? ahead.z : 0.0f;
    float z = steep ? -ahead.y : ahead.x;
    float over = 1.0f / sqrt(x * x + y * y + z * z);
    return vec3(x * over, y * over, z * over);
}

// Two octaves of noise at a place in a cloud, 0...1: `over` is 1 / the size of its grains, 1/m.
float puff_noise(vec3 place, float over) {
    float coarse = value_noise(place.x * over, place.y * over, place.z * over, 16384u);
    float twice = 2.17f * over;
    float fine = value_noise(place.x * twice, place.y * twice, place.z * twice, 16384u);
    return 0.62f * coarse + 0.38f * fine;
}

// What of a Gaussian body, 0...1, is left when noise eats into it from its rim: `torn` of it at
// most, 0 leaves it as it is.
float puff_torn(float body, float noise, float torn) {
    float cut = torn * noise;
    return max(body - cut, 0.0f) / (1.0f - cut);
}
