// Device side of skybark::kernels::probe_image.
#define KERNEL_PARAMETERS uint read; int offset_x; int offset_y;
#define KERNEL_VARYINGS 1
#define KERNEL_IMAGES 2
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
    ivec2 texel = ivec2(pixel) + ivec2(offset_x, offset_y);
    vec2 uv = varying_in[0].xy;
    switch (read) {
    case 0u:
        color_out = texelFetch(kernel_images[0], texel, 0);
        break;
    case 1u:
        color_out = textureLod(kernel_images[0], uv, 0.0);
        break;
    case 2u:
        color_out = vec4(textureSize(kernel_images[0], 0), textureSize(kernel_images[1], 0));
        break;
    case 3u:
        color_out = texelFetch(kernel_images[1], texel, 0);
        break;
    default:
        color_out = textureLod(kernel_images[1], uv, 0.0);
        break;
    }
    return true;
}
#endif
