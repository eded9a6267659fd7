#include "device_list.hpp"
#include "open_opengl.hpp"

namespace skybark::tool {

backend_info list_opengl() {
    backend_info backend{"opengl", "", {}};
    std::string reasons;
    for (std::uint32_t i = 0; i < std::size(opengl_kinds); ++i) {
        common_options options;
        options.device = i;
        options.any_device = false;
        auto opened = open_opengl(options);
        if (!opened) {
            reasons += (reasons.empty() ? "" : " ") + opened.error().message;
            continue;
        }
        const auto names = split_name(opened->device().device_name());
        const char* const window = i == 0 ? " (EGL)" : " (OSMesa)";
        backend.devices.push_back(
            {i, names.renderer + window, names.version, "OpenGL 4.5", opened->device().limits()});
        opened->release();
    }
    if (backend.devices.empty()) {
        backend.unavailable = reasons;
    }
    return backend;
}

} // namespace skybark::tool
