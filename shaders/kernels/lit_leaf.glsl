// Device side of skybark::kernels::lit_leaf.
#define KERNEL_VARYINGS 2
#define KERNEL_IMAGES 2
#define KERNEL_PARAMETERS float through; float sky;
#include "../skeletons/parameters.glsl"
#include "../shared/shading.glsl"
#include "../shared/surfaces.glsl"
#include "scene.glsl.inc"
layout(std430, binding = 0) readonly buffer vertices_buffer { vec4 vertices[]; };
layout(std430, binding = 1) readonly buffer scene_buffer { scene_record scene; };

#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
    varying_out[0] = vertices[3u * index];
    varying_out[1] = vertices[3u * index + 1u];
    return scene.to_clip * vec4(varying_out[0].xyz, 1.0);
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
vec3 ambient_of(vec3 n) {
    return ambient_light(scene.ambient[0], scene.ambient[1], scene.ambient[2], scene.ambient[3], n);
}

bool kernel_fragment(vec2 pixel, bool front) {
    vec4 texel = textureLod(kernel_images[1], vec2(varying_in[0].w, varying_in[1].w), 0.0);
    if (texel.w < 0.5) {
        return false;
    }
    vec3 position = varying_in[0].xyz;
    vec3 upper = normalize(varying_in[1].xyz);
    vec3 n = front ? upper : -upper;
    float facing = dot(n, scene.sky.to_sun.xyz);
    float sun = sun_at(scene, position, facing > 0.0 ? n : -n);
    vec3 here = ambient_of(n) * sky;
    vec3 behind = ambient_of(-n) * sky;
    vec3 light = scene.sky.sunlight.xyz * sun;
    color_out = vec4(leaf_surface_lit(leaf_surface_of(texel, through), light, facing, here, behind),
                     1.0);
    return true;
}
#endif
