// Device side of skybark::kernels::lit_puff.
#define KERNEL_VARYINGS 4
#define KERNEL_VOLUMES 3
#include "../skeletons/parameters.glsl"
#include "../shared/shading.glsl"
#include "../shared/cloud_lighting.glsl"
#include "../shared/puff.glsl"
#include "scene.glsl.inc"
layout(std430, binding = 0) readonly buffer particles_buffer { vec4 particles[]; };
layout(std430, binding = 1) readonly buffer order_buffer { uint order[]; };
layout(std430, binding = 2) readonly buffer light_buffer { float light[]; };
layout(std430, binding = 3) readonly buffer scene_buffer { scene_record scene; };
layout(std430, binding = 4) readonly buffer lighting_buffer { cloud_lighting lighting; };
#include "cloud_scene.glsl.inc"

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
    float away = sqrt(away2);
    vec3 air = vec3(0.0);
    if (lighting.air > 0.0 && away > 0.0) {
        air = sky_radiance(scene.sky, c * (1.0 / away));
    }
    varying_out[1] = vec4(c, radius);
    scaled_scattering scaled = scattering_without(bounded(water.y, 1.0), lighting.forward);
    varying_out[2] = vec4(air, 0.0);
    varying_out[3] = vec4(lighting.by_particle != 0u ? light[number] : -1.0, scaled.single,
                          scaled.diffuse, 0.0);
    varying_out[0] = vec4(0.0, 0.0, 0.0, water.x * scaled.depth);
    if (!puff_drawn(water.x, radius, water.y, away2)) {
        return vec4(0.0, 0.0, 2.0, 1.0);
    }
    if (away2 < near_sides * radius * radius) {
        vec4 screen = vec4(x, y, 0.0, 1.0);
        vec4 at = scene.from_clip * screen;
        varying_out[0].xyz = at.xyz * (1.0 / at.w) - ball.xyz;
        return screen;
    }
    vec3 offset = puff_silhouette(c, radius, x, y).offset;
    varying_out[0].xyz = offset;
    return scene.to_clip * vec4(ball.xyz + offset, 1.0);
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
const float least_alpha = 1.0 / 4096.0;

bool kernel_fragment(vec2 pixel, bool front) {
    vec3 offset = varying_in[0].xyz;
    float radius = varying_in[1].w;
    vec3 along = varying_in[1].xyz + offset;
    float reach = sqrt(dot(along, along));
    vec3 direction = along * (1.0 / reach);
    float past = dot(offset, direction);
    float rho2 = dot(offset, offset) - past * past;
    float ahead = reach - past;
    float depth = puff_depth(varying_in[0].w, rho2, ahead, radius, lighting.sigmas);
    if (lighting.torn > 0.0 && depth > least_alpha) {
        float noise = puff_noise(scene.camera.xyz + along, lighting.grain);
        depth = varying_in[0].w * puff_torn(depth / varying_in[0].w, noise, lighting.torn);
    }
    float alpha = one_minus_exp(depth);
    if (alpha < least_alpha) {
        return false;
    }
    float at = ahead;
    if (lighting.forward_point != 0u) {
        at = max(at - puff_front(depth) * radius / lighting.sigmas, 0.0);
    }
    vec3 place = scene.camera.xyz + direction * at;
    vec3 source =
        cloud_source(place, direction, varying_in[3].x, varying_in[3].y, varying_in[3].z) *
        (lighting.paper_form != 0u ? depth : alpha);
    float hidden = air_between(lighting.air, at);
    color_out = behind_air(source, alpha, hidden, varying_in[2].xyz);
    return true;
}
#endif
