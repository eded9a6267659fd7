// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 edb0c948021f7933b1970b636ea8abf26d3d966af96eb57437640968cb394edb
#pragma once

#include <skybark/kernels/bundle_corner.hpp>
#include <skybark/opengl/program.hpp>

namespace skybark::opengl {

template <>
struct program<kernels::bundle_corner> {
};

} // namespace skybark::opengl
