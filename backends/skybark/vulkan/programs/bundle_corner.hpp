// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 dcc194e8f0b7f6683e560667a48dc43a36b28c33b71f85300776cb7773390e4c
#pragma once

#include <skybark/kernels/bundle_corner.hpp>
#include <skybark/vulkan/program.hpp>

namespace skybark::vulkan {

template <>
struct program<kernels::bundle_corner> {
};

} // namespace skybark::vulkan
