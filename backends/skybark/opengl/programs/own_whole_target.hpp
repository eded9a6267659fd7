// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 00d008d7a6d91b40122f0ede59abfa38fd3acf10cea8ce6facf520670860a529
#pragma once

#include <string_view>

namespace skybark::opengl {

inline constexpr std::string_view whole_target_vert{R"glsl(#version 450
#define SKYBARK_OPENGL
void main() {
gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
)glsl", 144};

} // namespace skybark::opengl
