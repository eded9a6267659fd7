#include "meadow_command.hpp"
#include "open_vulkan.hpp"

namespace skybark::tool {

result<void> make_meadow_on_vulkan(meadow_job& job) {
    auto opened = open_vulkan(job.common);
    if (!opened) {
        return failure(opened.error());
    }
    return make_meadow(opened->device(), job, driver_of(job.common.device));
}

} // namespace skybark::tool
