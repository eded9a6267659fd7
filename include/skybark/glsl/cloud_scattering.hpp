// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 efcf56fd964cad32718482ae6092e0e53e190e4f49fb747cd80d583b17a79575
#pragma once

#include <string_view>

namespace skybark::glsl {

/// Light that clouds scatter towards the eye, for a shader of your own that draws them: once, as the
/// phase function says, and more than once, as skybark::clouds::multiple_scattering says. Its
/// fluence() is one sampler3D (linear filter, edges clamped), its grid(box) the light_grid.
///
/// Defines light_grid, cells_of, cloud_texel, phase_henyey_greenstein, phase_draine, phase_value,
/// scaled_scattering, scattering_without, cloud_fluence, cloud_scattered.
inline constexpr std::string_view cloud_scattering{R"glsl(// Light that clouds scatter towards the eye, for a shader of your own that draws them: once, as the
// phase function says, and more than once, as skybark::clouds::multiple_scattering says. Its
// fluence() is one sampler3D (linear filter, edges clamped), its grid(box) the light_grid.
//
// Defines light_grid, cells_of, cloud_texel, phase_henyey_greenstein, phase_draine, phase_value,
// scaled_scattering, scattering_without, cloud_fluence, cloud_scattered.

#ifndef SKYBARK_LIGHT_GRID
#define SKYBARK_LIGHT_GRID
struct light_grid {
    vec4 anchor;
    vec4 row_x;
    vec4 row_y;
    vec4 row_z;
    vec4 voxel;
};
#endif

#ifndef SKYBARK_CELLS_OF
#define SKYBARK_CELLS_OF
// Where a place lies in the grid, in voxels.
vec3 cells_of(light_grid grid, vec3 place)
{
    float px = place.x - grid.anchor.x;
    float py = place.y - grid.anchor.y;
    float pz = place.z - grid.anchor.z;
    return vec3(grid.row_x.x * px + grid.row_x.y * py + grid.row_x.z * pz + grid.row_x.w,
                grid.row_y.x * px + grid.row_y.y * py + grid.row_y.z * pz + grid.row_y.w,
                grid.row_z.x * px + grid.row_z.y * py + grid.row_z.z * pz + grid.row_z.w);
}
#endif

#ifndef SKYBARK_CLOUD_TEXEL
#define SKYBARK_CLOUD_TEXEL
// Texture coordinates of a place. `voxels` are the sides of the volume in voxels.
vec3 cloud_texel(light_grid grid, vec3 voxels, vec3 place) {
    vec3 cells = cells_of(grid, place);
    return vec3(cells.x / voxels.x, cells.y / voxels.y, cells.z / voxels.z);
}
#endif

#ifndef SKYBARK_PHASE_HENYEY_GREENSTEIN
#define SKYBARK_PHASE_HENYEY_GREENSTEIN
// Henyey and Greenstein 1941; -1 < g < 1.
float phase_henyey_greenstein(float g, float u) {
    float a = 1.0f - g;
    float s = a * a + 2.0f * g * (1.0f - u);
    return 0.079577472f * a * (1.0f + g) / (s * sqrt(s));
}
#endif

#ifndef SKYBARK_PHASE_DRAINE
#define SKYBARK_PHASE_DRAINE
// Draine 2003; -1 < g < 1, alpha >= 0. Henyey-Greenstein at alpha 0, Rayleigh at g 0 and alpha 1.
float phase_draine(float g, float alpha, float u) {
    return phase_henyey_greenstein(g, u) * (1.0f + alpha * u * u) /
           (1.0f + alpha * (1.0f + 2.0f * g * g) * 0.33333333f);
}
#endif

#ifndef SKYBARK_PHASE_VALUE
#define SKYBARK_PHASE_VALUE
// 1/sr at the cosine u of the scattering angle.
float phase_value(vec4 phase, float u) {
    return (1.0f - phase.w) * phase_henyey_greenstein(phase.x, u) +
           phase.w * phase_draine(phase.y, phase.z, u);
}
#endif

#ifndef SKYBARK_SCALED_SCATTERING
#define SKYBARK_SCALED_SCATTERING
// What scatters, where a part f of what is scattered goes on as if nothing had happened: optical
// depths shrink to `depth` of themselves. Light that is scattered once has its whole phase function,
// times `single` (Nakajima and Tanaka 1988, the TMS correction); of light that was scattered before
// `diffuse` is scattered again (Joseph, Wiscombe and Weinman 1976).
struct scaled_scattering {
    float depth;
    float single;
    float diffuse;
};
#endif

#ifndef SKYBARK_SCATTERING_WITHOUT
#define SKYBARK_SCATTERING_WITHOUT
scaled_scattering scattering_without(float albedo, float forward) {
    float depth = 1.0f - albedo * forward;
    scaled_scattering scaled;
    scaled.depth = depth;
    scaled.single = albedo / depth;
    scaled.diffuse = albedo * (1.0f - forward) / depth;
    return scaled;
}
#endif

#ifndef SKYBARK_CLOUD_FLUENCE
#define SKYBARK_CLOUD_FLUENCE
// The fluence of light that was scattered more than once, over the sun's irradiance, at a place in
// the cloud.
float cloud_fluence(sampler3D fluence, light_grid grid, vec3 place) {
    return textureLod(fluence, cloud_texel(grid, vec3(textureSize(fluence, 0)), place), 0.0).x;
}
#endif

#ifndef SKYBARK_CLOUD_SCATTERED
#define SKYBARK_CLOUD_SCATTERED
// What a place in the cloud sends towards the eye, over the sun's irradiance, 1/sr, where no light
// gets through; a piece of optical depth tau along the ray sends 1 - exp(-tau depth) of it, `depth`
// that of scattering_without(albedo, forward). `sun` is cloud_sunlight there, `forward` that of the
// volumes (phase_function::forward_energy()), `phase` phase_function::parameters(), `cosine` that of
// the angle between the sunlight and the way to the eye: 1 against the sun.
float cloud_scattered(float sun, float fluence, float albedo, float forward, vec4 phase,
                      float cosine) {
    scaled_scattering scaled = scattering_without(albedo, forward);
    return scaled.single * sun * phase_value(phase, cosine) +
           scaled.diffuse * fluence * 0.079577472f;
}
#endif
)glsl", 4541};

} // namespace skybark::glsl
