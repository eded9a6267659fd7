// Value noise from integers: the same on every backend up to the rounding of the interpolation.
#include "records.glsl"

// A hash of three integers (Jenkins' one-at-a-time finaliser over their mix), as 0 ... 1.
float hash_unit(uint x, uint y, uint z) {
    uint h = x * 73856093u ^ y * 19349663u ^ z * 83492791u;
    h = h ^ (h >> 16u);
    h = h * 2246822519u;
    h = h ^ (h >> 13u);
    h = h * 3266489917u;
    h = h ^ (h >> 16u);
    return float(h >> 8u) * (1.0f / 16777216.0f);
}

// Smooth noise with lattice period 1, 0 ... 1. The first coordinate repeats after `period` cells.
float value_noise(float x, float y, float z, uint period) {
    float fx = floor(x);
    float fy = floor(y);
    float fz = floor(z);
    float tx = x - fx;
    float ty = y - fy;
    float tz = z - fz;
    tx = tx * tx * (3.0f - 2.0f * tx);
    ty = ty * ty * (3.0f - 2.0f * ty);
    tz = tz * tz * (3.0f - 2.0f * tz);
    uint x0 = uint(int(fx) + 1048576) % period;
    uint x1 = (x0 + 1u) % period;
    uint y0 = uint(int(fy) + 1048576);
    uint z0 = uint(int(fz) + 1048576);
    float n00 = mix(hash_unit(x0, y0, z0), hash_unit(x1, y0, z0), tx);
    float n10 = mix(hash_unit(x0, y0 + 1u, z0), hash_unit(x1, y0 + 1u, z0), tx);
    float n01 = mix(hash_unit(x0, y0, z0 + 1u), hash_unit(x1, y0, z0 + 1u), tx);
    float n11 = mix(hash_unit(x0, y0 + 1u, z0 + 1u), hash_unit(x1, y0 + 1u, z0 + 1u), tx);
    return mix(mix(n00, n10, ty), mix(n01, n11, ty), tz);
}
