#pragma once
// What every pattern of a recorder is made of: the first error, barriers, foreign objects that come
// and go, copies, and compute programs with what they are given.
//
// Between any two commands stands a barrier over all memory: patterns depend on each other nearly
// always, and on one queue a finer barrier would gain little.

#include <skybark/vulkan/device.hpp>
#include <skybark/vulkan/programs/own_dispatch_arguments.hpp>

#include <optional>

namespace skybark::vulkan::detail {

/// The skeletons' four words and the kernel's bytes.
struct push_block {
    std::array<std::byte, push_bytes> bytes{};
    std::uint32_t size = 16;

    void set_header(std::array<std::uint32_t, 4> header) {
        std::memcpy(bytes.data(), header.data(), sizeof header);
    }
};

template <kernel K>
[[nodiscard]] push_block push_of(const K& kernel) {
    push_block push;
    if constexpr (!std::is_empty_v<K>) {
        std::memcpy(push.bytes.data() + 16, &kernel, sizeof kernel);
        push.size = 16 + (static_cast<std::uint32_t>(sizeof kernel) + 3) / 4 * 4;
    }
    return push;
}

using compute_slices = std::array<slice, compute_bindings>;

/// The images of each kind that a program is given.
struct bound_images {
    layout_shape shape;
    std::array<std::array<VkDescriptorImageInfo, max_kernel_images>, image_slots> infos{};
};

/// A compute program and what it is given; recorded by `stream::dispatch`.
struct compute_call {
    spirv_words words;
    const char* name = "";
    push_block push;
    compute_slices buffers{}; ///< null: the program does not use it
    bound_images images;
};

/// A foreign image or volume that is in our layout until the recording ends.
struct visitor {
    VkImage image = VK_NULL_HANDLE;
    VkImageAspectFlags aspect = 0;
    VkImageLayout layout_before = VK_IMAGE_LAYOUT_GENERAL;
    VkImageLayout layout_after = VK_IMAGE_LAYOUT_GENERAL;
    foreign_access before;
    foreign_access after;
};

inline constexpr std::uint32_t flag_counted = 1;
inline constexpr std::uint32_t flag_degenerate = 2;
inline constexpr std::uint32_t flag_neighbours = 4;

class stream {
  protected:
    stream(device_state& state, std::unique_ptr<recording> r, bool own)
        : state_(&state), recording_(std::move(r)), own_(own) {}
    stream(stream&& other) noexcept
        : state_(std::exchange(other.state_, nullptr)), recording_(std::move(other.recording_)),
          error_(std::move(other.error_)), own_(other.own_), barriers_(other.barriers_),
          before_(other.before_), after_(other.after_), visitors_(std::move(other.visitors_)) {}
    stream& operator=(stream&& other) noexcept {
        std::swap(state_, other.state_);
        std::swap(recording_, other.recording_);
        std::swap(error_, other.error_);
        std::swap(own_, other.own_);
        std::swap(barriers_, other.barriers_);
        std::swap(before_, other.before_);
        std::swap(after_, other.after_);
        std::swap(visitors_, other.visitors_);
        return *this;
    }
    ~stream() {
        if (state_) {
            state_->give_back(std::move(recording_));
        }
    }

    // ---- Errors and barriers

    [[nodiscard]] bool alive() {
        if (error_ || !recording_) {
            return false;
        }
        if (auto done = state_->shared.alive(); !done) {
            stop(done.error());
            return false;
        }
        return true;
    }

    void stop(error what) {
        if (!error_) {
            error_ = std::move(what);
        }
    }

    /// The zone and the label of a pattern, to the end of the scope.
    [[nodiscard]] pattern_scope enter(const char* name) const {
        return {state_->shared,
                recording_ && !error_ ? recording_->commands() : VkCommandBuffer{VK_NULL_HANDLE},
                name};
    }

