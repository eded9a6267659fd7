// Sums of gathered light, and what they say (the estimator: skybark/gather/final_gather.hpp).
#include "records.glsl"

float luminance_of(vec4 light)
{
    return (0.2126f * light.x + 0.7152f * light.y) + 0.0722f * light.z;
}

// The cosine of a direction with a sample's normal, without its sign; 0 where either its place or
// its normal is no number, so that it gathers nothing.
float weight_of_sample(gather_sample at, vec4 direction)
{
    precise float along = (at.normal.x * direction.x + at.normal.y * direction.y) +
                          at.normal.z * direction.z;
    float weight = abs(along);
    bool usable = weight <= 2.0f && abs(at.position.x) <= 1e30f && abs(at.position.y) <= 1e30f &&
                  abs(at.position.z) <= 1e30f;
    return usable ? weight : 0.0f;
}

vec4 light_sum(vec4 sum, vec4 radiance, float weight)
{
    precise float r = sum.x + radiance.x * weight;
    precise float g = sum.y + radiance.y * weight;
    precise float b = sum.z + radiance.z * weight;
    precise float w = sum.w + weight;
    return vec4(r, g, b, w);
}

// A direction's radiance and its three moments along x, y and z, of one colour.
vec4 moment_sum(vec4 sum, float radiance, vec4 direction, float side)
{
    precise float mean = sum.x + radiance;
    precise float x = sum.y + radiance * (side * direction.x);
    precise float y = sum.z + radiance * (side * direction.y);
    precise float z = sum.w + radiance * (side * direction.z);
    return vec4(mean, x, y, z);
}

// From such a sum to the coefficients c_m = ∫ L Y_m of the real spherical harmonics Y_0 = 0.282095,
// and 0.488603 times y, z and x, in that order, where each direction stands for the solid angle
// `each`.
vec4 harmonics_of(vec4 moments, float each)
{
    precise float mean = each * (0.282094792f * moments.x);
    precise float y = each * (0.488602512f * moments.z);
    precise float z = each * (0.488602512f * moments.w);
    precise float x = each * (0.488602512f * moments.y);
    return vec4(mean, y, z, x);
}

// Radiance that leaves a diffuse surface: what it emits, and parts of what arrives on both sides.
vec4 leaving_radiance(gather_material material, vec4 here, vec4 behind)
{
    const float over_pi = 0.318309886f;
    precise float r = material.emission.x + over_pi * (material.diffuse.x * here.x +
                                               material.transmission.x * behind.x);
    precise float g = material.emission.y + over_pi * (material.diffuse.y * here.y +
                                               material.transmission.y * behind.y);
    precise float b = material.emission.z + over_pi * (material.diffuse.z * here.z +
                                               material.transmission.z * behind.z);
    return vec4(r, g, b, 0.0f);
}
