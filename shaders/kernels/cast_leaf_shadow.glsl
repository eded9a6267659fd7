// Device side of skybark::kernels::cast_leaf_shadow.
#define KERNEL_VARYINGS 1
#define KERNEL_IMAGES 1
#include "../skeletons/parameters.glsl"
#include "../shared/shading.glsl"
#include "scene.glsl.inc"
layout(std430, binding = 0) readonly buffer vertices_buffer { vec4 vertices[]; };
layout(std430, binding = 1) readonly buffer scene_buffer { scene_record scene; };

#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
    vec4 position = vertices[3u * index];
    varying_out[0] = vec4(position.w, vertices[3u * index + 1u].w, 0.0, 0.0);
    return scene.to_shadow * vec4(position.xyz, 1.0);
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
    color_out = vec4(0.0);
    return textureLod(kernel_images[0], varying_in[0].xy, 0.0).w >= 0.5;
}
#endif
