// Device side of skybark::kernels::meadow_bark.
#define KERNEL_VARYINGS 3
#define KERNEL_IMAGES 2
#define KERNEL_VOLUMES 2
#define KERNEL_PARAMETERS                                                                          \
    vec4 low; vec4 high; float repeats_around; float repeats_along; float strength;
#include "../skeletons/parameters.glsl"
#include "../shared/meadow_light.glsl"
#include "../shared/surfaces.glsl"
#include "scene.glsl.inc"
layout(std430, binding = 0) readonly buffer vertices_buffer { vec4 vertices[]; };
layout(std430, binding = 1) readonly buffer scene_buffer { scene_record scene; };
layout(std430, binding = 2) readonly buffer around_buffer { surroundings_record around; };
#include "meadow_scene.glsl.inc"

#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
    varying_out[0] = vertices[3u * index];
    varying_out[1] = vertices[3u * index + 1u];
    varying_out[2] = vertices[3u * index + 2u];
    return scene.to_clip * vec4(varying_out[0].xyz, 1.0);
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
    vec3 position = varying_in[0].xyz;
    vec3 geometric = normalize(varying_in[1].xyz);
    vec4 texel = textureLod(kernel_images[1], vec2(varying_in[0].w * repeats_around,
                                                   varying_in[1].w * repeats_along), 0.0);
    bark_surface surface =
        bark_surface_of(texel, geometric, varying_in[2], low.xyz, high.xyz, strength);
    float sun = dot(geometric, scene.sky.to_sun.xyz) > 0.0
                    ? sun_at(scene, position, geometric) * sun_behind_clouds(position)
                    : 0.0;
    vec3 gathered = gathered_irradiance(gathered_at(position), surface.normal);
    vec3 light = meadow_lit(surface.albedo, surface.normal, scene.sky, sun, gathered);
    vec3 away = position - scene.camera.xyz;
    color_out = vec4(meadow_through_air(around, scene.sky, light, away), 1.0);
    return true;
}
#endif
