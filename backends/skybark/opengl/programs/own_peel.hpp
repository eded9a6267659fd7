// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 e408bbde9fd2777926102c89ed72102ea107ec3577e73720e5de72ff3530ca0e
#pragma once

#include <cstdint>
#include <string_view>

namespace skybark::opengl {

inline constexpr std::string_view peel_frag = R"glsl(#version 450
#define SKYBARK_OPENGL
layout(location = 0) flat in uvec2 skybark_triangle; // its number, pixels in a row
layout(location = 0) out uvec2 skybark_fragment;     // the triangle's number, bits of the depth
layout(std430, binding = 8) readonly buffer depths_buffer { float depths[]; };
void main() {
    uvec2 pixel = uvec2(gl_FragCoord.xy);
    float depth = gl_FragCoord.z;
    if (!(depth > 0.0 && depth < depths[pixel.y * skybark_triangle.y + pixel.x])) {
        discard;
    }
    skybark_fragment = uvec2(skybark_triangle.x, floatBitsToUint(depth));
}
)glsl";

} // namespace skybark::opengl
