// Device side of skybark::kernels::lit_grid.
#define KERNEL_VARYINGS 1
#define KERNEL_IMAGES 1
#define KERNEL_VOLUMES 4
#define KERNEL_PARAMETERS vec4 low; vec4 high; float step_length;
#include "../skeletons/parameters.glsl"
#include "../shared/shading.glsl"
#include "../shared/cloud_lighting.glsl"
#include "scene.glsl.inc"
layout(std430, binding = 0) readonly buffer scene_buffer { scene_record scene; };
layout(std430, binding = 1) readonly buffer lighting_buffer { cloud_lighting lighting; };
#include "cloud_scene.glsl.inc"

#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
    vec4 p = vec4(index == 1u ? 3.0 : -1.0, index == 2u ? 3.0 : -1.0, 0.0, 1.0);
    varying_out[0] = scene.from_clip * vec4(p.xy, 1.0, 1.0);
    return p;
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
const float least_light = 1.0 / 2048.0;

// How far from the eye what the pixel's depth shows is.
float surface(vec2 pixel, float depth) {
    vec2 size = vec2(textureSize(kernel_images[0], 0));
    vec4 at = scene.from_clip *
              vec4(pixel.x / size.x * 2.0 - 1.0, 1.0 - pixel.y / size.y * 2.0, depth, 1.0);
    return length(at.xyz * (1.0 / at.w) - scene.camera.xyz);
}

bool kernel_fragment(vec2 pixel, bool front) {
    vec3 eye = scene.camera.xyz;
    vec3 direction = normalize(varying_in[0].xyz * (1.0 / varying_in[0].w) - eye);
    vec2 part = ray_in_box(eye, direction, low.xyz, high.xyz);
    float opaque = texelFetch(kernel_images[0], ivec2(pixel), 0).x;
    float last = opaque < 1.0 ? min(part.y, surface(pixel, opaque)) : part.y;
    if (!(last > part.x)) {
        return false;
    }
    int steps = clamp(int((last - part.x) / step_length) + 1, 1, 512);
    float span = (last - part.x) / float(steps);
    scaled_scattering scaled = scattering_without(high.w, lighting.forward);
    float extinction = low.w * scaled.depth * span;
    vec3 over = vec3(1.0) / (high.xyz - low.xyz);
    vec3 seen = vec3(0.0);
    float through = 1.0;
    float air = 0.0;
    for (int i = 0; i < steps && through > least_light; ++i) {
        float at = part.x + (float(i) + 0.5) * span;
        vec3 place = eye + direction * at;
        float density = textureLod(kernel_volumes[3], (place - low.xyz) * over, 0.0).x;
        if (density > 0.0) {
            float alpha = one_minus_exp(extinction * density);
            float hidden = air_between(lighting.air, at);
            seen += cloud_source(place, direction, -1.0, scaled.single, scaled.diffuse) *
                    (through * alpha * (1.0 - hidden));
            air += through * alpha * hidden;
            through *= 1.0 - alpha;
        }
    }
    if (through >= 1.0) {
        return false;
    }
    if (air > 0.0) {
        seen += sky_radiance(scene.sky, direction) * air;
    }
    color_out = vec4(seen, 1.0 - through);
    return true;
}
#endif
