// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 5a1f19912e788e80b6a4a26ff1bfffb5919bdd19571e94e5300b045237800d10

// The shadow of clouds on whatever asks, for a shader of your own: what
// skybark::clouds::attenuation_volume made is one sampler3D (linear filter, edges clamped), its
// box().grid the light_grid: five vec4s, in any layout of a block.
//
// Defines light_grid, exp_minus, cells_of, cloud_texel, cloud_light, cloud_sunlight.

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

#ifndef SKYBARK_EXP_MINUS
#define SKYBARK_EXP_MINUS
// e^-x for 0 <= x < 87, to 2e-7 of itself; 0 beyond, and for what is no number. Cody and Waite's reduction, then a series.
float exp_minus(float x)
{
    float within = x < 87.0f ? x : 87.0f;
    float halvings = floor(within * 1.44269504f + 0.5f);
    float r = halvings * 0.693145752f - within;
    r = r + halvings * 1.42860677e-6f;
    float p = 1.0f + r * (1.0f / 7.0f);
    p = 1.0f + r * (1.0f / 6.0f) * p;
    p = 1.0f + r * (1.0f / 5.0f) * p;
    p = 1.0f + r * (1.0f / 4.0f) * p;
    p = 1.0f + r * (1.0f / 3.0f) * p;
    p = 1.0f + r * (1.0f / 2.0f) * p;
    p = 1.0f + r * p;
    int exponent = 127 - int(halvings);
    return x < 87.0f ? p * intBitsToFloat(exponent * 8388608) : 0.0f;
}
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

#ifndef SKYBARK_CLOUD_LIGHT
#define SKYBARK_CLOUD_LIGHT
// The light that an attenuation leaves. Negative attenuation (the paper's product can amplify)
// is light above 1; beyond 1e26 it stays a number.
float cloud_light(float attenuation) {
    return attenuation < 0.0f ? 1.0f / exp_minus(min(-attenuation, 60.0f)) : exp_minus(attenuation);
}
#endif

#ifndef SKYBARK_CLOUD_SUNLIGHT
#define SKYBARK_CLOUD_SUNLIGHT
// The part of the sun's light that reaches a place in the world: 1 above the clouds and beside them,
// below them what all that lies towards the sun leaves, however far below.
float cloud_sunlight(sampler3D attenuation, light_grid grid, vec3 place) {
    vec3 at = cloud_texel(grid, vec3(textureSize(attenuation, 0)), place);
    return cloud_light(textureLod(attenuation, at, 0.0).x);
}
#endif
