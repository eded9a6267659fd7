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

// A corner of the square that covers a ball's silhouette, on the plane through the ball's centre.
struct puff_corner {
    vec3 offset; // from the centre, m
    float over;  // half the square's side, in radii of the ball
};

// `centre` as seen from the eye, more than a radius away; x and y: -1 or 1.
puff_corner puff_silhouette(vec3 centre, float radius, float x, float y) {
    float away2 = centre.x * centre.x + centre.y * centre.y + centre.z * centre.z;
    float away = sqrt(away2);
    puff_corner corner;
    corner.over = away / sqrt(away2 - radius * radius);
    vec3 ahead = centre * (1.0f / away);
    vec3 right = puff_right(ahead);
    vec3 up = vec3(right.y * ahead.z - right.z * ahead.y, right.z * ahead.x - right.x * ahead.z,
                   right.x * ahead.y - right.y * ahead.x);
    float u = x * corner.over * radius;
    float v = y * corner.over * radius;
    corner.offset = right * u + up * v;
    return corner;
}

// Which corner a vertex of the square's two triangles is: bit 0 right, bit 1 up.
uint puff_corner_of(uint index) {
    uint k = index % 6u;
    return k < 3u ? k : (k == 3u ? 2u : (k == 4u ? 1u : 3u));
}

// Neither infinite nor not a number.
bool puff_finite(float x) { return (floatBitsToInt(x) & 2147483647) < 2139095040; }

// Whether a particle can be drawn at all: `away2` is the square of its distance.
bool puff_drawn(float optical_depth, float radius, float albedo, float away2) {
    return puff_finite(optical_depth) && puff_finite(radius) && puff_finite(albedo) &&
           puff_finite(away2) && optical_depth > 0.0f && radius > 0.0f;
}

uint puff_mixed(uint hash, float value) {
    uint h = (hash ^ uint(floatBitsToInt(value))) * 2246822519u;
    return h ^ (h >> 15u);
}
// A number that a particle has whatever its place in a list. Of particles that differ in one value
// alone no two have the same: each step of it can be undone.
uint puff_fingerprint(vec3 position, float radius, float optical_depth, float albedo) {
    uint h = puff_mixed(2654435769u, position.x);
    h = puff_mixed(h, position.y);
    h = puff_mixed(h, position.z);
    h = puff_mixed(h, radius);
    h = puff_mixed(h, optical_depth);
    return puff_mixed(h, albedo);
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
