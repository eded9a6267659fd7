// Device side of skybark::kernels::puff_light.
#define KERNEL_VOLUMES 3
#include "../skeletons/parameters.glsl"
#include "../shared/shading.glsl"
#include "../shared/cloud_lighting.glsl"
#include "../shared/puff.glsl"
#include "scene.glsl.inc"
layout(std430, binding = 0) readonly buffer particles_buffer { vec4 particles[]; };
layout(std430, binding = 1) readonly buffer scene_buffer { scene_record scene; };
layout(std430, binding = 2) readonly buffer lighting_buffer { cloud_lighting lighting; };
layout(std430, binding = 3) writeonly buffer lights_buffer { puff_radiance lights[]; };
#include "cloud_scene.glsl.inc"

void kernel_map(uint i) {
    vec4 ball = particles[2u * i];
    vec4 water = particles[2u * i + 1u];
    puff_radiance found;
    found.middle = vec4(0.0);
    found.right = vec4(0.0);
    found.up = vec4(0.0);
    found.air = vec4(0.0);
    vec3 away = ball.xyz - scene.camera.xyz;
    float reach = sqrt(dot(away, away));
    if (water.x > 0.0 && ball.w > 0.0 && reach > 0.0) {
        vec3 ahead = away * (1.0 / reach);
        scaled_scattering scaled = scattering_without(bounded(water.y, 1.0), lighting.forward);
        float front = puff_front(water.x * scaled.depth) * ball.w;
        vec3 place = ball.xyz - ahead * min(front / lighting.sigmas, reach);
        vec3 right = puff_right(ahead) * (0.5 * ball.w);
        vec3 up = cross(puff_right(ahead), ahead) * (0.5 * ball.w);
        vec3 light[5];
        for (int k = 0; k < 5; ++k) {
            vec3 aside = k == 0 ? vec3(0.0) : (k < 3 ? right : up) * (k % 2 == 1 ? 1.0 : -1.0);
            light[k] = cloud_source(place + aside, ahead, -1.0, scaled.single, scaled.diffuse);
        }
        found.middle = vec4(light[0], 0.0);
        found.right = vec4(light[1] - light[2], 0.0);
        found.up = vec4(light[3] - light[4], 0.0);
        if (lighting.air > 0.0) {
            found.air = vec4(sky_radiance(scene.sky, ahead), 0.0);
        }
    }
    lights[i] = found;
}
