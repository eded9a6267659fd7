// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 33390aed2d56d3f7051aaaada41b54b83019f3b93a2eda10de7e5029617d51fc
#pragma once

#include <skybark/shared/glsl.hpp>

namespace skybark::shared {

// Light from all around at the points of a grid, kept as spherical harmonics up to l = 1 in one
// volume (skybark/gather/irradiance_volume.hpp), and what a surface among them receives.

struct irradiance_grid {
    vec4 low;      // xyz: place of the first point, m
    vec4 per_step; // xyz: 1 / m from a point to the next
    vec4 points;   // xyz: their numbers along the axes, 2 or more
};

// Where in the volume one of the twelve coefficients is sampled for a place (linear filter): red,
// green and blue have four each. Beyond the grid its border goes on. Along y the coefficients lie
// one above the other: of the half texel between two of them a 512th more is left out than would do
// with exact numbers, so that neither rounding nor a filter's eight bits mix them.
inline vec3 irradiance_texel(irradiance_grid grid, vec3 place, float coefficient)
{
    const float apart = 0.001953125f;
    float x = clamp((place.x - grid.low.x) * grid.per_step.x, 0.0f, grid.points.x - 1.0f);
    float y = clamp((place.y - grid.low.y) * grid.per_step.y, apart, grid.points.y - 1.0f - apart);
    float z = clamp((place.z - grid.low.z) * grid.per_step.z, 0.0f, grid.points.z - 1.0f);
    return vec3((x + 0.5f) / grid.points.x,
                (coefficient * grid.points.y + y + 0.5f) / (12.0f * grid.points.y),
                (z + 0.5f) / grid.points.z);
}

// One colour's irradiance for a unit normal, of its coefficients 1, y, z, x (Ramamoorthi and
// Hanrahan 2001, "An Efficient Representation for Irradiance Environment Maps": pi Y_0 c_0 and
// 2 pi / 3 Y_m c_m).
inline float irradiance_of_color(vec4 c, vec3 normal)
{
    return 0.886227f * c.x + 1.023327f * ((c.y * normal.y + c.z * normal.z) + c.w * normal.x);
}

// Irradiance of a surface with this unit normal. Not below 0, as the truncated series may be.
inline vec3 irradiance_of(vec4 red, vec4 green, vec4 blue, vec3 normal)
{
    return vec3(max(irradiance_of_color(red, normal), 0.0f),
                max(irradiance_of_color(green, normal), 0.0f),
                max(irradiance_of_color(blue, normal), 0.0f));
}

} // namespace skybark::shared
