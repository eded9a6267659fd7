// Gathered light, for a shader of your own: what skybark::gather::irradiance_volume made is one
// sampler3D (linear filter, edges clamped), its grid() the irradiance_grid: three vec4s, in any
// layout of a block.
#include "../shared/irradiance_grid.glsl"

// Four coefficients of one colour, of which the first is number `first` of the twelve.
vec4 irradiance_coefficients(sampler3D volume, irradiance_grid grid, vec3 place, float first) {
    return vec4(textureLod(volume, irradiance_texel(grid, place, first), 0.0).x,
                textureLod(volume, irradiance_texel(grid, place, first + 1.0), 0.0).x,
                textureLod(volume, irradiance_texel(grid, place, first + 2.0), 0.0).x,
                textureLod(volume, irradiance_texel(grid, place, first + 3.0), 0.0).x);
}

// What a surface at a place, with this unit normal, receives, W/m². What leaves a diffuse one is
// its albedo over pi times that. Beyond the grid its border goes on.
vec3 irradiance_at(sampler3D volume, irradiance_grid grid, vec3 place, vec3 normal) {
    return irradiance_of(irradiance_coefficients(volume, grid, place, 0.0),
                         irradiance_coefficients(volume, grid, place, 4.0),
                         irradiance_coefficients(volume, grid, place, 8.0), normal);
}
