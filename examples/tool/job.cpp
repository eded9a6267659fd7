#include "job.hpp"

#include <filesystem>
#include <io/atomic_file.hpp>
#include <nlohmann/json.hpp>

namespace skybark::tool {

namespace {

bool same_file(std::string_view a, std::string_view b) {
    std::error_code error;
    return !a.empty() && !b.empty() && (a == b || std::filesystem::equivalent(a, b, error));
}

} // namespace

result<void> check_apart(std::initializer_list<std::string_view> files, std::string_view names) {
    for (auto a = files.begin(); a != files.end(); ++a) {
        for (auto b = files.begin(); b != a; ++b) {
            if (same_file(*a, *b)) {
                return contradiction("Two of " + std::string(names) +
                                     " are the same file; expected each its own.");
            }
        }
    }
    return {};
}

result<void> check_writable(std::initializer_list<std::string_view> files) {
    for (const std::string_view name : files) {
        if (name.empty()) {
            continue;
        }
        if (auto good = io::check_writable(std::string(name)); !good) {
            return good;
        }
    }
    return {};
}

nlohmann::ordered_json begin_report(std::string_view command, const command_job& of) {
    nlohmann::ordered_json report;
    report["command"] = command;
    report["version"] = SKYBARK_VERSION;
    if (!of.input.empty()) {
        report["input"] = of.input;
    }
    report["output"] = of.out;
    report["backend"] = name_of(of.common.backend);
    report["device"] = of.device;
    report["driver"] = of.driver;
    return report;
}

result<void> write_report(const command_job& of, nlohmann::ordered_json report) {
    if (of.common.stats.empty()) {
        return {};
    }
    for (const auto& [name, seconds] : of.time.seconds()) {
        report["seconds"][name] = seconds;
    }
    report["seconds"]["total"] = of.time.total();
    report["bytes"] = {{"up", of.traffic.up}, {"down", of.traffic.down}};
    // What isn't UTF-8 in a file's name is replaced, where the default would throw.
    const auto replace = nlohmann::ordered_json::error_handler_t::replace;
    return io::write_file(of.common.stats, report.dump(2, ' ', false, replace) + "\n");
}

} // namespace skybark::tool
