// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 308fc49f937272f085e5d70deca812787d6497f1d93ce556cf9e66b4ca2435ae
#pragma once

#include <string_view>

namespace skybark::opengl {

inline constexpr std::string_view carry_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
layout(local_size_x = 64) in;
layout(std140, binding = 0) uniform skybark_block { uvec4 skybark_header; };
layout(binding = 5, rg32f) uniform image2D tiles;
layout(binding = 6, rg32f) uniform image3D layers;
vec4 carried(vec4 sum) {
int low = int(sum.y);
int carry = (low + 128) >> 8;
return vec4(sum.x + float(carry), float(low - 256 * carry), 0.0, 0.0);
}
void main() {
ivec3 at = ivec3(gl_GlobalInvocationID);
if (at.x >= int(skybark_header.y)) {
return;
}
if (skybark_header.x == 1u) {
imageStore(layers, at, carried(imageLoad(layers, at)));
} else {
imageStore(tiles, at.xy, carried(imageLoad(tiles, at.xy)));
}
}
)glsl", 655};

} // namespace skybark::opengl
