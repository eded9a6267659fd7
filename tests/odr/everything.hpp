#pragma once
// Everything that a program can include, in one translation unit.

#if __has_include(<skybark/skybark.hpp>)
#    include <skybark/skybark.hpp>
#endif
#if __has_include(<skybark/cpu/cpu.hpp>)
#    include <skybark/cpu/cpu.hpp>
#endif
#if __has_include(<skybark/opengl/opengl.hpp>)
#    include <skybark/opengl/opengl.hpp>
#endif
#if __has_include(<skybark/opengl/headless.hpp>)
#    include <skybark/opengl/headless.hpp>
#endif
#if __has_include(<skybark/vulkan/vulkan.hpp>)
#    include <skybark/vulkan/vulkan.hpp>
#endif
#if __has_include(<skybark/vulkan/headless.hpp>)
#    include <skybark/vulkan/headless.hpp>
#endif
#include <skybark/core/result.hpp>
#include <skybark/trees/skeleton.hpp>

/// Sizes as a translation unit sees them.
struct sizes {
    std::size_t error = sizeof(skybark::error);
    std::size_t result = sizeof(skybark::result<int>);
    std::size_t skeleton = sizeof(skybark::trees::skeleton);
    bool operator==(const sizes&) const = default;
};
sizes sizes_in_second();
