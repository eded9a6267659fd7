// Device side of skybark::kernels::lit_branch.
#define KERNEL_VARYINGS 3
#define KERNEL_IMAGES 1
#define KERNEL_PARAMETERS float relief; uint plain;
#include "../skeletons/parameters.glsl"
#include "../shared/shading.glsl"
#include "scene.glsl.inc"
layout(std430, binding = 0) readonly buffer vertices_buffer { vec4 vertices[]; };
layout(std430, binding = 1) readonly buffer scene_buffer { scene_record scene; };

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
    float u = varying_in[0].w;
    float v = varying_in[1].w;
    vec3 n = normalize(varying_in[1].xyz);
    vec3 geometric = n;
    vec3 albedo = vec3(0.30, 0.21, 0.14);
    if (plain == 0u) {
        float height = bark_height(u, v, 12u);
        albedo = bark_albedo(height);
        vec3 t = normalize(varying_in[2].xyz);
        vec3 b = cross(n, t) * varying_in[2].w;
        float du = bark_height(u + 0.01, v, 12u) - height;
        float dv = bark_height(u, v + 0.01, 12u) - height;
        n = normalize(n - t * (du * relief) - b * (dv * relief));
    }
    vec3 ambient = ambient_light(scene.ambient[0], scene.ambient[1], scene.ambient[2],
                                 scene.ambient[3], n);
    float sun = dot(geometric, scene.sky.to_sun.xyz) > 0.0 ? sun_at(scene, position, geometric) : 0.0;
    color_out = vec4(lit(albedo, n, scene.sky, sun, ambient), 1.0);
    return true;
}
#endif
