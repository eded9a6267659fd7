#include "gather_command.hpp"
#include "open_vulkan.hpp"

namespace skybark::tool {

result<void> gather_on_vulkan(gather_job& job) {
    auto opened = open_vulkan(job.common);
    if (!opened) {
        return failure(opened.error());
    }
    return gather_light(opened->device(), job, driver_of(job.common.device));
}

} // namespace skybark::tool
