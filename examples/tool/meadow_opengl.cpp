#include "meadow_command.hpp"
#include "open_opengl.hpp"

namespace skybark::tool {

result<void> make_meadow_on_opengl(meadow_job& job) {
    auto opened = open_opengl(job.common);
    if (!opened) {
        return failure(opened.error());
    }
    opengl::device& device = opened->device();
    return make_meadow(device, job, split_name(device.device_name()).version);
}

} // namespace skybark::tool
