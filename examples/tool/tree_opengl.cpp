#include "open_opengl.hpp"
#include "tree_command.hpp"

// What the picture is drawn with.
#include <skybark/opengl/programs/cast_shadow.hpp>
#include <skybark/opengl/programs/clear_sky.hpp>
#include <skybark/opengl/programs/develop.hpp>
#include <skybark/opengl/programs/lit_branch.hpp>
#include <skybark/opengl/programs/meadow_ground.hpp>

namespace skybark::tool {

result<void> make_tree_on_opengl(tree_job& job) {
    auto opened = open_opengl(job.common);
    if (!opened) {
        return failure(opened.error());
    }
    opengl::device& device = opened->device();
    return make_tree(device, job, split_name(device.device_name()).version);
}

} // namespace skybark::tool
