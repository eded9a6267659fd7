// The shadow of a cloud on whatever asks: the attenuation volume read at a place in the world. With
// `volume` a sampler3D of the attenuation volume,
//
//     vec3 at = cloud_texel(grid, vec3(textureSize(volume, 0)), place);
//     float sun = cloud_light(textureLod(volume, at, 0.0).x);
//
// with linear filtering and clamped edges, is the part of the sun's light that reaches the place:
// above the cloud and beside it 1, below it what is left by all that lies towards the sun, however
// far below. shaders/glsl/cloud_shadow.glsl is that, for callers' own shaders.
#include "records.glsl"
#include "attenuation.glsl"

// Texture coordinates of a place. `voxels` are the sides of the volume in voxels.
vec3 cloud_texel(light_grid grid, vec3 voxels, vec3 place) {
    vec3 cells = cells_of(grid, place);
    return vec3(cells.x / voxels.x, cells.y / voxels.y, cells.z / voxels.z);
}

// The light that an attenuation leaves. Negative attenuation (the paper's product can amplify)
// is light above 1; beyond 1e26 it stays a number.
float cloud_light(float attenuation) {
    return attenuation < 0.0f ? 1.0f / exp_minus(min(-attenuation, 60.0f)) : exp_minus(attenuation);
}
