// Device side of skybark::kernels::develop.
#define KERNEL_VARYINGS 1
#define KERNEL_IMAGES 1
#define KERNEL_PARAMETERS uint samples; float exposure;
#include "../skeletons/parameters.glsl"
#include "../shared/shading.glsl"
#include "../shared/dither.glsl"

#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
    varying_out[0] = vec4(0.0);
    return vec4(index == 1u ? 3.0 : -1.0, index == 2u ? 3.0 : -1.0, 0.0, 1.0);
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
    vec3 sum = vec3(0.0);
    ivec2 first = ivec2(pixel) * int(samples);
    for (int y = 0; y < int(samples); ++y) {
        for (int x = 0; x < int(samples); ++x) {
            vec3 c = texelFetch(kernel_images[0], first + ivec2(x, y), 0).rgb * exposure;
            sum += vec3(display(c.r), display(c.g), display(c.b));
        }
    }
    float shift = ordered_dither(int(pixel.x), int(pixel.y)) * (1.0 / 255.0);
    color_out = vec4(sum / float(samples * samples) + shift, 1.0);
    return true;
}
#endif
