// Device side of skybark::kernels::clear_sky.
#define KERNEL_VARYINGS 1
#include "../skeletons/parameters.glsl"
#include "../shared/shading.glsl"
#include "scene.glsl.inc"
layout(std430, binding = 0) readonly buffer scene_buffer { scene_record scene; };

#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
    vec4 p = vec4(index == 1u ? 3.0 : -1.0, index == 2u ? 3.0 : -1.0, 1.0, 1.0);
    varying_out[0] = scene.from_clip * p;
    return p;
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
bool kernel_fragment(vec2 pixel, bool front) {
    vec3 to = normalize(varying_in[0].xyz * (1.0 / varying_in[0].w) - scene.camera.xyz);
    color_out = vec4(sky_radiance(scene.sky, to), 1.0);
    return true;
}
#endif
