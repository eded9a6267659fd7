// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 1b35442e7ee25d5a8a544f2f423600d8dead6c335cb2669a9ef655bef6a5a950
#pragma once

#include <string_view>

namespace skybark::glsl {

/// Gathered light, for a shader of your own: what skybark::gather::irradiance_volume made is one
/// sampler3D (linear filter, edges clamped), its grid() the irradiance_grid: three vec4s, in any
/// layout of a block.
///
/// Defines irradiance_grid, irradiance_texel, irradiance_of_color, irradiance_of,
/// irradiance_coefficients, irradiance_at.
inline constexpr std::string_view irradiance_volume{R"glsl(// Gathered light, for a shader of your own: what skybark::gather::irradiance_volume made is one
// sampler3D (linear filter, edges clamped), its grid() the irradiance_grid: three vec4s, in any
// layout of a block.
//
// Defines irradiance_grid, irradiance_texel, irradiance_of_color, irradiance_of,
// irradiance_coefficients, irradiance_at.

#ifndef SKYBARK_IRRADIANCE_GRID
#define SKYBARK_IRRADIANCE_GRID
struct irradiance_grid {
    vec4 low;      // xyz: place of the first point, m
    vec4 per_step; // xyz: 1 / m from a point to the next
    vec4 points;   // xyz: their numbers along the axes, 2 or more
};
#endif

#ifndef SKYBARK_IRRADIANCE_TEXEL
#define SKYBARK_IRRADIANCE_TEXEL
// Where in the volume one of the twelve coefficients is sampled for a place (linear filter): red,
// green and blue have four each. Beyond the grid its border goes on. Along y the coefficients lie
// one above the other: of the half texel between two of them a 512th more is left out than would do
// with exact numbers, so that neither rounding nor a filter's eight bits mix them.
vec3 irradiance_texel(irradiance_grid grid, vec3 place, float coefficient)
{
    const float apart = 0.001953125f;
    float x = clamp((place.x - grid.low.x) * grid.per_step.x, 0.0f, grid.points.x - 1.0f);
    float y = clamp((place.y - grid.low.y) * grid.per_step.y, apart, grid.points.y - 1.0f - apart);
    float z = clamp((place.z - grid.low.z) * grid.per_step.z, 0.0f, grid.points.z - 1.0f);
    return vec3((x + 0.5f) / grid.points.x,
                (coefficient * grid.points.y + y + 0.5f) / (12.0f * grid.points.y),
                (z + 0.5f) / grid.points.z);
}
#endif

#ifndef SKYBARK_IRRADIANCE_OF_COLOR
#define SKYBARK_IRRADIANCE_OF_COLOR
// One colour's irradiance for a unit normal, of its coefficients 1, y, z, x (Ramamoorthi and
// Hanrahan 2001, "An Efficient Representation for Irradiance Environment Maps": pi Y_0 c_0 and
// 2 pi / 3 Y_m c_m).
float irradiance_of_color(vec4 c, vec3 normal)
{
    return 0.886227f * c.x + 1.023327f * ((c.y * normal.y + c.z * normal.z) + c.w * normal.x);
}
#endif

#ifndef SKYBARK_IRRADIANCE_OF
#define SKYBARK_IRRADIANCE_OF
// Irradiance of a surface with this unit normal. Not below 0, as the truncated series may be.
vec3 irradiance_of(vec4 red, vec4 green, vec4 blue, vec3 normal)
{
    return vec3(max(irradiance_of_color(red, normal), 0.0f),
                max(irradiance_of_color(green, normal), 0.0f),
                max(irradiance_of_color(blue, normal), 0.0f));
}
#endif

#ifndef SKYBARK_IRRADIANCE_COEFFICIENTS
#define SKYBARK_IRRADIANCE_COEFFICIENTS
// Four coefficients of one colour, of which the first is number `first` of the twelve.
vec4 irradiance_coefficients(sampler3D volume, irradiance_grid grid, vec3 place, float first) {
    return vec4(textureLod(volume, irradiance_texel(grid, place, first), 0.0).x,
                textureLod(volume, irradiance_texel(grid, place, first + 1.0), 0.0).x,
                textureLod(volume, irradiance_texel(grid, place, first + 2.0), 0.0).x,
                textureLod(volume, irradiance_texel(grid, place, first + 3.0), 0.0).x);
}
#endif

#ifndef SKYBARK_IRRADIANCE_AT
#define SKYBARK_IRRADIANCE_AT
// What a surface at a place, with this unit normal, receives, W/m^2. What leaves a diffuse one is
// its albedo over pi times that. Beyond the grid its border goes on.
vec3 irradiance_at(sampler3D volume, irradiance_grid grid, vec3 place, vec3 normal) {
    return irradiance_of(irradiance_coefficients(volume, grid, place, 0.0),
                         irradiance_coefficients(volume, grid, place, 4.0),
                         irradiance_coefficients(volume, grid, place, 8.0), normal);
}
#endif
)glsl", 3689};

} // namespace skybark::glsl
