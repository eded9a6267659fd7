#pragma once
// The backends and their devices, for `skybark devices`.

#include <skybark/core/backend.hpp>

#include <vector>

namespace skybark::tool {

struct device_info {
    std::uint32_t index = 0; ///< for --device
    std::string name;
    std::string driver;
    std::string api; ///< the version of the backend's interface
    device_limits limits;
};

struct backend_info {
    std::string name;
    std::string unavailable; ///< a sentence that says why there are no devices, or empty
    std::vector<device_info> devices;
};

// One a backend, each in its own file, so that none needs another's headers.
[[nodiscard]] backend_info list_cpu();
[[nodiscard]] backend_info list_opengl();
[[nodiscard]] backend_info list_vulkan();

} // namespace skybark::tool
