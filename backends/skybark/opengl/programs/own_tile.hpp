// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 3503ae6a12928b333ed81f4cbc8b519fdb8c1abc1c0407d13f047499d88f7ebe
#pragma once

#include <string_view>

namespace skybark::opengl {

inline constexpr std::string_view tile_frag{R"glsl(#version 450
#define SKYBARK_OPENGL
layout(location = 0) uniform ivec4 corner;
layout(binding = 5, rg32f) readonly uniform image2D tiles;
layout(location = 0) out vec2 sum;
void main() { sum = imageLoad(tiles, ivec2(gl_FragCoord.xy) + corner.xy).xy; }
)glsl", 252};

} // namespace skybark::opengl
