// Device side of skybark::kernels::probe_volume_draw.
#define KERNEL_PARAMETERS uint read; int layer;
#define KERNEL_VARYINGS 1
#define KERNEL_IMAGES 1
#define KERNEL_VOLUMES 2
#include "../skeletons/parameters.glsl"
struct probe_vertex {
    vec4 position;
    vec4 color;
};
layout(std430, binding = 0) readonly buffer vertices_buffer { probe_vertex vertices[]; };

#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
    varying_out[0] = vertices[index].color;
    return vertices[index].position;
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
    vec3 place = varying_in[0].xyz;
    ivec3 cell = ivec3(ivec2(pixel), layer);
    switch (read) {
    case 0u:
        color_out = vec4(textureLod(kernel_volumes[0], place, 0.0).x,
                         textureLod(kernel_volumes[1], place, 0.0).x,
                         textureLod(kernel_images[0], place.xy, 0.0).x, 1.0);
        break;
    case 1u:
        color_out = vec4(texelFetch(kernel_volumes[0], cell, 0).x,
                         texelFetch(kernel_volumes[1], cell, 0).x,
                         texelFetch(kernel_images[0], cell.xy, 0).x, 1.0);
        break;
    default:
        color_out = vec4(textureSize(kernel_volumes[0], 0), textureSize(kernel_volumes[1], 0).x);
        break;
    }
    return true;
}
#endif