    [[nodiscard]] const functions& call() const noexcept { return state_->shared.call; }
    [[nodiscard]] VkCommandBuffer commands() const noexcept { return recording_->commands(); }

    void memory_barrier(const foreign_access& before, const foreign_access& after) {
        auto memory = make<VkMemoryBarrier2>(VK_STRUCTURE_TYPE_MEMORY_BARRIER_2);
        memory.srcStageMask = before.stage;
        memory.srcAccessMask = before.access;
        memory.dstStageMask = after.stage;
        memory.dstAccessMask = after.access;
        auto info = make<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
        info.memoryBarrierCount = 1;
        info.pMemoryBarriers = &memory;
        call().barrier(commands(), &info);
    }

    /// What comes next sees all that came before.
    void barrier() {
        if (barriers_++ == 0 || !state_->shared.description.omit_barriers) {
            memory_barrier(before_, foreign_access{});
        }
        before_ = {};
    }

    static void add(foreign_access& to, const foreign_access& more) {
        to.stage |= more.stage;
        to.access |= more.access;
    }

    // ---- Views and images as Vulkan takes them

    [[nodiscard]] slice bound(const buffer_view<device>& view) {
        if (!view.buffer || view.size == 0) {
            return {};
        }
        assert(view.offset + view.size <= view.buffer->size_bytes());
        if (view.buffer->is_foreign()) {
            add(before_, view.buffer->foreign().before);
            add(after_, view.buffer->foreign().after);
        }
        return {view.buffer->handle(), view.offset, view.size};
    }

    template <std::size_t N>
    [[nodiscard]] compute_slices bound_all(const std::array<buffer_view<device>, N>& views) {
        compute_slices slices{};
        for (std::size_t i = 0; i < N; ++i) {
            slices[i] = bound(views[i]);
        }
        return slices;
    }

    void image_barrier(VkImage on, VkImageAspectFlags aspect, VkImageLayout from, VkImageLayout to,
                       const foreign_access& before, const foreign_access& after) {
        auto one = make<VkImageMemoryBarrier2>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2);
        one.srcStageMask = before.stage;
        one.srcAccessMask = before.access;
        one.dstStageMask = after.stage;
        one.dstAccessMask = after.access;
        one.oldLayout = from;
        one.newLayout = to;
        one.srcQueueFamilyIndex = one.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
        one.image = on;
        one.subresourceRange = {aspect, 0, 1, 0, 1};
        auto info = make<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
        info.imageMemoryBarrierCount = 1;
        info.pImageMemoryBarriers = &one;
        call().barrier(commands(), &info);
    }

    /// A foreign image's first use in this recording brings it into the layout that we work in.
    void use(const image& used) {
        if (used.is_foreign()) {
            bring({used.handle(), aspect_of(used.description().format),
                   used.foreign().layout_before, used.foreign().layout_after, used.foreign().before,
                   used.foreign().after});
        }
    }
    void use(const volume& used) {
        if (used.is_foreign()) {
            bring({used.handle(), VK_IMAGE_ASPECT_COLOR_BIT, used.foreign().layout_before,
                   used.foreign().layout_after, used.foreign().before, used.foreign().after});
        }
    }

    void bring(const visitor& one) {
        const auto same = [&](const visitor& v) { return v.image == one.image; };
        if (std::any_of(visitors_.begin(), visitors_.end(), same) || !alive()) {
            return;
        }
        visitors_.push_back(one);
        image_barrier(one.image, one.aspect, one.layout_before, VK_IMAGE_LAYOUT_GENERAL, one.before,
                      foreign_access{});
    }

    /// As one of the images of its kind that a program is given.
    void add_image(bound_images& to, const sampled_image<device>& one) {
        assert(one.image);
        use(*one.image);
        add(to, sampled_images, one.image->view(),
            one.image->filterable() ? one.filter : filter_mode::nearest, one.wrap);
    }
    void add_volume(bound_images& to, image_slot slot, const volume* one) {
        assert(one);
        use(*one);
        add(to, slot, one->view(), one->filterable() ? filter_mode::linear : filter_mode::nearest,
            wrap_mode::clamp);
    }

