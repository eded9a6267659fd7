#include "cloud_command.hpp"
#include "open_opengl.hpp"

namespace skybark::tool {

result<void> make_cloud_on_opengl(cloud_job& job) {
    auto opened = open_opengl(job.common);
    if (!opened) {
        return failure(opened.error());
    }
    opengl::device& device = opened->device();
    return make_cloud(device, job, split_name(device.device_name()).version);
}

} // namespace skybark::tool
