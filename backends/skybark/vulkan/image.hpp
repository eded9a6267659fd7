#pragma once
// An image of ours, or the caller's VkImage in our clothes.
//
// Our own images are in VK_IMAGE_LAYOUT_GENERAL from their first moment to their last, so that no
// recorder has to know what another one did. A foreign image comes into every recording, and into
// every upload and download, in `layout_before`, and leaves it in `layout_after`.

#include <skybark/vulkan/buffer.hpp>

namespace skybark::vulkan {

namespace detail {
class layer_pictures;
}

/// A VkImage of the caller's, to be wrapped by `device::wrap`: 2-D, one level, one layer, one
/// sample. It is never destroyed. It needs the usages of what is done with it: colour or depth
/// attachment, sampled, transfer.
struct foreign_image {
    VkImage image = VK_NULL_HANDLE;
    image_description description;
    /// Where it differs from the description's own, as in a swapchain's B8G8R8A8.
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkImageLayout layout_before = VK_IMAGE_LAYOUT_GENERAL;
    VkImageLayout layout_after = VK_IMAGE_LAYOUT_GENERAL;
    foreign_access before;
    foreign_access after;
};

[[nodiscard]] constexpr VkFormat format_of(image_format format) noexcept {
    switch (format) {
    case image_format::rgba8:
        return VK_FORMAT_R8G8B8A8_UNORM;
    case image_format::rgba32f:
        return VK_FORMAT_R32G32B32A32_SFLOAT;
    case image_format::depth32f:
        return VK_FORMAT_D32_SFLOAT;
    }
    return VK_FORMAT_UNDEFINED;
}

[[nodiscard]] constexpr VkImageAspectFlags aspect_of(image_format format) noexcept {
    return format == image_format::depth32f ? VkImageAspectFlags{VK_IMAGE_ASPECT_DEPTH_BIT}
                                            : VkImageAspectFlags{VK_IMAGE_ASPECT_COLOR_BIT};
}

class image {
  public:
    image(image&& other) noexcept
        : context_(other.context_), parts_(std::exchange(other.parts_, {})) {}
    image& operator=(image&& other) noexcept {
        std::swap(context_, other.context_);
        std::swap(parts_, other.parts_);
        return *this;
    }
    ~image() { release(*context_, parts_); }

    [[nodiscard]] image_description description() const noexcept {
        return parts_.foreign.description;
    }
    [[nodiscard]] VkImage handle() const noexcept { return parts_.foreign.image; }
    [[nodiscard]] VkImageView view() const noexcept { return parts_.view; }
    [[nodiscard]] VkFormat format() const noexcept { return parts_.foreign.format; }
    [[nodiscard]] bool is_foreign() const noexcept { return !parts_.owned; }
    [[nodiscard]] const foreign_image& foreign() const noexcept { return parts_.foreign; }
    /// Whether `filter_mode::linear` works on this format; else it reads the nearest texel.
    [[nodiscard]] bool filterable() const noexcept { return parts_.filterable; }

  private:
    friend class device;
    friend class detail::layer_pictures;

    struct parts {
        foreign_image foreign; ///< also describes an image of our own
        detail::allocation memory;
        VkImageView view = VK_NULL_HANDLE;
        bool owned = false;
        bool filterable = false;
    };

    image(context& c, const parts& made) : context_(&c), parts_(made) {}

    static void release(const context& c, parts& p) {
        if (p.view != VK_NULL_HANDLE) {
            c.call.destroy_image_view(c.device(), p.view, c.callbacks());
        }
        if (p.owned && p.foreign.image != VK_NULL_HANDLE) {
            c.call.destroy_image(c.device(), p.foreign.image, c.callbacks());
        }
        detail::release(c, p.memory);
        p = {};
    }

    /// A view of the VkImage that `p` already has.
    [[nodiscard]] static result<void> add_view(context& c, parts& p) {
        auto info = make<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
        info.image = p.foreign.image;
        info.viewType = VK_IMAGE_VIEW_TYPE_2D;
        info.format = p.foreign.format;
        info.subresourceRange = {aspect_of(p.foreign.description.format), 0, 1, 0, 1};
        p.filterable = c.filters(info.format);
        auto done = c.check(c.call.create_image_view(c.device(), &info, c.callbacks(), &p.view),
                            "make a view of an image");
        if (done) {
            c.name_own(VK_OBJECT_TYPE_IMAGE_VIEW, p.view, "view of an image");
        }
        return done;
    }

    /// One of our own, its layout still undefined.
    [[nodiscard]] static result<image> create(context& c, const image_description& what,
                                              VkFormat format) {
        parts p;
        p.foreign.description = what;
        p.foreign.format = format;
        auto done = add_image(c, p);
        if (done) {
            done = add_view(c, p);
        }
        image made(c, p); // gives back what there is
        if (!done) {
            return failure(done.error());
        }
        return made;
    }

    /// A VkImage with its memory.
    [[nodiscard]] static result<void> add_image(context& c, parts& p) {
        const image_description& what = p.foreign.description;
        auto info = make<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
        info.imageType = VK_IMAGE_TYPE_2D;
        info.format = p.foreign.format;
        info.extent = {what.width, what.height, 1};
        info.mipLevels = 1;
        info.arrayLayers = 1;
        info.samples = VK_SAMPLE_COUNT_1_BIT;
        info.tiling = VK_IMAGE_TILING_OPTIMAL;
        info.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                     VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                     (what.format == image_format::depth32f
                          ? VkImageUsageFlags{VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT}
                          : VkImageUsageFlags{VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT});
        const std::string sentence = "make an image of " + std::to_string(what.width) + " x " +
                                     std::to_string(what.height) + " pixels";
        p.owned = true;
        auto done = c.check(c.call.create_image(c.device(), &info, c.callbacks(), &p.foreign.image),
                            sentence);
        if (!done) {
            return done;
        }
        c.name_own(VK_OBJECT_TYPE_IMAGE, p.foreign.image, "image");
        VkMemoryRequirements need{};
        c.call.get_image_memory_requirements(c.device(), p.foreign.image, &need);
        auto memory =
            detail::allocate(c, need, memory_kind::device, VK_NULL_HANDLE, p.foreign.image);
        if (!memory) {
            return failure(memory.error());
        }
        p.memory = *memory;
        c.say_made("image", need.size);
        return c.check(
            c.call.bind_image_memory(c.device(), p.foreign.image, p.memory.memory, p.memory.offset),
            sentence);
    }

    context* context_;
    parts parts_;
};

} // namespace skybark::vulkan
