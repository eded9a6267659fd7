#include "device_list.hpp"
#include "open_vulkan.hpp"

namespace skybark::tool {

backend_info list_vulkan() {
    backend_info backend{"vulkan", "", {}};
    const auto devices = vulkan::headless::devices();
    if (!devices) {
        backend.unavailable = devices.error().message;
        return backend;
    }
    std::string reasons;
    for (std::uint32_t i = 0; i < devices->size(); ++i) {
        common_options options;
        options.device = i;
        auto opened = open_vulkan(options);
        if (!opened) {
            reasons += (reasons.empty() ? "" : " ") + opened.error().message;
            continue;
        }
        const vulkan::physical_device& device = (*devices)[i];
        backend.devices.push_back({i, device.name, device.driver, "Vulkan " + device.api_version,
                                   opened->device().limits()});
    }
    if (backend.devices.empty()) {
        backend.unavailable =
            reasons.empty() ? "The Vulkan loader finds no device on this machine." : reasons;
    }
    return backend;
}

} // namespace skybark::tool
