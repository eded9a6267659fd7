#pragma once
// A buffer of ours, or the caller's VkBuffer in our clothes.

#include <skybark/vulkan/memory.hpp>

namespace skybark::vulkan {

/// What the caller's own commands do with an object before and after ours: our barriers wait for
/// the one and hold back the other. All commands of the queue are covered in any case; name what
/// lies outside them, such as the host.
struct foreign_access {
    VkPipelineStageFlags2 stage = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    VkAccessFlags2 access = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
};

/// A VkBuffer of the caller's, to be wrapped by `device::wrap`. It is never destroyed. It needs the
/// usages of what is done with it: storage for kernels, transfer for copies, index, indirect.
struct foreign_buffer {
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceSize size = 0;
    foreign_access before;
    foreign_access after;
};

class buffer {
  public:
    buffer(buffer&& other) noexcept
        : context_(other.context_), own_(std::exchange(other.own_, {})),
          foreign_(std::exchange(other.foreign_, {})), size_(std::exchange(other.size_, 0)) {}
    buffer& operator=(buffer&& other) noexcept {
        std::swap(context_, other.context_);
        std::swap(own_, other.own_);
        std::swap(foreign_, other.foreign_);
        std::swap(size_, other.size_);
        return *this;
    }
    ~buffer() { detail::release(*context_, own_); }

    [[nodiscard]] std::uint64_t size_bytes() const noexcept { return size_; }

    /// For the caller's own commands. Null where the buffer has no bytes.
    [[nodiscard]] VkBuffer handle() const noexcept {
        return is_foreign() ? foreign_.buffer : own_.buffer;
    }
    [[nodiscard]] bool is_foreign() const noexcept { return foreign_.buffer != VK_NULL_HANDLE; }
    [[nodiscard]] const foreign_buffer& foreign() const noexcept { return foreign_; }

    /// Where the host sees it, or null.
    [[nodiscard]] std::byte* mapped() const noexcept { return own_.memory.mapped; }

  private:
    friend class device;
    buffer(context& c, detail::buffer_memory own, std::uint64_t size)
        : context_(&c), own_(own), size_(size) {}
    buffer(context& c, const foreign_buffer& foreign)
        : context_(&c), foreign_(foreign), size_(foreign.size) {}

    context* context_;
    detail::buffer_memory own_;
    foreign_buffer foreign_;
    std::uint64_t size_ = 0;
};

} // namespace skybark::vulkan
