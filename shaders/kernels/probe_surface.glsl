// Device side of skybark::kernels::probe_surface.
#define KERNEL_PARAMETERS uint show; uint tint; float cutoff;
#define KERNEL_VARYINGS 1
#include "../skeletons/parameters.glsl"
struct probe_vertex {
    vec4 position;
    vec4 color;
};
layout(std430, binding = 0) readonly buffer vertices_buffer { probe_vertex vertices[]; };
layout(std430, binding = 1) readonly buffer tints_buffer { vec4 tints[]; };

#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
    varying_out[0] = vertices[index].color;
    return vertices[index].position;
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
    if (show == 1u) {
        color_out = vec4(pixel.x, pixel.y, front ? 1.0 : 0.0, 1.0);
        return true;
    }
    color_out = varying_in[0] * tints[tint];
    return color_out.w >= cutoff;
}
#endif
