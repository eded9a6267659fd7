// Light at single places, out of what an attenuation volume holds around them.
#include "records.glsl"
#include "attenuation.glsl"
#include "cloud_shadow.glsl"

// Linear between four values, x and z in 0…1.
float bilinear(float v00, float v10, float v01, float v11, float x, float z) {
    float front = v00 + (v10 - v00) * x;
    float back = v01 + (v11 - v01) * x;
    return front + (back - front) * z;
}

// The mean light of octaves, each with `weight` and `part` of the attenuation of the one before.
// One octave: the light that comes through, and so it is for none.
float octaves_light(float attenuation, uint octaves, float weight, float part) {
    float sum = cloud_light(attenuation);
    float weights = 1.0f;
    float w = weight;
    float depth = attenuation * part;
    for (uint i = 1u; i < octaves; i = i + 1u) {
        sum = sum + w * cloud_light(depth);
        weights = weights + w;
        w = w * weight;
        depth = depth * part;
    }
    return sum / weights;
}

// The part of a cloud's scattered light that is left at a distance from the box around it: a ball
// of this radius as seen from there, over what it is at its surface, as solid angles,
// 1 − √(1 − s²), s the sine of the angle of its edge.
float scattered_part(float distance, float radius) {
    float s = radius / (radius + distance);
    return s * s / (1.0f + sqrt(1.0f - s * s));
}
