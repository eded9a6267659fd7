#include "conformance_backends.hpp"
#include "open_vulkan.hpp"

#include <skybark/conformance/suite.hpp>

namespace skybark::tool {

result<void> register_vulkan(const common_options& options) {
    if (auto opened = open_vulkan(options); !opened) {
        return failure(opened.error());
    }
    conformance::register_suite<vulkan::device>(
        "vulkan", [options]() -> result<std::shared_ptr<vulkan::device>> {
            auto opened = open_vulkan(options);
            if (!opened) {
                return failure(opened.error());
            }
            // The pointer to the device keeps all that the device stands on.
            auto kept = std::make_shared<vulkan::headless>(std::move(*opened));
            return std::shared_ptr<vulkan::device>(kept, &kept->device());
        });
    return {};
}

} // namespace skybark::tool
