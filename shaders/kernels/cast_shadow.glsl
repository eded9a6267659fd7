// Device side of skybark::kernels::cast_shadow.
#define KERNEL_VARYINGS 1
#include "../skeletons/parameters.glsl"
#include "../shared/shading.glsl"
#include "scene.glsl.inc"
layout(std430, binding = 0) readonly buffer vertices_buffer { vec4 vertices[]; };
layout(std430, binding = 1) readonly buffer scene_buffer { scene_record scene; };

#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
    varying_out[0] = vec4(0.0);
    return scene.to_shadow * vec4(vertices[3u * index].xyz, 1.0);
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
    color_out = vec4(0.0);
    return true;
}
#endif
