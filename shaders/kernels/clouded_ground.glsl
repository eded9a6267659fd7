// Device side of skybark::kernels::clouded_ground.
#define KERNEL_VARYINGS 1
#define KERNEL_VOLUMES 1
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS light_grid grid; float height; float extent; float air; float shadow;
#include "../skeletons/parameters.glsl"
#include "../shared/shading.glsl"
#include "../shared/cloud_shadow.glsl"
#include "../shared/country.glsl"
#include "scene.glsl.inc"
layout(std430, binding = 0) readonly buffer scene_buffer { scene_record scene; };

#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
    uint corner = index < 3u ? index : (index == 3u ? 2u : (index == 4u ? 1u : 3u));
    vec3 p = vec3(scene.camera.x + ((corner & 1u) != 0u ? extent : -extent), height,
                  scene.camera.z + ((corner & 2u) != 0u ? -extent : extent));
    varying_out[0] = vec4(p, 0.0);
    return scene.to_clip * vec4(p, 1.0);
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
    vec3 p = varying_in[0].xyz;
    float sun = 1.0;
    if (shadow > 0.0) {
        vec3 at = cloud_texel(grid, vec3(textureSize(kernel_volumes[0], 0)), p);
        sun = cloud_light(textureLod(kernel_volumes[0], at, 0.0).x);
    }
    vec3 up = vec3(0.0, 1.0, 0.0);
    vec3 ambient = ambient_light(scene.ambient[0], scene.ambient[1], scene.ambient[2],
                                 scene.ambient[3], up);
    vec3 away = p - scene.camera.xyz;
    float far = length(away);
    vec3 light = lit(country_albedo(p.x, p.z, far), up, scene.sky, sun, ambient);
    vec3 before = sky_radiance(scene.sky, away * (1.0 / far));
    color_out = vec4(mix(light, before, one_minus_exp(air * far)), 1.0);
    return true;
}
#endif
