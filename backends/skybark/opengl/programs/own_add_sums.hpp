// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 d6b942c6b15e733cb8cfc6c08710065deaa8b7fcbbeaa6067e3ab68851f800ac
#pragma once

#include <string_view>

namespace skybark::opengl {

inline constexpr std::string_view add_sums_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
layout(local_size_x = 64) in;
layout(std140, binding = 0) uniform skybark_block { uvec4 skybark_header; };
layout(binding = 4, r32i) uniform iimage3D volume;
layout(binding = 6, rg32f) readonly uniform image3D layers;
void main() {
ivec3 from = ivec3(gl_GlobalInvocationID);
if (from.x >= int(skybark_header.z)) {
return;
}
ivec3 into = from + ivec3(0, 0, skybark_header.y);
ivec2 sum = ivec2(imageLoad(layers, from).xy);
int total = 256 * sum.x + sum.y;
if (skybark_header.x == 0u) {
total += imageLoad(volume, into).x;
}
imageStore(volume, into, ivec4(total));
}
)glsl", 601};

} // namespace skybark::opengl
