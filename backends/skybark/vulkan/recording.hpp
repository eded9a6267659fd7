#pragma once
// What a recorder works with and a later one uses again: a command buffer with its fence, staging
// and scratch memory, pictures to draw layers into, and descriptor sets. Once a program has
// recorded its largest frame, none of these grows any more.

#include <skybark/vulkan/pipelines.hpp>

namespace skybark::vulkan::detail {

/// Memory for the length of a recording, cut from blocks that stay.
class arena {
  public:
    arena(context& c, memory_kind kind, const char* name)
        : context_(&c), kind_(kind), name_(name) {}
    arena(const arena&) = delete;
    arena& operator=(const arena&) = delete;
    ~arena() {
        for (block& b : blocks_) {
            release(*context_, b.memory);
        }
    }

    struct piece {
        slice where;
        std::byte* mapped = nullptr;
    };

    /// `size` bytes, not 0, that a kernel may be given. Blocks are tried in order, so that equal
    /// sequences of requests find equal places.
    [[nodiscard]] result<piece> take(VkDeviceSize size) {
        for (block& b : blocks_) {
            if (const VkDeviceSize at = aligned(b.used); at + size <= b.memory.size) {
                return cut(b, at, size);
            }
        }
        VkDeviceSize wanted = std::max(size, least);
        if (!blocks_.empty()) {
            wanted = std::max(wanted, std::min(2 * blocks_.back().memory.size, most));
        }
        auto memory = make_buffer_memory(*context_, wanted, kind_, name_);
        if (!memory) {
            return failure(memory.error());
        }
        blocks_.push_back({*memory, 0});
        return cut(blocks_.back(), 0, size);
    }

    void reset() {
        for (block& b : blocks_) {
            b.used = 0;
        }
    }

  private:
    static constexpr VkDeviceSize least = 64 << 10;
    static constexpr VkDeviceSize most = 32 << 20;

    struct block {
        buffer_memory memory;
        VkDeviceSize used = 0;
    };

    [[nodiscard]] VkDeviceSize aligned(VkDeviceSize at) const {
        const VkDeviceSize step = context_->limits.view_alignment;
        return (at + step - 1) / step * step;
    }

    [[nodiscard]] static piece cut(block& b, VkDeviceSize at, VkDeviceSize size) {
        b.used = at + size;
        std::byte* mapped = b.memory.memory.mapped;
        return {{b.memory.buffer, at, size}, mapped ? mapped + at : nullptr};
    }

    context* context_;
    memory_kind kind_;
    const char* name_;
    std::vector<block> blocks_;
};

/// Descriptor sets of one layout, handed out in order and all taken back at once.
class descriptor_sets {
  public:
    descriptor_sets(context& c, const program_layout& l) : context_(&c), layout_(&l) {}
    descriptor_sets(const descriptor_sets&) = delete;
    descriptor_sets& operator=(const descriptor_sets&) = delete;
    ~descriptor_sets() {
        for (const VkDescriptorPool pool : pools_) {
            context_->call.destroy_descriptor_pool(context_->device(), pool, context_->callbacks());
        }
    }

    [[nodiscard]] const program_layout& layout() const noexcept { return *layout_; }

    [[nodiscard]] result<VkDescriptorSet> take() {
        if (used_ == sets_.size()) {
            if (auto done = grow(); !done) {
                return failure(done.error());
            }
        }
        return sets_[used_++];
    }

    void reset() { used_ = 0; }

  private:
    static constexpr std::uint32_t pool_sets = 64;

    [[nodiscard]] result<void> grow() {
        context& c = *context_;
        const layout_shape& shape = layout_->shape;
        std::vector<VkDescriptorPoolSize> sizes{
            {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, pool_sets * shape.buffers()}};
        for (std::uint32_t slot = 0; slot < image_slots; ++slot) {
            if (shape.images[slot] != 0) {
                sizes.push_back({descriptor_of(slot), pool_sets * shape.images[slot]});
            }
        }
        auto info = make<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
        info.maxSets = pool_sets;
        info.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
        info.pPoolSizes = sizes.data();
        VkDescriptorPool pool = VK_NULL_HANDLE;
        if (auto done =
                c.check(c.call.create_descriptor_pool(c.device(), &info, c.callbacks(), &pool),
                        "make a descriptor pool");
            !done) {
            return done;
        }
        pools_.push_back(pool);
        c.name_own(VK_OBJECT_TYPE_DESCRIPTOR_POOL, pool, "descriptor pool");
        const std::vector<VkDescriptorSetLayout> layouts(pool_sets, layout_->set);
        auto allocate =
            make<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
        allocate.descriptorPool = pool;
        allocate.descriptorSetCount = pool_sets;
        allocate.pSetLayouts = layouts.data();
        std::array<VkDescriptorSet, pool_sets> made{};
        if (auto done = c.check(c.call.allocate_descriptor_sets(c.device(), &allocate, made.data()),
                                "allocate descriptor sets");
            !done) {
            return done;
        }
        sets_.insert(sets_.end(), made.begin(), made.end());
        if (c.call.set_object_name) {
            for (const VkDescriptorSet set : made) {
                c.name_own(VK_OBJECT_TYPE_DESCRIPTOR_SET, set, "descriptor set");
            }
        }
        return {};
    }

