// A caller's own shader: asks the volumes that Skybark made for light at places. Vulkan's compiler
// finds the texts; for OpenGL, which knows no #include, a test puts the strings in.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "skybark/glsl/cloud_scattering.glsl"
#include "skybark/glsl/cloud_shadow.glsl"
#include "skybark/glsl/irradiance_volume.glsl"
#include "skybark/glsl/phase.glsl"

layout(local_size_x = 64) in;
layout(std140, binding = 0) uniform lights_block {
    light_grid sun_grid;
    light_grid fluence_grid;
    irradiance_grid gathered_grid;
    vec4 phase;
    vec4 medium; // x: albedo, y: forward part
};
layout(binding = 1) uniform sampler3D attenuation;
layout(binding = 2) uniform sampler3D fluence;
layout(binding = 3) uniform sampler3D gathered;
struct place_record {
    vec4 place;
    vec4 normal; // w: cosine of the angle between sunlight and the way to the eye
};
struct found_record {
    vec4 cloud; // the sun's light, fluence, what is scattered, the phase function
    vec4 irradiance;
};
layout(std430, binding = 4) readonly buffer places_buffer { place_record places[]; };
layout(std430, binding = 5) writeonly buffer found_buffer { found_record found[]; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= uint(places.length())) {
        return;
    }
    vec3 place = places[i].place.xyz;
    vec4 normal = places[i].normal;
    float sun = cloud_sunlight(attenuation, sun_grid, place);
    float diffuse = cloud_fluence(fluence, fluence_grid, place);
    found[i].cloud =
        vec4(sun, diffuse, cloud_scattered(sun, diffuse, medium.x, medium.y, phase, normal.w),
             phase_value(phase_widened(phase, 1.0), normal.w));
    found[i].irradiance = vec4(irradiance_at(gathered, gathered_grid, place, normal.xyz), 0.0);
}
