#pragma once
// The CPU backend's one device.

#include "options.hpp"

#include <skybark/cpu/cpu.hpp>

namespace skybark::tool {

[[nodiscard]] inline std::string cpu_driver() {
#if defined(__clang__)
    return "skybark " SKYBARK_VERSION ", clang " __clang_version__;
#else
    return "skybark " SKYBARK_VERSION ", g++ " __VERSION__;
#endif
}

[[nodiscard]] inline result<cpu::device> open_cpu(const common_options& options) {
    if (options.device != 0) {
        return fail(error_code::unavailable, "There is no device " +
                                                 std::to_string(options.device) +
                                                 " of the backend cpu; expected 0, its only one.");
    }
    return cpu::device();
}

} // namespace skybark::tool
