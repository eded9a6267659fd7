// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 39fddd1a0e356689673ac5d0b5835981ec31f4898b64f249ffd301be011b9e7d
#pragma once

#include <cstdint>
#include <string_view>

namespace skybark::opengl {

inline constexpr std::string_view tile_frag = R"glsl(#version 450
#define SKYBARK_OPENGL
layout(location = 0) uniform ivec4 corner; // x, y: where the tile begins
layout(binding = 5, rg32f) readonly uniform image2D tiles;
layout(location = 0) out vec2 sum;
void main() { sum = imageLoad(tiles, ivec2(gl_FragCoord.xy) + corner.xy).xy; }
)glsl";

} // namespace skybark::opengl