    void add(bound_images& to, image_slot slot, VkImageView view, filter_mode filter,
             wrap_mode wrap) {
        VkSampler sampler = VK_NULL_HANDLE;
        if (slot <= sampled_volumes) {
            auto made = state_->pipelines.sampler(filter, wrap);
            if (!made) {
                return stop(made.error());
            }
            sampler = *made;
        }
        std::uint32_t& count = to.shape.images[slot];
        to.infos[slot][count++] = {sampler, view, VK_IMAGE_LAYOUT_GENERAL};
    }

    // ---- Copies

    void copy_slice(const slice& from, const slice& to) {
        const VkBufferCopy region{from.offset, to.offset, std::min(from.size, to.size)};
        if (region.size != 0 && alive()) {
            barrier();
            call().copy_buffer(commands(), from.buffer, to.buffer, 1, &region);
        }
    }

    /// Rows [first, first + count) of an image and a buffer that holds just them.
    [[nodiscard]] static VkBufferImageCopy rows(const image& of, const slice& in,
                                                std::uint32_t first, std::uint32_t count) {
        VkBufferImageCopy region{};
        region.bufferOffset = in.offset;
        region.imageSubresource = {aspect_of(of.description().format), 0, 0, 1};
        region.imageOffset = {0, static_cast<std::int32_t>(first), 0};
        region.imageExtent = {of.description().width, count, 1};
        return region;
    }

    // ---- Compute

    [[nodiscard]] const slice& or_unused(const slice& s) const {
        return s.buffer != VK_NULL_HANDLE ? s : state_->shared.unused;
    }

    /// A set with these buffers at bindings 0, 1, …, and these images.
    [[nodiscard]] result<VkDescriptorSet> fill_set(const program_layout& layout,
                                                   std::span<const slice> buffers,
                                                   const bound_images& images) {
        auto set = recording_->take_set(layout);
        if (!set) {
            return set;
        }
        std::array<VkDescriptorBufferInfo, compute_bindings> infos{};
        for (std::size_t i = 0; i < buffers.size(); ++i) {
            const slice& s = or_unused(buffers[i]);
            infos[i] = {s.buffer, s.offset, s.size};
        }
        std::array<VkWriteDescriptorSet, 1 + image_slots> writes{};
        std::uint32_t used = 0;
        const auto write = [&](std::uint32_t binding, std::size_t count, VkDescriptorType type) {
            VkWriteDescriptorSet& w = writes[used++];
            w = make<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
            w.dstSet = *set;
            w.dstBinding = binding; // and goes on from binding to binding
            w.descriptorCount = static_cast<std::uint32_t>(count);
            w.descriptorType = type;
            return &w;
        };
        write(0, buffers.size(), VK_DESCRIPTOR_TYPE_STORAGE_BUFFER)->pBufferInfo = infos.data();
        for (std::uint32_t slot = 0; slot < image_slots; ++slot) {
            if (const std::uint32_t count = images.shape.images[slot]; count != 0) {
                write(images_binding + slot, count, descriptor_of(slot))->pImageInfo =
                    images.infos[slot].data();
            }
        }
        call().update_descriptor_sets(state_->shared.device(), used, writes.data(), 0, nullptr);
        return set;
    }

    void bind(VkPipelineBindPoint point, VkPipeline pipeline, const program_layout& layout,
              VkDescriptorSet set, const push_block& push) {
        call().bind_pipeline(commands(), point, pipeline);
        call().bind_descriptor_sets(commands(), point, layout.pipeline, 0, 1, &set, 0, nullptr);
        call().push_constants(commands(), layout.pipeline, layout.shape.stages(), 0, push.size,
                              push.bytes.data());
    }

