#pragma once
// How the tests make each of our devices.

#include <skybark/conformance/suite.hpp>
#include <skybark/cpu/cpu.hpp>
#include <skybark/opengl/headless.hpp>
#include <skybark/opengl/opengl.hpp>
#include <skybark/vulkan/headless.hpp>
#include <skybark/vulkan/vulkan.hpp>

namespace skybark::conformance {

[[nodiscard]] inline result<std::shared_ptr<cpu::device>> make_cpu(cpu::device_options options) {
    return std::make_shared<cpu::device>(std::move(options));
}

/// A device that keeps alive the headless object that it belongs to.
template <class Headless, class Options>
[[nodiscard]] auto make_headless(Options options) -> result<
    std::shared_ptr<std::remove_reference_t<decltype(std::declval<Headless&>().device())>>> {
    auto made = Headless::create(std::move(options));
    if (!made) {
        return failure(made.error());
    }
    const auto owner = std::make_shared<Headless>(std::move(*made));
    return std::shared_ptr<std::remove_reference_t<decltype(owner->device())>>(owner,
                                                                               &owner->device());
}

} // namespace skybark::conformance
