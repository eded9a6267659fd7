#version 450
// Triangles may have holes.
#include "bundle_look.glsl"
#include "../shared/alpha_map.glsl"
layout(std430, binding = 7) readonly buffer alpha_buffer { uint words[]; };

float alpha_value(uint word) { return uintBitsToFloat(words[word]); }

bool is_hole(uint number, float u, float v) {
    if (number == 0u) {
        return false;
    }
    uint at = 12u * (number - 1u);
    uint size = words[at + 7u];
    float s = alpha_place(alpha_value(at), alpha_value(at + 2u), alpha_value(at + 4u), u, v);
    float t = alpha_place(alpha_value(at + 1u), alpha_value(at + 3u), alpha_value(at + 5u), u, v);
    uint column = alpha_texel(s, size & 0xffffu);
    uint row = alpha_texel(t, size >> 16);
    return alpha_value(words[at + 6u] + row * (size & 0xffffu) + column) < alpha_value(at + 8u);
}
