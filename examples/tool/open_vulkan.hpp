#pragma once
// The Vulkan backend's devices: as the loader lists them.

#include "options.hpp"

#include <skybark/vulkan/headless.hpp>
#include <skybark/vulkan/vulkan.hpp>

namespace skybark::tool {

[[nodiscard]] inline result<vulkan::headless> open_vulkan(const common_options& options) {
    vulkan::headless_options wanted;
    wanted.device = options.device;
    return vulkan::headless::create(std::move(wanted));
}

} // namespace skybark::tool
