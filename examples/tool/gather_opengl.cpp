#include "gather_command.hpp"
#include "open_opengl.hpp"

namespace skybark::tool {

result<void> gather_on_opengl(gather_job& job) {
    auto opened = open_opengl(job.common);
    if (!opened) {
        return failure(opened.error());
    }
    opengl::device& device = opened->device();
    return gather_light(device, job, split_name(device.device_name()).version);
}

} // namespace skybark::tool
