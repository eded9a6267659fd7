// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 d5641ace63891f79bb01e7fe4125fe702c731ea1c4f0a62ff733ab07808b67ff
#pragma once

#include <string_view>

namespace skybark::opengl {

inline constexpr std::string_view peel_frag{R"glsl(#version 450
#define SKYBARK_OPENGL
layout(location = 0) flat in uvec2 skybark_triangle;
layout(location = 0) out uvec2 skybark_fragment;
layout(std430, binding = 8) readonly buffer depths_buffer { float depths[]; };
void main() {
uvec2 pixel = uvec2(gl_FragCoord.xy);
float depth = gl_FragCoord.z;
if (!(depth > 0.0 && depth < depths[pixel.y * skybark_triangle.y + pixel.x])) {
discard;
}
skybark_fragment = uvec2(skybark_triangle.x, floatBitsToUint(depth));
}
)glsl", 462};

} // namespace skybark::opengl
