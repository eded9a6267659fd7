#pragma once
// What all parts of a device share: the caller's handles, the function table, the device's
// properties, the bytes that crossed, and whether it is lost. It stays at one address while the
// device itself may move.

#include <skybark/core/backend.hpp>
#include <skybark/core/hooks.hpp>
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

/// Where memory should lie. Every choice falls back to what the device has.
enum class memory_kind {
    device,   ///< fastest for the device; the host writes to it only where the memory is unified
    upload,   ///< written by the host, read by the device
    download, ///< written by the device, read by the host
};

/// Memory that a buffer or an image of ours needs.
struct memory_request {
    VkMemoryRequirements need{};
    memory_kind kind = memory_kind::device;
    std::uint32_t type = 0; ///< the memory type that we would take: `need` allows it
    bool mapped = false;    ///< must be host visible, host coherent, and mapped as long as it lives
    VkBuffer buffer = VK_NULL_HANDLE; ///< what it is for: one of these is null
    VkImage image = VK_NULL_HANDLE;   ///< with optimal tiling
};

/// A piece of memory of the caller's.
struct memory_piece {
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkDeviceSize offset = 0;    ///< a multiple of what the request needs
    void* mapped = nullptr;     ///< where the host sees the piece's first byte, if asked for
    void* allocation = nullptr; ///< the caller's own: comes back with `free`
};

/// Where device memory comes from: an engine's heap, or VMA. Both or none; without, each buffer and
/// image gets an allocation of its own.
struct memory_hooks {
    void* user = nullptr; ///< given to both
    /// Fills in `piece`, or returns what Vulkan returned.
    VkResult (*allocate)(void* user, const memory_request& request, memory_piece& piece) = nullptr;
    /// After the buffer or image was destroyed.
    void (*free)(void* user, const memory_piece& piece) = nullptr;
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
    /// For the host memory of what we create; given to every call that takes them.
    const VkAllocationCallbacks* allocation_callbacks = nullptr;
    memory_hooks memory = {};
    skybark::hooks hooks = {};

    bool synchronization2 = false;  ///< enabled by the caller, as we rely on it
    bool dynamic_rendering = false; ///< the same
    /// VK_EXT_debug_utils is enabled: all that we create gets a name that begins with "skybark",
    /// and every pattern a label in the command buffer.
    bool debug_utils = false;
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
    mutable device_usage usage; ///< counted where memory is given back
    /// Bound where a program declares a buffer that a call does not use.
    slice unused;
    bool lost = false;
    bool watched = false; ///< patterns have zones or labels

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
            if (!lost) {
                say(log_level::error, [this] {
                    return "The Vulkan device " + std::string(properties.deviceName) +
                           " was lost (VK_ERROR_DEVICE_LOST).";
                });
            }
            lost = true;
            return alive();
        }
        return fail(code_of(returned),
                    "Vulkan could not " + std::string(what) + ": " + to_string(returned) + ".");
    }

    template <class Text>
    void say(log_level level, Text&& text) const {
        log(description.hooks, level, text);
    }
    /// Resources that were made, with what they take.
    void say_made(const char* what, VkDeviceSize bytes) const {
        say(log_level::debug, [&] {
            return std::string(properties.deviceName) + " has made one " + what + " of " +
                   std::to_string(bytes) + " bytes.";
        });
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
    /// Invocations in a group of an accumulation: as many as a GPU runs in step. On a CPU more
    /// would be idle, at the end of an element's slabs.
    [[nodiscard]] std::uint32_t slab_group() const noexcept { return per_vertices() ? 32 : 16; }

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

    /// The name of one of our own: "skybark ", what it is, and its bytes, if any.
    template <class Handle>
    void name_own(VkObjectType type, Handle handle, const char* what,
                  VkDeviceSize bytes = 0) const {
        if (call.set_object_name) {
            std::string text = std::string("skybark ") + what;
            if (bytes != 0) {
                text += " of " + std::to_string(bytes) + " bytes";
            }
            name(type, handle, text.c_str());
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

namespace detail {

/// A pattern: a zone of the hooks, and a label in the command buffer. Without both, a branch.
class pattern_scope {
  public:
    pattern_scope(const context& c, VkCommandBuffer commands, const char* name) {
        if (c.watched) {
            begin(c, commands, name);
        }
    }
    pattern_scope(const pattern_scope&) = delete;
    pattern_scope& operator=(const pattern_scope&) = delete;
    ~pattern_scope() {
        if (context_) {
            end();
        }
    }

  private:
    void begin(const context& c, VkCommandBuffer commands, const char* name) {
        context_ = &c;
        if (const hooks& h = c.description.hooks; h.begin_zone) {
            h.begin_zone(h.user, name);
        }
        if (c.call.begin_label && c.call.end_label && commands != VK_NULL_HANDLE) {
            commands_ = commands;
            auto label = make<VkDebugUtilsLabelEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT);
            label.pLabelName = name;
            c.call.begin_label(commands, &label);
        }
    }
    void end() {
        if (commands_ != VK_NULL_HANDLE) {
            context_->call.end_label(commands_);
        }
        if (const hooks& h = context_->description.hooks; h.end_zone) {
            h.end_zone(h.user);
        }
    }

    const context* context_ = nullptr; ///< null: nobody looks
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
};

} // namespace detail
} // namespace skybark::vulkan
