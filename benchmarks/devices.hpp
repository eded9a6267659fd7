#pragma once
// One device of each backend for all benchmarks of a run.

#include <skybark/cpu/cpu.hpp>
#include <skybark/opengl/headless.hpp>
#include <skybark/opengl/opengl.hpp>
#include <skybark/vulkan/headless.hpp>
#include <skybark/vulkan/vulkan.hpp>

#include <string>

namespace skybark::benchmarks {

/// A backend's device, or why there is none.
template <class B>
struct device_of;

template <>
struct device_of<cpu::device> {
    static result<cpu::device*> get() {
        static cpu::device device;
        return &device;
    }
};

template <>
struct device_of<opengl::device> {
    static result<opengl::device*> get() {
        static result<opengl::headless> made = opengl::headless::create();
        if (!made) {
            return failure(made.error());
        }
        if (!made->make_current()) {
            return fail(error_code::unavailable, "The OpenGL context could not be made current.");
        }
        return &made->device();
    }
};

template <>
struct device_of<vulkan::device> {
    static result<vulkan::device*> get() {
        static result<vulkan::headless> made = vulkan::headless::create({});
        if (!made) {
            return failure(made.error());
        }
        return &made->device();
    }
};

} // namespace skybark::benchmarks
