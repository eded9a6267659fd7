// Device side of skybark::kernels::seen_surface.
#define KERNEL_VARYINGS 2
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS vec4 to_clip_x; vec4 to_clip_y; vec4 to_clip_z; vec4 to_clip_w;
#include "../skeletons/parameters.glsl"
#include "../shared/alpha_map.glsl"
layout(std430, binding = 0) readonly buffer triangles_buffer { gather_triangle triangles[]; };
layout(std430, binding = 1) readonly buffer alpha_buffer { uint alpha[]; };

#ifdef SKYBARK_VERTEX_STAGE
vec4 kernel_vertex(uint index) {
    uint number = index / 3u;
    uint corner = index % 3u;
    gather_triangle t = triangles[number];
    vec3 place = corner == 0u ? t.a : corner == 1u ? t.b : t.c;
    varying_out[0] = vec4(corner == 1u ? 1.0 : 0.0, corner == 2u ? 1.0 : 0.0,
                          float(number % 2048u), float(number / 2048u));
    varying_out[1] = vec4(float(t.alpha % 2048u), float(t.alpha / 2048u), 0.0, 0.0);
    vec4 p = vec4(place, 1.0);
    return vec4(dot(to_clip_x, p), dot(to_clip_y, p), dot(to_clip_z, p), dot(to_clip_w, p));
}
#endif
#ifdef SKYBARK_FRAGMENT_STAGE
float alpha_value(uint word) { return uintBitsToFloat(alpha[word]); }

bool is_hole(uint number, float u, float v) {
    if (number == 0u) {
        return false;
    }
    uint at = 12u * (number - 1u);
    uint size = alpha[at + 7u];
    float s = alpha_place(alpha_value(at), alpha_value(at + 2u), alpha_value(at + 4u), u, v);
    float t = alpha_place(alpha_value(at + 1u), alpha_value(at + 3u), alpha_value(at + 5u), u, v);
    uint column = alpha_texel(s, size & 0xffffu);
    uint row = alpha_texel(t, size >> 16);
    return alpha_value(alpha[at + 6u] + row * (size & 0xffffu) + column) < alpha_value(at + 8u);
}

bool kernel_fragment(vec2 pixel, bool front) {
    vec4 place = varying_in[0];
    float u = clamp(place.x, 0.0, 1.0);
    float v = clamp(place.y, 0.0, 1.0 - u);
    vec2 holes = floor(varying_in[1].xy + 0.5);
    if (is_hole(2048u * uint(holes.y) + uint(holes.x), u, v)) {
        return false;
    }
    color_out = vec4(u, v, 2.0 * floor(place.z + 0.5) + (front ? 0.0 : 1.0),
                     floor(place.w + 0.5));
    return true;
}
#endif
