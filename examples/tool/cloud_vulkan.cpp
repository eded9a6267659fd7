#include "cloud_command.hpp"
#include "open_vulkan.hpp"

namespace skybark::tool {

result<void> make_cloud_on_vulkan(cloud_job& job) {
    auto opened = open_vulkan(job.common);
    if (!opened) {
        return failure(opened.error());
    }
    return make_cloud(opened->device(), job, driver_of(job.common.device));
}

} // namespace skybark::tool
