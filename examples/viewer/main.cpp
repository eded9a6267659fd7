// skybark_viewer: a meadow in a window.

#include "viewer.hpp"

int main(int count, char** words) {
    using namespace skybark;
    const viewer::asked asked = viewer::read_options(count, words);
    if (!asked.options) {
        return asked.exit_code;
    }
    const auto done = asked.options->backend == tool::backend_kind::vulkan
                          ? viewer::view_vulkan(*asked.options)
                          : viewer::view_opengl(*asked.options);
    if (!done) {
        viewer::complain(done.error().message);
        return done.error().code == error_code::unavailable ? tool::exit_unavailable
                                                            : tool::exit_failed;
    }
    return tool::exit_done;
}
