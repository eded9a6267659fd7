#pragma once
// A volume of ours, or the caller's 3-D VkImage in our clothes.
//
// As with images, our own volumes are in VK_IMAGE_LAYOUT_GENERAL from their first moment to their
// last, and a foreign one comes into every recording in `layout_before` and leaves it in
// `layout_after`.

#include <skybark/vulkan/buffer.hpp>

#include <algorithm>

namespace skybark::vulkan {

[[nodiscard]] constexpr VkFormat format_of(volume_format format) noexcept {
    switch (format) {
    case volume_format::int32:
        return VK_FORMAT_R32_SINT;
    case volume_format::float32:
        return VK_FORMAT_R32_SFLOAT;
    case volume_format::float16:
        return VK_FORMAT_R16_SFLOAT;
    }
    return VK_FORMAT_UNDEFINED;
}

/// A VkImage of the caller's, to be wrapped by `device::wrap`: 3-D, one level, one sample, of the
/// format that `format_of` has for its description. It is never destroyed. It needs the usages of
/// what is done with it: storage for sums, scans and targets, sampled for kernels that read it,
/// transfer for copies and for an accumulation that clears it.
struct foreign_volume {
    VkImage image = VK_NULL_HANDLE;
    volume_description description;
    VkImageLayout layout_before = VK_IMAGE_LAYOUT_GENERAL;
    VkImageLayout layout_after = VK_IMAGE_LAYOUT_GENERAL;
    foreign_access before;
    foreign_access after;
};

class volume {
  public:
    volume(volume&& other) noexcept
        : context_(other.context_), parts_(std::exchange(other.parts_, {})) {}
    volume& operator=(volume&& other) noexcept {
        std::swap(context_, other.context_);
        std::swap(parts_, other.parts_);
        return *this;
    }
    ~volume() { release(*context_, parts_); }

    [[nodiscard]] volume_description description() const noexcept {
        return parts_.foreign.description;
    }
    [[nodiscard]] VkImage handle() const noexcept { return parts_.foreign.image; }
    /// All of it, 3-D, for descriptors of the caller's own pipelines: sampled or storage, a volume
    /// of ours in VK_IMAGE_LAYOUT_GENERAL. What the caller records behind `finish`, or submits to
    /// the queue after `submit`, sees what was written, and needs no barrier; nor is one needed
    /// before the next recording, which waits for what reads it.
    [[nodiscard]] VkImageView view() const noexcept { return parts_.view; }
    [[nodiscard]] bool is_foreign() const noexcept { return !parts_.owned; }
    [[nodiscard]] const foreign_volume& foreign() const noexcept { return parts_.foreign; }
    /// Whether it is sampled trilinearly; else the nearest voxel is read.
    [[nodiscard]] bool filterable() const noexcept { return parts_.filterable; }

  private:
    friend class device;

    struct parts {
        foreign_volume foreign; ///< also describes a volume of our own
        detail::allocation memory;
        VkImageView view = VK_NULL_HANDLE;
        bool owned = false;
        bool filterable = false;
    };

    volume(context& c, const parts& made) : context_(&c), parts_(made) {}

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

    /// "a volume of 2 x 3 x 4 voxels of 4 bytes"
    [[nodiscard]] static std::string words_for(const volume_description& what) {
        return std::string("a volume of ") + std::to_string(what.width) + " x " +
               std::to_string(what.height) + " x " + std::to_string(what.depth) + " voxels of " +
               std::to_string(bytes_per_voxel(what.format)) + " bytes";
    }

    /// A view of the VkImage that `p` already has.
    [[nodiscard]] static result<void> add_view(context& c, parts& p) {
        auto info = make<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
        info.image = p.foreign.image;
        info.viewType = VK_IMAGE_VIEW_TYPE_3D;
        info.format = format_of(p.foreign.description.format);
        info.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
        p.filterable = c.filters(info.format);
        auto done = c.check(c.call.create_image_view(c.device(), &info, c.callbacks(), &p.view),
                            "make a view of a volume");
        if (done) {
            c.name_own(VK_OBJECT_TYPE_IMAGE_VIEW, p.view, "view of a volume");
        }
        return done;
    }

