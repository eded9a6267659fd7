#pragma once
// What the viewer is asked for.

#include "screen.hpp"
#include "script.hpp"

#include <tool/meadow_options.hpp>

#include <optional>

namespace skybark::viewer {

struct options {
    tool::backend_kind backend = tool::backend_kind::opengl;
    screen_options screen;
    bool checked = false; ///< the driver's own checks are on
    tool::meadow_options scene;
    std::optional<std::vector<step>> script;
};

/// The options, or what the process is to return: after --help, or after saying what is wrong.
struct asked {
    std::optional<viewer::options> options;
    int exit_code = 0;
};
[[nodiscard]] asked read_options(int count, char** words);

/// Says it on stderr.
void complain(std::string_view sentence);

} // namespace skybark::viewer
