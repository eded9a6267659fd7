// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 d5f6073074174ee906554b54aa58484933a2d646318903da133c10c20b44e752
#pragma once

#include <skybark/shared/glsl.hpp>

namespace skybark::shared {

// Sums of gathered light, and what they say (the estimator: skybark/gather/final_gather.hpp).

inline float luminance_of(vec4 light)
{
    return (0.2126f * light.x + 0.7152f * light.y) + 0.0722f * light.z;
}

// The cosine of a direction with a sample's normal, without its sign; 0 where either its place or
// its normal is no number, so that it gathers nothing.
inline float weight_of_sample(gather_sample at, vec4 direction)
{
    float along = (at.normal.x * direction.x + at.normal.y * direction.y) +
                          at.normal.z * direction.z;
    float weight = abs(along);
    bool usable = weight <= 2.0f && abs(at.position.x) <= 1e30f && abs(at.position.y) <= 1e30f &&
                  abs(at.position.z) <= 1e30f;
    return usable ? weight : 0.0f;
}

inline vec4 light_sum(vec4 sum, vec4 radiance, float weight)
{
    float r = sum.x + radiance.x * weight;
    float g = sum.y + radiance.y * weight;
    float b = sum.z + radiance.z * weight;
    float w = sum.w + weight;
    return vec4(r, g, b, w);
}

// A direction's radiance and its three moments along x, y and z, of one colour.
inline vec4 moment_sum(vec4 sum, float radiance, vec4 direction, float side)
{
    float mean = sum.x + radiance;
    float x = sum.y + radiance * (side * direction.x);
    float y = sum.z + radiance * (side * direction.y);
    float z = sum.w + radiance * (side * direction.z);
    return vec4(mean, x, y, z);
}

// From such a sum to the coefficients c_m = ∫ L Y_m of the real spherical harmonics Y_0 = 0.282095,
// and 0.488603 times y, z and x, in that order, where each direction stands for the solid angle
// `each`.
inline vec4 harmonics_of(vec4 moments, float each)
{
    float mean = each * (0.282094792f * moments.x);
    float y = each * (0.488602512f * moments.z);
    float z = each * (0.488602512f * moments.w);
    float x = each * (0.488602512f * moments.y);
    return vec4(mean, y, z, x);
}

// Radiance that leaves a diffuse surface: what it emits, and parts of what arrives on both sides.
inline vec4 leaving_radiance(gather_material material, vec4 here, vec4 behind)
{
    const float over_pi = 0.318309886f;
    float r = material.emission.x + over_pi * (material.diffuse.x * here.x +
                                               material.transmission.x * behind.x);
    float g = material.emission.y + over_pi * (material.diffuse.y * here.y +
                                               material.transmission.y * behind.y);
    float b = material.emission.z + over_pi * (material.diffuse.z * here.z +
                                               material.transmission.z * behind.z);
    return vec4(r, g, b, 0.0f);
}

} // namespace skybark::shared