    /// Whether the device has volumes of this size and format, and room for one.
    [[nodiscard]] static result<void> check_size(context& c, const volume_description& what,
                                                 const VkImageCreateInfo& info) {
        if (what.format == volume_format::float16 &&
            !c.description.shader_storage_image_extended_formats) {
            return fail(error_code::unavailable,
                        "Volumes of float16 need a Vulkan device with the feature "
                        "shaderStorageImageExtendedFormats enabled, and a description that says "
                        "so.");
        }
        VkImageFormatProperties can{};
        const VkResult known = c.call.get_image_format_properties(
            c.description.physical_device, info.format, info.imageType, info.tiling, info.usage,
            info.flags, &can);
        const std::string wanted = words_for(what);
        if (known == VK_ERROR_FORMAT_NOT_SUPPORTED) {
            return fail(error_code::unavailable,
                        std::string(c.properties.deviceName) + " cannot make " + wanted +
                            ": it has no volumes of this format that kernels may write.");
        }
        if (auto done = c.check(known, "find out about " + wanted); !done) {
            return done;
        }
        const std::uint32_t most = std::min({can.maxExtent.width, can.maxExtent.height,
                                             can.maxExtent.depth, c.limits.max_volume_size});
        if (std::min({what.width, what.height, what.depth}) == 0 ||
            std::max({what.width, what.height, what.depth}) > most) {
            return fail(error_code::out_of_memory,
                        std::string(c.properties.deviceName) + " cannot make " + wanted +
                            "; each side must be 1 to " + std::to_string(most) + ".");
        }
        const std::uint64_t room =
            std::min<std::uint64_t>({can.maxResourceSize, c.max_allocation, c.largest_heap()});
        const std::uint64_t least = // 2^48 voxels at most
            std::uint64_t{what.width} * what.height * what.depth * bytes_per_voxel(what.format);
        if (least > room) {
            return fail(error_code::out_of_memory,
                        std::string(c.properties.deviceName) + " cannot make " + wanted + ": " +
                            std::to_string(least) + " bytes, and it has at most " +
                            std::to_string(room) + " bytes for one.");
        }
        return {};
    }

    /// A VkImage with its memory.
    [[nodiscard]] static result<void> add_image(context& c, parts& p) {
        const volume_description& what = p.foreign.description;
        auto info = make<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
        info.imageType = VK_IMAGE_TYPE_3D;
        info.format = format_of(what.format);
        info.extent = {what.width, what.height, what.depth};
        info.mipLevels = 1;
        info.arrayLayers = 1;
        info.samples = VK_SAMPLE_COUNT_1_BIT;
        info.tiling = VK_IMAGE_TILING_OPTIMAL;
        info.usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                     VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
        if (auto done = check_size(c, what, info); !done) {
            return done;
        }
        const std::string sentence = "make " + words_for(what);
        p.owned = true;
        auto done = c.check(c.call.create_image(c.device(), &info, c.callbacks(), &p.foreign.image),
                            sentence);
        if (!done) {
            return done;
        }
        c.name_own(VK_OBJECT_TYPE_IMAGE, p.foreign.image, "volume");
        VkMemoryRequirements need{};
        c.call.get_image_memory_requirements(c.device(), p.foreign.image, &need);
        auto memory =
            detail::allocate(c, need, memory_kind::device, VK_NULL_HANDLE, p.foreign.image);
        if (!memory) {
            return fail(memory.error().code,
                        "Vulkan could not " + sentence + ". " + memory.error().message);
        }
        p.memory = *memory;
        c.say_made("volume", need.size);
        return c.check(
            c.call.bind_image_memory(c.device(), p.foreign.image, p.memory.memory, p.memory.offset),
            sentence);
    }

    context* context_;
    parts parts_;
};

} // namespace skybark::vulkan
