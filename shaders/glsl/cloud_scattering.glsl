// Light that clouds scatter towards the eye, for a shader of your own that draws them: once, as the
// phase function says, and more than once, as skybark::clouds::multiple_scattering says. Its
// fluence() is one sampler3D (linear filter, edges clamped), its grid(box) the light_grid.
#include "../shared/cloud_shadow.glsl"
#include "../shared/cloud_lighting.glsl"
#include "../shared/phase.glsl"

// The fluence of light that was scattered more than once, over the sun's irradiance, at a place in
// the cloud.
float cloud_fluence(sampler3D fluence, light_grid grid, vec3 place) {
    return textureLod(fluence, cloud_texel(grid, vec3(textureSize(fluence, 0)), place), 0.0).x;
}

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
