#pragma once
// What the jobs of all commands have: what was asked for on the command line, how long it took, and
// what the report says of it.

#include "options.hpp"
#include "stages.hpp"

#include <skybark/core/backend.hpp>

#include <initializer_list>
#include <nlohmann/json_fwd.hpp>

namespace skybark::tool {

struct command_job {
    command_job(std::vector<std::string> stage_names, bool quiet)
        : time(std::move(stage_names), quiet) {}

    common_options common;
    std::string input;
    std::string out;
    stages time;

    // For the report.
    std::string device;
    std::string driver;
    device_traffic traffic;
};

/// That no two of `files` are the same; empty names are none. `names` are their options.
[[nodiscard]] result<void> check_apart(std::initializer_list<std::string_view> files,
                                       std::string_view names);
/// What can be known to fail is told before the work is done. Empty names are none.
[[nodiscard]] result<void> check_writable(std::initializer_list<std::string_view> files);

/// Does the job on the backend that it asks for. Each is in a file of its own, so that none needs
/// another's headers.
template <class Job>
[[nodiscard]] result<void> on_backend(Job& job, result<void> (*cpu)(Job&),
                                      result<void> (*opengl)(Job&), result<void> (*vulkan)(Job&)) {
    switch (job.common.backend) {
    case backend_kind::opengl:
        return opengl(job);
    case backend_kind::vulkan:
        return vulkan(job);
    default:
        return cpu(job);
    }
}

/// The report of --stats begins with what ran, and on what. A command adds its own; the end is
/// added by write_report: seconds by stage, and bytes that crossed.
[[nodiscard]] nlohmann::ordered_json begin_report(std::string_view command, const command_job& of);
[[nodiscard]] result<void> write_report(const command_job& of, nlohmann::ordered_json report);

} // namespace skybark::tool