    context* context_;
    const program_layout* layout_;
    std::vector<VkDescriptorPool> pools_;
    std::vector<VkDescriptorSet> sets_;
    std::size_t used_ = 0;
};

/// What layers are drawn into; see shaders/programs/peel.glsl. One pair serves all that fit.
class layer_pictures {
  public:
    explicit layer_pictures(context& c) : context_(&c) {}

    struct pair {
        image depth;
        image fragments; ///< of VK_FORMAT_R32G32_UINT
    };

    /// At least as large. What is in it, and its layout, are undefined.
    [[nodiscard]] result<const pair*> take(std::uint32_t width, std::uint32_t height) {
        for (const auto& one : pairs_) {
            const image_description size = one->depth.description();
            if (size.width >= width && size.height >= height) {
                return one.get();
            }
        }
        auto depth =
            image::create(*context_, {width, height, image_format::depth32f}, VK_FORMAT_D32_SFLOAT);
        if (!depth) {
            return failure(depth.error());
        }
        auto fragments =
            image::create(*context_, {width, height, image_format::rgba8}, VK_FORMAT_R32G32_UINT);
        if (!fragments) {
            return failure(fragments.error());
        }
        pairs_.push_back(std::make_unique<pair>(pair{std::move(*depth), std::move(*fragments)}));
        return pairs_.back().get();
    }

  private:
    context* context_;
    std::vector<std::unique_ptr<pair>> pairs_;
};

class recording {
  public:
    explicit recording(context& c)
        : staging(c, memory_kind::upload, "staging buffer"),
          readback(c, memory_kind::download, "readback buffer"),
          scratch(c, memory_kind::device, "scratch buffer"), layers(c), context_(&c) {}
    recording(const recording&) = delete;
    recording& operator=(const recording&) = delete;
    ~recording() {
        const context& c = *context_;
        if (pool_ != VK_NULL_HANDLE) {
            c.call.destroy_command_pool(c.device(), pool_, c.callbacks());
        }
        if (fence_ != VK_NULL_HANDLE) {
            c.call.destroy_fence(c.device(), fence_, c.callbacks());
        }
    }

    arena staging;  ///< the host writes, the device reads
    arena readback; ///< the device writes, the host reads
    arena scratch;  ///< the device's own temporaries
    layer_pictures layers;

    [[nodiscard]] VkCommandBuffer commands() const noexcept { return commands_; }
    [[nodiscard]] VkFence fence() const noexcept { return fence_; }

    /// Begins our own command buffer.
    [[nodiscard]] result<void> begin() {
        context& c = *context_;
        if (auto done = prepare(); !done) {
            return done;
        }
        auto info = make<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
        info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
        commands_ = own_commands_;
        return c.check(c.call.begin_command_buffer(commands_, &info), "begin a command buffer");
    }

    /// Goes on in the caller's.
    void append_to(VkCommandBuffer commands) { commands_ = commands; }

    [[nodiscard]] result<VkDescriptorSet> take_set(const program_layout& layout) {
        for (const auto& sets : sets_) {
            if (&sets->layout() == &layout) {
                return sets->take();
            }
        }
        sets_.push_back(std::make_unique<descriptor_sets>(*context_, layout));
        return sets_.back()->take();
    }

    /// Everything may be used again: the device has finished, or never began.
    void reset() {
        staging.reset();
        readback.reset();
        scratch.reset();
        for (const auto& sets : sets_) {
            sets->reset();
        }
        if (commands_ != VK_NULL_HANDLE && commands_ == own_commands_) {
            (void)context_->call.reset_command_pool(context_->device(), pool_, 0);
        }
        commands_ = VK_NULL_HANDLE;
    }

  private:
    /// The command buffer and the fence, once.
    [[nodiscard]] result<void> prepare() {
        context& c = *context_;
        if (own_commands_ != VK_NULL_HANDLE) {
            return {};
        }
        auto pool = make<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
        pool.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
        pool.queueFamilyIndex = c.description.queue_family;
        if (pool_ == VK_NULL_HANDLE) {
            if (auto done =
                    c.check(c.call.create_command_pool(c.device(), &pool, c.callbacks(), &pool_),
                            "make a command pool");
                !done) {
                return done;
            }
            c.name_own(VK_OBJECT_TYPE_COMMAND_POOL, pool_, "command pool");
        }
        if (fence_ == VK_NULL_HANDLE) {
            const auto fence = make<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
            if (auto done = c.check(c.call.create_fence(c.device(), &fence, c.callbacks(), &fence_),
                                    "make a fence");
                !done) {
                return done;
            }
            c.name_own(VK_OBJECT_TYPE_FENCE, fence_, "fence");
        }
        auto info =
            make<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
        info.commandPool = pool_;
        info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
        info.commandBufferCount = 1;
        auto done = c.check(c.call.allocate_command_buffers(c.device(), &info, &own_commands_),
                            "allocate a command buffer");
        if (done) {
            c.name_own(VK_OBJECT_TYPE_COMMAND_BUFFER, own_commands_, "command buffer");
        }
        return done;
    }

    context* context_;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer own_commands_ = VK_NULL_HANDLE;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    VkFence fence_ = VK_NULL_HANDLE;
    std::vector<std::unique_ptr<descriptor_sets>> sets_;
};

} // namespace skybark::vulkan::detail