    /// All but the dispatch itself.
    [[nodiscard]] bool prepare(const compute_call& what) {
        if (!alive()) {
            return false;
        }
        auto pipeline = state_->pipelines.compute(what.words, what.images.shape, what.name);
        if (!pipeline) {
            stop(pipeline.error());
            return false;
        }
        auto layout = state_->pipelines.layout(what.images.shape);
        if (!layout) {
            stop(layout.error());
            return false;
        }
        auto set = fill_set(**layout, what.buffers, what.images);
        if (!set) {
            stop(set.error());
            return false;
        }
        barrier();
        bind(VK_PIPELINE_BIND_POINT_COMPUTE, *pipeline, **layout, *set, what.push);
        return true;
    }

    /// More groups than one dimension takes go into the second; the spare ones find nothing to do.
    void dispatch(const compute_call& what, std::uint32_t groups) {
        if (groups != 0 && prepare(what)) {
            const std::uint32_t rows = (groups - 1) / 65535 + 1;
            call().dispatch(commands(), (groups - 1) / rows + 1, rows, 1);
        }
    }

    /// One group for each place of a box; no side is more than 65,535.
    void dispatch(const compute_call& what, glm::uvec3 groups) {
        if (groups.x != 0 && groups.y != 0 && groups.z != 0 && prepare(what)) {
            call().dispatch(commands(), groups.x, groups.y, groups.z);
        }
    }

    void dispatch_indirect(const compute_call& what, const slice& arguments) {
        if (prepare(what)) {
            call().dispatch_indirect(commands(), arguments.buffer, arguments.offset);
        }
    }

    /// A slice of scratch memory; stops the recorder where there is none.
    [[nodiscard]] slice scratch(VkDeviceSize size) {
        if (!alive()) {
            return {};
        }
        auto piece = recording_->scratch.take(size);
        if (!piece) {
            stop(piece.error());
            return {};
        }
        return piece->where;
    }

    /// Arguments for a dispatch over as many elements as `length` says.
    [[nodiscard]] slice arguments_for(const slice& length, std::uint32_t limit, std::uint32_t side,
                                      std::uint32_t groups) {
        const slice arguments = scratch(sizeof(VkDispatchIndirectCommand));
        compute_call prepare_arguments{dispatch_arguments_comp, "dispatch arguments", {}, {}, {}};
        prepare_arguments.push.set_header({0, limit, side, groups});
        prepare_arguments.buffers[vertices_binding] = arguments;
        prepare_arguments.buffers[length_binding] = length;
        dispatch(prepare_arguments, 1);
        return arguments;
    }

    [[nodiscard]] static std::uint32_t groups_of(std::uint32_t count, std::uint32_t size) {
        return static_cast<std::uint32_t>((std::uint64_t{count} + size - 1) / size);
    }

    // ---- The end

    /// Results become visible to the host and to whatever the queue does next.
    void close() {
        if (!alive()) {
            return;
        }
        foreign_access after = after_;
        add(after, {VK_PIPELINE_STAGE_2_HOST_BIT, 0});
        memory_barrier(before_, after);
        for (const visitor& one : visitors_) {
            image_barrier(one.image, one.aspect, VK_IMAGE_LAYOUT_GENERAL, one.layout_after,
                          foreign_access{}, one.after);
        }
    }

    /// Gives the recording away, and the first error or nothing.
    [[nodiscard]] std::unique_ptr<recording> take_recording() {
        visitors_.clear();
        return std::move(recording_);
    }

    device_state* state_ = nullptr;
    std::unique_ptr<recording> recording_;
    std::optional<error> error_;
    bool own_ = true; ///< the command buffer is ours
    std::uint64_t barriers_ = 0;
    foreign_access before_;         ///< what the next barrier waits for
    foreign_access after_;          ///< what the last barrier holds back
    std::vector<visitor> visitors_; ///< what the end sends back into its own layout
};

} // namespace skybark::vulkan::detail
