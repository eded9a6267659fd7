#include "open_vulkan.hpp"
#include "tree_command.hpp"

// What the picture is drawn with.
#include <skybark/vulkan/programs/cast_shadow.hpp>
#include <skybark/vulkan/programs/clear_sky.hpp>
#include <skybark/vulkan/programs/develop.hpp>
#include <skybark/vulkan/programs/lit_branch.hpp>
#include <skybark/vulkan/programs/meadow_ground.hpp>

namespace skybark::tool {

result<void> make_tree_on_vulkan(tree_job& job) {
    auto opened = open_vulkan(job.common);
    if (!opened) {
        return failure(opened.error());
    }
    return make_tree(opened->device(), job, driver_of(job.common.device));
}

} // namespace skybark::tool
