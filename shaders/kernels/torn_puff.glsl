// Device side of skybark::kernels::torn_puff.
#define KERNEL_VARYINGS 4
#define KERNEL_PARAMETERS float torn; float grain; float shade;
#include "../skeletons/parameters.glsl"
#include "../shared/shading.glsl"
#include "../shared/cloud_lighting.glsl"
#include "../shared/puff.glsl"
#include "scene.glsl.inc"
layout(std430, binding = 0) readonly buffer particles_buffer { vec4 particles[]; };
layout(std430, binding = 1) readonly buffer order_buffer { uint order[]; };
layout(std430, binding = 2) readonly buffer rest_buffer { vec4 rest[]; };
layout(std430, binding = 3) readonly buffer lights_buffer { puff_radiance lights[]; };
layout(std430, binding = 4) readonly buffer scene_buffer { scene_record scene; };
layout(std430, binding = 5) readonly buffer lighting_buffer { cloud_lighting lighting; };

#ifdef SKYBARK_VERTEX_STAGE
const float near_sides = 1.3;

vec4 kernel_vertex(uint index) {
    uint number = order[index / 6u];
    uint which = puff_corner_of(index);
    float x = (which & 1u) != 0u ? 1.0 : -1.0;
    float y = (which & 2u) != 0u ? 1.0 : -1.0;
    vec4 ball = particles[2u * number];
    vec4 water = particles[2u * number + 1u];
    vec3 c = ball.xyz - scene.camera.xyz;
    float radius = ball.w;
    float away2 = dot(c, c);
    varying_out[0] = vec4(0.0);
    varying_out[1] = vec4(0.0);
    varying_out[2] = vec4(0.0);
    varying_out[3] = vec4(0.0);
    vec3 calm = rest[2u * number].xyz;
    if (!puff_drawn(water.x, radius, water.y, away2) || !puff_finite(dot(calm, calm)) ||
        !(away2 > near_sides * radius * radius)) {
        return vec4(0.0, 0.0, 2.0, 1.0);
    }
    float away = sqrt(away2);
    puff_corner corner = puff_silhouette(c, radius, x, y);
    float u = x * corner.over;
    float v = y * corner.over;
    puff_radiance light = lights[number];
    float hidden = air_between(lighting.air, away);
    vec3 own = light.middle.xyz + light.right.xyz * u + light.up.xyz * v;
    scaled_scattering scaled = scattering_without(bounded(water.y, 1.0), lighting.forward);
    varying_out[0] = vec4(u, v, water.x * scaled.depth, 0.0);
    varying_out[1] = vec4(own * (1.0 - hidden), 0.0);
    varying_out[2] = vec4(light.air.xyz * hidden, 0.0);
    varying_out[3] = vec4(calm + corner.offset, radius);
    return scene.to_clip * vec4(ball.xyz + corner.offset, 1.0);
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
const float least_alpha = 1.0 / 512.0;

bool kernel_fragment(vec2 pixel, bool front) {
    float rho2 = varying_in[0].x * varying_in[0].x + varying_in[0].y * varying_in[0].y;
    if (rho2 >= 1.0) {
        return false;
    }
    float sigmas = lighting.sigmas;
    float body = exp_minus(0.5 * sigmas * sigmas * rho2);
    float light = 1.0;
    if (torn > 0.0) {
        float noise = puff_noise(varying_in[3].xyz, grain);
        body = puff_torn(body, noise, torn);
        light = 1.0 + shade * (0.5 - noise);
    }
    float alpha = one_minus_exp(varying_in[0].z * body);
    if (alpha < least_alpha) {
        return false;
    }
    vec3 color = max(varying_in[1].xyz, vec3(0.0)) * light + varying_in[2].xyz;
    color_out = vec4(color * alpha, alpha);
    return true;
}
#endif
