#pragma once
// Device memory, one allocation a resource or a piece of the caller's, and VkBuffers with their
// memory.

#include <skybark/vulkan/context.hpp>

#include <cstring>
#include <utility>

namespace skybark::vulkan {

namespace detail {

inline constexpr VkMemoryPropertyFlags host_coherent =
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;

/// The first memory type that is allowed, has all of `wanted` and none of `unwanted`, or −1.
[[nodiscard]] inline int find_memory_type(const context& c, std::uint32_t allowed,
                                          VkMemoryPropertyFlags wanted,
                                          VkMemoryPropertyFlags unwanted = 0) {
    for (std::uint32_t i = 0; i < c.memory.memoryTypeCount; ++i) {
        const VkMemoryPropertyFlags flags = c.memory.memoryTypes[i].propertyFlags;
        if ((allowed >> i & 1u) != 0 && (flags & wanted) == wanted && (flags & unwanted) == 0) {
            return static_cast<int>(i);
        }
    }
    return -1;
}

[[nodiscard]] inline int choose_memory_type(const context& c, std::uint32_t allowed,
                                            memory_kind kind) {
    int type = -1;
    const auto otherwise = [&](VkMemoryPropertyFlags wanted, VkMemoryPropertyFlags unwanted = 0) {
        type = type < 0 ? find_memory_type(c, allowed, wanted, unwanted) : type;
    };
    switch (kind) {
    case memory_kind::device:
        if (c.unified()) {
            otherwise(VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | host_coherent);
        } else { // the window that the host sees is small on many cards: leave it to the caller
            otherwise(VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT);
        }
        otherwise(VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
        otherwise(0);
        break;
    case memory_kind::upload:
        otherwise(host_coherent, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
        otherwise(host_coherent);
        break;
    case memory_kind::download: // reading memory that is not cached takes ten times as long
        otherwise(host_coherent | VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
        otherwise(host_coherent);
        break;
    }
    return type;
}

struct allocation {
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkDeviceSize offset = 0;
    std::byte* mapped = nullptr; ///< where the host sees it, or null
    void* of_caller = nullptr;   ///< memory_piece::allocation
    bool counted = false;        ///< as an object of the device, of so many bytes
    VkDeviceSize size = 0;
};

/// From now on it counts as an object that a device has made.
inline void count(const context& c, allocation& a, VkDeviceSize size) {
    a.counted = true;
    a.size = size;
    c.usage.add(size);
}

inline void release(const context& c, allocation& a) {
    if (a.counted) {
        c.usage.remove(a.size);
    }
    if (a.memory == VK_NULL_HANDLE) {
        a = {};
        return;
    }
    if (const memory_hooks& h = c.description.memory; h.allocate) {
        h.free(h.user, {a.memory, a.offset, a.mapped, a.of_caller});
    } else {
        c.call.free_memory(c.device(), a.memory, c.callbacks()); // unmaps it as well
    }
    a = {};
}

[[nodiscard]] inline result<allocation> allocate_of_caller(context& c,
                                                           const memory_request& request) {
    const memory_hooks& h = c.description.memory;
    memory_piece piece;
    const std::string size = std::to_string(request.need.size) + " bytes";
    if (auto done =
            c.check(h.allocate(h.user, request, piece), "have " + size + " from its caller");
        !done) {
        return failure(done.error());
    }
    allocation made{piece.memory, piece.offset,
                    request.mapped ? static_cast<std::byte*>(piece.mapped) : nullptr,
                    piece.allocation};
    if (piece.memory == VK_NULL_HANDLE || (request.mapped && piece.mapped == nullptr)) {
        release(c, made);
        return fail(error_code::out_of_memory,
                    "The caller's memory of " + size + " is null, or not mapped.");
    }
    return made;
}

[[nodiscard]] inline result<allocation> allocate_own(context& c, const memory_request& request) {
    const std::string size = std::to_string(request.need.size) + " bytes";
    auto info = make<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
    info.allocationSize = request.need.size;
    info.memoryTypeIndex = request.type;
    allocation made;
    auto done = c.check(c.call.allocate_memory(c.device(), &info, c.callbacks(), &made.memory),
                        "allocate " + size);
    if (done) {
        c.name_own(VK_OBJECT_TYPE_DEVICE_MEMORY, made.memory, "memory", request.need.size);
    }
    if (done && request.mapped) {
        void* mapped = nullptr;
        done = c.check(c.call.map_memory(c.device(), made.memory, 0, VK_WHOLE_SIZE, 0, &mapped),
                       "map " + size);
        made.mapped = static_cast<std::byte*>(mapped);
    }
    if (!done) {
        release(c, made);
        return failure(done.error());
    }
    return made;
}

/// Memory for `need`, mapped for as long as it lives where the host may see it. It is for `buffer`
/// or for `image`.
[[nodiscard]] inline result<allocation> allocate(context& c, const VkMemoryRequirements& need,
                                                 memory_kind kind, VkBuffer buffer, VkImage image) {
    const std::string size = std::to_string(need.size) + " bytes";
    if (need.size > c.max_allocation) {
        return fail(error_code::out_of_memory, "This Vulkan device allocates at most " +
                                                   std::to_string(c.max_allocation) +
                                                   " bytes at once; " + size + " were asked for.");
    }
    const int type = choose_memory_type(c, need.memoryTypeBits, kind);
    if (type < 0) {
        return fail(error_code::unavailable,
                    "This Vulkan device has no memory of the kind needed for " + size + ".");
    }
    const VkMemoryPropertyFlags flags = c.memory.memoryTypes[type].propertyFlags;
    const bool map =
        kind != memory_kind::device || (c.unified() && (flags & host_coherent) == host_coherent);
    const memory_request request{need, kind, static_cast<std::uint32_t>(type), map, buffer, image};
    auto made =
        c.description.memory.allocate ? allocate_of_caller(c, request) : allocate_own(c, request);
    if (!made) {
        c.say(log_level::warning, [&] { return made.error().message; });
    }
    return made;
}

/// A VkBuffer and its memory, given back together.
struct buffer_memory {
    VkBuffer buffer = VK_NULL_HANDLE;
    allocation memory;
    VkDeviceSize size = 0;
};

inline void release(const context& c, buffer_memory& b) {
    if (b.buffer != VK_NULL_HANDLE) {
        c.call.destroy_buffer(c.device(), b.buffer, c.callbacks());
    }
    release(c, b.memory);
    b = {};
}

inline constexpr VkBufferUsageFlags every_usage =
    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
    VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
    VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;

/// `size` bytes, not 0, of undefined content. `name` says what for, as in "buffer".
[[nodiscard]] inline result<buffer_memory> make_buffer_memory(context& c, VkDeviceSize size,
                                                              memory_kind kind, const char* name) {
    if (size > c.max_allocation) { // before Vulkan sees a size that it need not check
        return fail(error_code::out_of_memory,
                    "A buffer of " + std::to_string(size) +
                        " bytes was asked for; this Vulkan device has buffers of at most " +
                        std::to_string(c.max_allocation) + " bytes.");
    }
    auto info = make<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
    info.size = size;
    info.usage = every_usage;
    buffer_memory made;
    made.size = size;
    const std::string what = "make a buffer of " + std::to_string(size) + " bytes";
    auto done = c.check(c.call.create_buffer(c.device(), &info, c.callbacks(), &made.buffer), what);
    if (!done) {
        return failure(done.error());
    }
    c.name_own(VK_OBJECT_TYPE_BUFFER, made.buffer, name, size);
    VkMemoryRequirements need{};
    c.call.get_buffer_memory_requirements(c.device(), made.buffer, &need);
    auto memory = allocate(c, need, kind, made.buffer, VK_NULL_HANDLE);
    if (!memory) {
        release(c, made);
        return failure(memory.error());
    }
    made.memory = *memory;
    done = c.check(
        c.call.bind_buffer_memory(c.device(), made.buffer, made.memory.memory, made.memory.offset),
        what);
    if (!done) {
        release(c, made);
        return failure(done.error());
    }
    c.say_made(name, size);
    return made;
}

} // namespace detail
} // namespace skybark::vulkan
