// What surrounds the things of a scene, and light from near and far on them: the sun behind clouds
// and what light has been gathered.
#include "records.glsl"
#include "shading.glsl"
#include "cloud_shadow.glsl"
#include "country.glsl"
#include "irradiance_grid.glsl"

// One a picture, beside the scene.
struct surroundings_record {
    light_grid clouds;        // where the volume of the sun's attenuation by clouds lies
    irradiance_grid gathered; // and the volume of gathered light
    float cloud_shadow;       // how much of the clouds' shadow falls: 0 (none, and the volume is not
                              // looked at) ... 1
    float air;                // 1/m, extinction of the air up to the eye
    float reserved0;
    float reserved1;
};

// The part of the sun's light that clouds of this attenuation leave.
float meadow_cloud_light(surroundings_record around, float attenuation) {
    return mix(1.0f, cloud_light(attenuation), around.cloud_shadow);
}

// Light that an opaque surface of unit normal n scatters. `sun` is 0 in shadow and 1 in full light;
// `irradiance` is what else arrives, gathered.
vec3 meadow_lit(vec3 albedo, vec3 n, daylight_sky sky, float sun, vec3 irradiance) {
    return lit(albedo, n, sky, sun, irradiance * 0.318309886f);
}

// What of it arrives at the eye, `away` (m) from there, and what the air in between adds.
vec3 meadow_through_air(surroundings_record around, daylight_sky sky, vec3 light, vec3 away) {
    float distance = sqrt(away.x * away.x + away.y * away.y + away.z * away.z);
    vec3 air = sky_radiance(sky, away * (1.0f / max(distance, 1e-6f)));
    return mix(light, air, one_minus_exp(around.air * distance));
}

// Albedo of the land at (x, z), `distance` metres from the eye: grass, and fields and woods in the
// distance.
vec3 meadow_albedo(float x, float z, float distance) {
    float t = clamp((distance - 60.0f) * (1.0f / 340.0f), 0.0f, 1.0f);
    float distant = t * t * (3.0f - 2.0f * t);
    if (distant == 0.0f) {
        return grass_albedo(x, z);
    }
    vec3 country = country_albedo(x, z, distance);
    return distant == 1.0f ? country : mix(grass_albedo(x, z), country, distant);
}
