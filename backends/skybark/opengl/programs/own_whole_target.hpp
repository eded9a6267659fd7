// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 175e4055d85b3e201f92d950b21dbcaf2b5576675adac7cc32ddc38538d1cf8e
#pragma once

#include <cstdint>
#include <string_view>

namespace skybark::opengl {

inline constexpr std::string_view whole_target_vert = R"glsl(#version 450
#define SKYBARK_OPENGL
void main() {
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
)glsl";

} // namespace skybark::opengl
