#pragma once
// What the meadow command is asked for, and what it finds on the way.

#include "job.hpp"
#include "meadow_options.hpp"

#include <meadow/meadow.hpp>

namespace skybark::tool {

struct meadow_job : command_job {
    explicit meadow_job(bool quiet)
        : command_job({"grow", "settle", "sway", "mesh", "clouds", "light", "draw", "write"},
                      quiet) {}

    meadow_options options;

    // Filled by `make_meadow`, for the report.
    meadow::contents holds;
    std::uint64_t triangles = 0; ///< of the last frame
};

// One a backend, each in its own file, so that none needs another's headers.
[[nodiscard]] result<void> make_meadow_on_cpu(meadow_job& job);
[[nodiscard]] result<void> make_meadow_on_opengl(meadow_job& job);
[[nodiscard]] result<void> make_meadow_on_vulkan(meadow_job& job);

} // namespace skybark::tool
