// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 213a845fbad31472f7a8b55bf4180189794ef641b92aad45ecb64a747608baa6
#pragma once

#include <cstdint>
#include <string_view>

namespace skybark::opengl {

inline constexpr std::string_view carry_comp = R"glsl(#version 450
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
)glsl";

} // namespace skybark::opengl
