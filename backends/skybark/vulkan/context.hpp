#pragma once
// What all parts of a device share: the caller's handles, the function table, the device's
// properties, the bytes that crossed, and whether it is lost. It stays at one address while the
// device itself may move.

#include <skybark/core/backend.hpp>
#include <skybark/vulkan/functions.hpp>

#include <algorithm>
#include <string>

namespace skybark::vulkan {

/// How an expansion is cut among invocations.
enum class expansion {
    automatic,    ///< `per_element` on a CPU, `per_vertices` on a GPU
    per_element,  ///< a long run of one element's vertices an invocation
    per_vertices, ///< a few vertices an invocation, neighbours in memory beside each other
};

/// The caller's device. Nothing in it is owned, and all of it must outlive our device.
///
/// The device must be Vulkan 1.3 with `synchronization2` and `dynamicRendering` enabled, and the
/// queue must do graphics and compute. Volumes of float16 need `shaderStorageImageExtendedFormats`
/// as well; without it, asking for one is an error, and all else works.
struct device_description {
    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    std::uint32_t queue_family = 0;
    PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
    PFN_vkGetDeviceProcAddr get_device_proc_addr = nullptr; ///< may be null
    const VkAllocationCallbacks* allocation_callbacks = nullptr;

    bool synchronization2 = false;  ///< enabled by the caller, as we rely on it
    bool dynamic_rendering = false; ///< the same
    bool debug_utils = false;       ///< VK_EXT_debug_utils is enabled: objects get names
    /// Enabled by the caller. Needed for volumes of float16 alone.
    bool shader_storage_image_extended_formats = false;

    expansion expand_by = expansion::automatic;
    /// Goes through staging buffers even where the host could write to the device's memory.
    bool always_stage = false;
    /// Leaves out the barriers between patterns. Wrong, of course: it is there so that a test can
    /// show that somebody would notice.
    bool omit_barriers = false;
};

[[nodiscard]] inline std::string to_string(VkResult result) {
    switch (result) {
    case VK_SUCCESS:
        return "VK_SUCCESS";
    case VK_NOT_READY:
        return "VK_NOT_READY";
    case VK_TIMEOUT:
        return "VK_TIMEOUT";
    case VK_INCOMPLETE:
        return "VK_INCOMPLETE";
    case VK_ERROR_OUT_OF_HOST_MEMORY:
        return "VK_ERROR_OUT_OF_HOST_MEMORY";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
        return "VK_ERROR_OUT_OF_DEVICE_MEMORY";
    case VK_ERROR_INITIALIZATION_FAILED:
        return "VK_ERROR_INITIALIZATION_FAILED";
    case VK_ERROR_DEVICE_LOST:
        return "VK_ERROR_DEVICE_LOST";
    case VK_ERROR_MEMORY_MAP_FAILED:
        return "VK_ERROR_MEMORY_MAP_FAILED";
    case VK_ERROR_LAYER_NOT_PRESENT:
        return "VK_ERROR_LAYER_NOT_PRESENT";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
        return "VK_ERROR_EXTENSION_NOT_PRESENT";
    case VK_ERROR_FEATURE_NOT_PRESENT:
        return "VK_ERROR_FEATURE_NOT_PRESENT";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
        return "VK_ERROR_INCOMPATIBLE_DRIVER";
    case VK_ERROR_TOO_MANY_OBJECTS:
        return "VK_ERROR_TOO_MANY_OBJECTS";
    case VK_ERROR_FORMAT_NOT_SUPPORTED:
        return "VK_ERROR_FORMAT_NOT_SUPPORTED";
    case VK_ERROR_FRAGMENTED_POOL:
        return "VK_ERROR_FRAGMENTED_POOL";
    case VK_ERROR_OUT_OF_POOL_MEMORY:
        return "VK_ERROR_OUT_OF_POOL_MEMORY";
    case VK_ERROR_INVALID_SHADER_NV:
        return "VK_ERROR_INVALID_SHADER_NV";
    default:
        return "VkResult " + std::to_string(static_cast<int>(result));
    }
}

/// A part of a VkBuffer, of ours or of the caller's.
struct slice {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceSize offset = 0;
    VkDeviceSize size = 0;
};

class context {
  public:
    device_description description;
    functions call;
    VkPhysicalDeviceProperties properties{};
    VkPhysicalDeviceMemoryProperties memory{};
    device_limits limits;
    VkDeviceSize max_allocation = 0;
    device_traffic traffic;
    /// Bound where a program declares a buffer that a call does not use.
    slice unused;
    bool lost = false;

    [[nodiscard]] VkDevice device() const noexcept { return description.device; }
    [[nodiscard]] const VkAllocationCallbacks* callbacks() const noexcept {
        return description.allocation_callbacks;
    }

    /// The error of a lost device, or nothing.
    [[nodiscard]] result<void> alive() const {
        if (lost) {
            return fail(error_code::device_lost,
                        "The Vulkan device " + std::string(properties.deviceName) +
                            " was lost (VK_ERROR_DEVICE_LOST); make a new one.");
        }
        return {};
    }

    /// What a Vulkan call returned, as a result. `what` completes "Vulkan could not …".
    [[nodiscard]] result<void> check(VkResult returned, std::string_view what) {
        if (returned >= 0) {
            return {};
        }
        if (returned == VK_ERROR_DEVICE_LOST) {
            lost = true;
            return alive();
        }
        return fail(code_of(returned),
                    "Vulkan could not " + std::string(what) + ": " + to_string(returned) + ".");
    }

    [[nodiscard]] bool on_cpu() const noexcept {
        return properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    }
    /// The device's memory is the host's.
    [[nodiscard]] bool unified() const noexcept {
        return !description.always_stage &&
               (on_cpu() || properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU);
    }
    [[nodiscard]] bool per_vertices() const noexcept {
        return description.expand_by == expansion::automatic
                   ? !on_cpu()
                   : description.expand_by == expansion::per_vertices;
    }

    /// Whether images of this format can be sampled with a linear filter.
    [[nodiscard]] bool filters(VkFormat format) const {
        VkFormatProperties can{};
        call.get_format_properties(description.physical_device, format, &can);
        return (can.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT) != 0;
    }
    [[nodiscard]] VkDeviceSize largest_heap() const noexcept {
        VkDeviceSize largest = 0;
        for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
            largest = std::max(largest, memory.memoryHeaps[i].size);
        }
        return largest;
    }

    template <class Handle>
    void name(VkObjectType type, Handle handle, const char* text) const {
        if (call.set_object_name) {
            auto info = make<VkDebugUtilsObjectNameInfoEXT>(
                VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT);
            info.objectType = type;
            info.objectHandle = (std::uint64_t)handle; // a pointer or an integer
            info.pObjectName = text;
            (void)call.set_object_name(device(), &info);
        }
    }

  private:
    [[nodiscard]] static error_code code_of(VkResult returned) noexcept {
        switch (returned) {
        case VK_ERROR_OUT_OF_HOST_MEMORY:
        case VK_ERROR_OUT_OF_DEVICE_MEMORY:
        case VK_ERROR_TOO_MANY_OBJECTS:
        case VK_ERROR_MEMORY_MAP_FAILED:
        case VK_ERROR_FRAGMENTED_POOL:
        case VK_ERROR_OUT_OF_POOL_MEMORY:
            return error_code::out_of_memory;
        case VK_ERROR_INVALID_SHADER_NV:
            return error_code::shader_rejected;
        default:
            return error_code::unavailable;
        }
    }
};

} // namespace skybark::vulkan
