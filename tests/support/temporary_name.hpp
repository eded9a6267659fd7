#pragma once
// Names of files that tests write: no two tests that run at the same time have the same.

#include <filesystem>
#include <string>
#include <unistd.h>

namespace skybark::support {

/// In the folder for temporary files, and of this process alone. Who writes it removes it.
inline std::filesystem::path temporary_name(const std::string& name) {
    return std::filesystem::temp_directory_path() /
           std::string("skybark_").append(std::to_string(getpid())).append("_").append(name);
}

} // namespace skybark::support
