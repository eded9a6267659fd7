// Device side of skybark::kernels::meadow_land.
#define KERNEL_VARYINGS 3
#define KERNEL_IMAGES 1
#define KERNEL_VOLUMES 1
#include "../skeletons/parameters.glsl"
#include "../shared/meadow_light.glsl"
#include "scene.glsl.inc"
layout(std430, binding = 0) readonly buffer vertices_buffer { vec4 vertices[]; };
layout(std430, binding = 1) readonly buffer scene_buffer { scene_record scene; };
layout(std430, binding = 2) readonly buffer around_buffer { surroundings_record around; };
layout(std430, binding = 3) readonly buffer irradiance_buffer { vec4 irradiance[]; };
#include "meadow_scene.glsl.inc"

#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
    vec4 position = vertices[3u * index];
    varying_out[0] = vec4(position.xyz, 0.0);
    varying_out[1] = vec4(vertices[3u * index + 1u].xyz, 0.0);
    varying_out[2] = irradiance[uint(position.w)];
    return scene.to_clip * vec4(position.xyz, 1.0);
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
    vec3 position = varying_in[0].xyz;
    vec3 normal = normalize(varying_in[1].xyz);
    vec3 away = position - scene.camera.xyz;
    vec3 albedo = meadow_albedo(position.x, position.z, length(away));
    float sun = sun_at(scene, position, normal) * sun_behind_clouds(position);
    vec3 light = meadow_lit(albedo, normal, scene.sky, sun, varying_in[2].xyz);
    color_out = vec4(meadow_through_air(around, scene.sky, light, away), 1.0);
    return true;
}
#endif
