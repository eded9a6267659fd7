// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 ec404b37d35ee372cb546bdfbf43fd87d04de5c51567e3bce486b81796edb06f
#pragma once

#include <string_view>

namespace skybark::opengl {

inline constexpr std::string_view arguments_comp{R"glsl(#version 450
#define SKYBARK_OPENGL
layout(local_size_x = 1) in;
layout(std140, binding = 0) uniform skybark_block {
uvec4 skybark_header;
uvec4 skybark_geometry;
};
layout(std430, binding = 9) writeonly buffer arguments_buffer { uint arguments[]; };
layout(std430, binding = 10) readonly buffer length_buffer { uint length[]; };
void main() {
uint count = length[0] > skybark_header.y ? length[0] - skybark_header.y : 0u;
count = min(count, skybark_header.z);
if (skybark_header.x == 0u) {
uint invocations = count * skybark_header.w;
uint groups = invocations / 64u + (invocations % 64u != 0u ? 1u : 0u);
uint columns = clamp(groups, 1u, 65535u);
arguments[0] = columns;
arguments[1] = groups / columns + (groups % columns != 0u ? 1u : 0u);
arguments[2] = 1u;
return;
}
arguments[0] = count * skybark_header.w;
arguments[1] = 1u;
arguments[2] = skybark_geometry.x;
arguments[3] = skybark_header.x == 1u ? 0u : skybark_geometry.y;
arguments[4] = 0u;
}
)glsl", 953};

} // namespace skybark::opengl
