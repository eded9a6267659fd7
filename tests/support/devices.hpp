#pragma once
// Devices of the three backends for a test, and what to do where there is none.

#include <skybark/conformance/suite.hpp>
#include <skybark/cpu/cpu.hpp>
#include <skybark/opengl/headless.hpp>
#include <skybark/opengl/opengl.hpp>
#include <skybark/vulkan/headless.hpp>
#include <skybark/vulkan/vulkan.hpp>

#include <gtest/gtest.h>
#include <memory>

namespace skybark::support {

/// A device for a test, or why there is none.
template <class Headless, class Options>
[[nodiscard]] inline std::unique_ptr<Headless> open(const char* name, Options options,
                                                    std::string& why) {
    auto made = Headless::create(std::move(options));
    if (!made) {
        why = std::string(name) + ": " + made.error().message;
        return nullptr;
    }
    return std::make_unique<Headless>(std::move(*made));
}
[[nodiscard]] inline std::unique_ptr<opengl::headless> open_opengl(std::string& why) {
    opengl::headless_options options;
    options.kind = opengl::headless_kind::egl;
    return open<opengl::headless>("opengl", options, why);
}
[[nodiscard]] inline std::unique_ptr<vulkan::headless> open_vulkan(std::string& why) {
    return open<vulkan::headless>("vulkan", vulkan::headless_options{}, why);
}

/// Calls `test(device)` with a device of the backend `name`: cpu, opengl or vulkan. Ends the test
/// with a skip where there is none, or a failure where the environment asks for it.
template <class Test>
void with_device(const std::string& name, Test&& test) {
    std::string why;
    if (name == "cpu") {
        cpu::device device;
        return test(device);
    }
    if (name == "opengl") {
        if (const auto device = open_opengl(why)) {
            return test(device->device());
        }
    } else if (const auto device = open_vulkan(why)) {
        return test(device->device());
    }
    if (conformance::is_required(name)) {
        FAIL() << why;
    }
    GTEST_SKIP() << why;
}

} // namespace skybark::support

/// Ends the test: a visible skip, or a failure where the environment asks for the backend.
#define SKYBARK_SKIP_WITHOUT(device, name, why)                                                    \
    if (!(device)) {                                                                               \
        if (skybark::conformance::is_required(name)) {                                             \
            FAIL() << (why);                                                                       \
        }                                                                                          \
        GTEST_SKIP() << (why);                                                                     \
    }
