// Device side of skybark::kernels::cloud_layer.
#define KERNEL_VARYINGS 1
#define KERNEL_IMAGES 1
#include "../skeletons/parameters.glsl"

#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
    vec4 p = vec4(index == 1u ? 3.0 : -1.0, index == 2u ? 3.0 : -1.0, 1.0, 1.0);
    varying_out[0] = vec4(0.5 + 0.5 * p.x, 0.5 - 0.5 * p.y, 0.0, 0.0);
    return p;
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
    color_out = textureLod(kernel_images[0], varying_in[0].xy, 0.0);
    return color_out.a > 0.0;
}
#endif
