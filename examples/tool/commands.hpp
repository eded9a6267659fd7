#pragma once
// The commands. Each adds itself to the command line; `run` is called when it was chosen.

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace skybark::tool {

struct command {
    std::string name;
    std::function<int()> run; ///< returns an exit_code
};

[[nodiscard]] command add_tree_command(CLI::App& to);
[[nodiscard]] command add_cloud_command(CLI::App& to);
[[nodiscard]] command add_gather_command(CLI::App& to);
[[nodiscard]] command add_meadow_command(CLI::App& to);
[[nodiscard]] command add_devices_command(CLI::App& to);
[[nodiscard]] command add_conformance_command(CLI::App& to);

} // namespace skybark::tool
