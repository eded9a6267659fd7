#pragma once
// Runs cases of the suite inside a test, and keeps their failures apart from the test's own.

#include <skybark/conformance/suite.hpp>

#include <map>

namespace skybark::conformance {

/// What the failed ones of these cases said, by PATTERN.CASE. `device()` gives the device for the
/// next case; `wanted(name)` chooses cases.
template <backend B, class Device, class Wanted>
[[nodiscard]] std::map<std::string, std::string> failed_cases(Device&& device, Wanted&& wanted) {
    std::map<std::string, std::string> failed;
    for (const suite_case<B>& c : all_cases<B>()) {
        const std::string name = c.pattern + "." + c.name;
        if (!wanted(name)) {
            continue;
        }
        testing::TestPartResultArray parts;
        {
            const testing::ScopedFakeTestPartResultReporter catching(
                testing::ScopedFakeTestPartResultReporter::INTERCEPT_ALL_THREADS, &parts);
            try {
                context<B> on(device(), "in_process", name, 1);
                c.body(on);
            } catch (const case_stopped&) {
                if (parts.size() == 0) {
                    ADD_FAILURE() << "The case stopped without saying why.";
                }
            }
        }
        for (int i = 0; i < parts.size(); ++i) {
            failed[name] += std::string(parts.GetTestPartResult(i).message()) + "\n";
        }
    }
    current_session().pending.clear();
    return failed;
}

} // namespace skybark::conformance
