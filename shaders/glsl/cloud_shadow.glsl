// The shadow of clouds on whatever asks, for a shader of your own: what
// skybark::clouds::attenuation_volume made is one sampler3D (linear filter, edges clamped), its
// box().grid the light_grid: five vec4s, in any layout of a block.
#include "../shared/cloud_shadow.glsl"

// The part of the sun's light that reaches a place in the world: 1 above the clouds and beside them,
// below them what all that lies towards the sun leaves, however far below.
float cloud_sunlight(sampler3D attenuation, light_grid grid, vec3 place) {
    vec3 at = cloud_texel(grid, vec3(textureSize(attenuation, 0)), place);
    return cloud_light(textureLod(attenuation, at, 0.0).x);
}
