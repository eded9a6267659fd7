#pragma once
// Everything that a program can include, in one translation unit.

#include <skybark/cpu/cpu.hpp>
#include <skybark/opengl/headless.hpp>
#include <skybark/opengl/opengl.hpp>
#include <skybark/skybark.hpp>
#include <skybark/vulkan/headless.hpp>
#include <skybark/vulkan/vulkan.hpp>

/// Sizes as a translation unit sees them.
struct sizes {
    std::size_t error = sizeof(skybark::error);
    std::size_t result = sizeof(skybark::result<int>);
    std::size_t skeleton = sizeof(skybark::trees::skeleton);
    std::size_t cpu = sizeof(skybark::cpu::device);
    std::size_t opengl = sizeof(skybark::opengl::device);
    std::size_t vulkan = sizeof(skybark::vulkan::device);
    std::size_t cpu_mesh = sizeof(skybark::trees::branch_mesh<skybark::cpu::device>);
    std::size_t opengl_mesh = sizeof(skybark::trees::branch_mesh<skybark::opengl::device>);
    std::size_t vulkan_mesh = sizeof(skybark::trees::branch_mesh<skybark::vulkan::device>);
    bool operator==(const sizes&) const = default;
};
sizes sizes_in_second();
