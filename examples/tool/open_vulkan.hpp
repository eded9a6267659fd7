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

/// What is known of the device that was opened.
[[nodiscard]] inline std::string driver_of(std::uint32_t index) {
    const auto devices = vulkan::headless::devices();
    if (!devices || index >= devices->size()) {
        return "unknown";
    }
    const vulkan::physical_device& device = (*devices)[index];
    return device.driver + ", Vulkan " + device.api_version;
}

} // namespace skybark::tool
