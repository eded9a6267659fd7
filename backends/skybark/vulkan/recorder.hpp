#pragma once
// The recorder: appends patterns to a command buffer. See skybark/core/backend.hpp for what they
// mean and device.hpp for whose command buffer it is.
//
// Between any two of its commands stands a barrier over all memory: patterns depend on each other
// nearly always, and on one queue a finer barrier would gain little.

#include <skybark/vulkan/device.hpp>
#include <skybark/vulkan/program.hpp>
#include <skybark/vulkan/programs/own_count.hpp>
#include <skybark/vulkan/programs/own_dispatch_arguments.hpp>
#include <skybark/vulkan/programs/own_draw_arguments.hpp>
#include <skybark/vulkan/programs/own_scan.hpp>
#include <skybark/vulkan/programs/own_scan_add.hpp>

#include <optional>

namespace skybark::vulkan {

/// The programs that patterns need. shaders/embed.py makes them for the kernels that we ship; your
/// own kernel brings a specialisation of `program` of its own.
template <class K>
concept has_map_program = requires {
    program<K>::map_comp;
    program<K>::levels_comp;
};
template <class K>
concept has_strip_program = requires {
    program<K>::strips_comp;
    program<K>::strip_counts_comp;
};
template <class K>
concept has_ring_program = requires {
    program<K>::rings_comp;
};
template <class K>
concept has_draw_program = requires {
    program<K>::draw_vert;
    program<K>::draw_frag;
};

namespace detail {

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

/// A compute program and what it is given; recorded by `recorder::dispatch`.
struct compute_call {
    spirv_words words;
    const char* name = "";
    push_block push;
    compute_slices buffers{}; ///< null: the program does not use it
};

/// An expansion into a list, its types forgotten.
struct list_call {
    spirv_words count;
    spirv_words emit;
    push_block push;
    compute_slices buffers{};
    range elements;
    slice length; ///< a count_record that limits the elements, or null
    slice vertices;
    slice record; ///< where {written, required} go
    padding policy = padding::compact;
    std::uint32_t strips = 0;
    std::uint32_t strip_triangles = 0;
    std::uint32_t triangle_bytes = 0;
};

/// How an expansion falls on invocations.
struct work_plan {
    std::uint32_t part = 0;   ///< vertices or triangles an invocation
    std::uint32_t works = 0;  ///< invocations an element
    std::uint32_t flags = 0;  ///< bit 2: an element's invocations are neighbours
    std::uint32_t most = 0;   ///< elements a dispatch, a multiple of 64
    std::uint32_t side = 0;   ///< invocations an element side by side …
    std::uint32_t groups = 0; ///< … and groups for every 64 of those

    [[nodiscard]] std::uint32_t groups_for(std::uint32_t elements) const {
        return static_cast<std::uint32_t>((std::uint64_t{elements} * side + 63) / 64 * groups);
    }
};

/// A draw, its types forgotten.
struct draw_call {
    draw_program program;
    push_block push;
    std::array<slice, max_kernel_buffers> buffers{};
    slice indices;
    slice length;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    std::uint32_t base_vertex = 0;
};

inline constexpr std::uint32_t flag_counted = 1;
inline constexpr std::uint32_t flag_degenerate = 2;
inline constexpr std::uint32_t flag_neighbours = 4;

} // namespace detail

class recorder {
  public:
    recorder(recorder&& other) noexcept
        : state_(std::exchange(other.state_, nullptr)), recording_(std::move(other.recording_)),
          error_(std::move(other.error_)), own_(other.own_), barriers_(other.barriers_),
          before_(other.before_), after_(other.after_), images_(std::move(other.images_)),
          image_infos_(std::move(other.image_infos_)) {}
    recorder& operator=(recorder&& other) noexcept {
        std::swap(state_, other.state_);
        std::swap(recording_, other.recording_);
        std::swap(error_, other.error_);
        std::swap(own_, other.own_);
        std::swap(barriers_, other.barriers_);
        std::swap(before_, other.before_);
        std::swap(after_, other.after_);
        std::swap(images_, other.images_);
        std::swap(image_infos_, other.image_infos_);
        return *this;
    }
    ~recorder() {
        if (state_) {
            state_->give_back(std::move(recording_));
        }
    }

    /// The bytes are copied before the call returns.
    void upload(const buffer_view<device>& to, std::span<const std::byte> bytes) {
        const slice target = bound(to);
        assert(bytes.size() <= target.size);
        if (bytes.empty() || !alive()) {
            return;
        }
        auto staged = recording_->staging.take(bytes.size());
        if (!staged) {
            return stop(staged.error());
        }
        std::memcpy(staged->mapped, bytes.data(), bytes.size());
        state_->shared.traffic.up += bytes.size();
        copy(staged->where, {target.buffer, target.offset, bytes.size()});
    }

    /// As many bytes as the smaller of the two has.
    void copy(const buffer_view<device>& from, const buffer_view<device>& to) {
        copy(bound(from), bound(to));
    }

    template <map_kernel K>
    requires has_map_program<K>
    void map(const K& kernel, const bindings<device, K>& buffers, range elements) {
        map_range(map_call(kernel, buffers), elements);
    }

    /// Runs of small ranges share one workgroup and one dispatch.
    template <map_kernel K>
    requires has_map_program<K>
    void map(const K& kernel, const bindings<device, K>& buffers,
             std::span<const range> consecutive) {
        detail::compute_call levels = map_call(kernel, buffers);
        levels.words = program<K>::levels_comp;
        map_ranges(map_call(kernel, buffers), levels, consecutive);
    }

    template <map_kernel K>
    requires has_map_program<K>
    void map(const K& kernel, const bindings<device, K>& buffers, const counted<device>& elements) {
        map_counted(map_call(kernel, buffers), bound(elements.count), elements.limit);
    }

    template <strip_kernel K>
    requires has_strip_program<K>
    void expand(const K& kernel, const bindings<device, K>& buffers, range elements,
                const triangle_list<device>& out) {
        detail::list_call call = list_call(kernel, buffers, out);
        call.elements = elements;
        expand_list(call);
    }

    template <strip_kernel K>
    requires has_strip_program<K>
    void expand(const K& kernel, const bindings<device, K>& buffers,
                const counted<device>& elements, const triangle_list<device>& out) {
        detail::list_call call = list_call(kernel, buffers, out);
        call.elements = {0, elements.limit};
        call.length = bound(elements.count);
        expand_list(call);
    }

    /// Elements that do not fit as a whole are left out.
    template <ring_kernel K>
    requires has_ring_program<K>
    void expand_rings(const K& kernel, const bindings<device, K>& buffers, range elements,
                      const buffer_view<device>& vertices) {
        detail::compute_call call{program<K>::rings_comp, "skybark: rings", detail::push_of(kernel),
                                  bound_all(buffers)};
        expand_rings(call, elements, kernel.ring_vertices(), sizeof(typename K::vertex),
                     bound(vertices));
    }

    template <draw_kernel K>
    requires has_draw_program<K>
    void draw(const K& kernel, const bindings<device, K>& buffers,
              const image_bindings<device, K>& images, const draw_geometry<device>& geometry,
              const draw_target<device>& target, draw_state state) {
        detail::draw_call call;
        call.program.vertex = program<K>::draw_vert;
        call.program.fragment = program<K>::draw_frag;
        call.program.images = static_cast<std::uint32_t>(images.size());
        call.program.state = state;
        call.push = detail::push_of(kernel);
        for (std::size_t i = 0; i < buffers.size(); ++i) {
            call.buffers[i] = bound(buffers[i]);
        }
        call.indices = bound(geometry.indices);
        call.length = bound(geometry.length);
        call.first = geometry.first;
        call.count = geometry.count;
        call.base_vertex = geometry.base_vertex;
        draw(call, images, target);
    }

    /// Beyond the contract: the running sum of 32-bit words, each word's own value left out, in
    /// place; the sum of all goes to the first word of `total`. Sums stop at 2^32 − 1.
    void scan(const buffer_view<device>& words, const buffer_view<device>& total) {
        const slice values = bound(words);
        scan(values, static_cast<std::uint32_t>(values.size / 4), bound(total));
    }

  private:
    friend class device;

    recorder(detail::device_state& state, std::unique_ptr<detail::recording> r, bool own)
        : state_(&state), recording_(std::move(r)), own_(own) {}

    /// Below this many elements an indirect dispatch isn't worth the one that prepares it.
    static constexpr std::uint32_t direct_limit = 16384;
    /// A range up to this size may share its workgroup with other ranges.
    static constexpr std::uint32_t small_range = 4096;
    /// Turns of the loop in levels.comp; software rasterisers end a shader's loops after 65,535.
    static constexpr std::uint32_t most_turns = 16384;

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
    [[nodiscard]] detail::compute_slices
    bound_all(const std::array<buffer_view<device>, N>& views) {
        detail::compute_slices slices{};
        for (std::size_t i = 0; i < N; ++i) {
            slices[i] = bound(views[i]);
        }
        return slices;
    }

    void image_barrier(const image& on, VkImageLayout from, VkImageLayout to,
                       const foreign_access& before, const foreign_access& after) {
        auto one = make<VkImageMemoryBarrier2>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2);
        one.srcStageMask = before.stage;
        one.srcAccessMask = before.access;
        one.dstStageMask = after.stage;
        one.dstAccessMask = after.access;
        one.oldLayout = from;
        one.newLayout = to;
        one.srcQueueFamilyIndex = one.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
        one.image = on.handle();
        one.subresourceRange = {aspect_of(on.description().format), 0, 1, 0, 1};
        auto info = make<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
        info.imageMemoryBarrierCount = 1;
        info.pImageMemoryBarriers = &one;
        call().barrier(commands(), &info);
    }

    /// A foreign image's first use in this recording brings it into the layout that we work in.
    void use(const image* used) {
        if (!used || !used->is_foreign() ||
            std::find(images_.begin(), images_.end(), used) != images_.end()) {
            return;
        }
        images_.push_back(used);
        image_barrier(*used, used->foreign().layout_before, VK_IMAGE_LAYOUT_GENERAL,
                      used->foreign().before, foreign_access{});
    }

    // ---- Copies

    void copy(const slice& from, const slice& to) {
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
                                                   std::span<const VkDescriptorImageInfo> images) {
        auto set = recording_->take_set(layout);
        if (!set) {
            return set;
        }
        std::array<VkDescriptorBufferInfo, compute_bindings> infos{};
        for (std::size_t i = 0; i < buffers.size(); ++i) {
            const slice& s = or_unused(buffers[i]);
            infos[i] = {s.buffer, s.offset, s.size};
        }
        std::array writes{make<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET),
                          make<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET)};
        writes[0].dstSet = *set; // goes on from binding to binding
        writes[0].descriptorCount = static_cast<std::uint32_t>(buffers.size());
        writes[0].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        writes[0].pBufferInfo = infos.data();
        writes[1].dstSet = *set;
        writes[1].dstBinding = images_binding;
        writes[1].descriptorCount = static_cast<std::uint32_t>(images.size());
        writes[1].descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
        writes[1].pImageInfo = images.data();
        call().update_descriptor_sets(state_->shared.device(), images.empty() ? 1 : 2,
                                      writes.data(), 0, nullptr);
        return set;
    }

    void bind(VkPipelineBindPoint point, VkPipeline pipeline, const program_layout& layout,
              VkDescriptorSet set, const detail::push_block& push) {
        call().bind_pipeline(commands(), point, pipeline);
        call().bind_descriptor_sets(commands(), point, layout.pipeline, 0, 1, &set, 0, nullptr);
        call().push_constants(commands(), layout.pipeline, layout.stages, 0, push.size,
                              push.bytes.data());
    }

    /// All but the dispatch itself.
    [[nodiscard]] bool prepare(const detail::compute_call& what) {
        if (!alive()) {
            return false;
        }
        auto pipeline = state_->pipelines.compute(what.words, what.name);
        if (!pipeline) {
            stop(pipeline.error());
            return false;
        }
        auto layout = state_->pipelines.compute_layout();
        if (!layout) {
            stop(layout.error());
            return false;
        }
        auto set = fill_set(**layout, what.buffers, {});
        if (!set) {
            stop(set.error());
            return false;
        }
        barrier();
        bind(VK_PIPELINE_BIND_POINT_COMPUTE, *pipeline, **layout, *set, what.push);
        return true;
    }

    /// More groups than one dimension takes go into the second; the spare ones find nothing to do.
    void dispatch(const detail::compute_call& what, std::uint32_t groups) {
        if (groups != 0 && prepare(what)) {
            const std::uint32_t rows = (groups - 1) / 65535 + 1;
            call().dispatch(commands(), (groups - 1) / rows + 1, rows, 1);
        }
    }

    void dispatch_indirect(const detail::compute_call& what, const slice& arguments) {
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
        detail::compute_call prepare_arguments{
            dispatch_arguments_comp, "skybark: dispatch arguments", {}, {}};
        prepare_arguments.push.set_header({0, limit, side, groups});
        prepare_arguments.buffers[vertices_binding] = arguments;
        prepare_arguments.buffers[length_binding] = length;
        dispatch(prepare_arguments, 1);
        return arguments;
    }

    // ---- map

    template <class K>
    [[nodiscard]] detail::compute_call map_call(const K& kernel,
                                                const bindings<device, K>& buffers) {
        return {program<K>::map_comp, "skybark: map", detail::push_of(kernel), bound_all(buffers)};
    }

    void map_range(detail::compute_call what, range elements) {
        what.push.set_header({elements.first, elements.count, 0, 0});
        dispatch(what, groups_of(elements.count, 64));
    }

    [[nodiscard]] static std::uint32_t groups_of(std::uint32_t count, std::uint32_t size) {
        return static_cast<std::uint32_t>((std::uint64_t{count} + size - 1) / size);
    }

    void map_counted(detail::compute_call what, const slice& length, std::uint32_t limit) {
        what.push.set_header({0, limit, 0, detail::flag_counted});
        what.buffers[length_binding] = length;
        if (limit <= direct_limit) {
            return dispatch(what, groups_of(limit, 64));
        }
        dispatch_indirect(what, arguments_for(length, limit, 1, 1));
    }

    void map_ranges(const detail::compute_call& one, const detail::compute_call& levels,
                    std::span<const range> ranges) {
        while (!ranges.empty()) {
            const std::size_t run = small_run(ranges);
            if (run < 2) {
                map_range(one, ranges.front());
                ranges = ranges.subspan(1);
            } else {
                map_run(levels, ranges.first(run));
                ranges = ranges.subspan(run);
            }
        }
    }

    /// How many ranges from the first on may share a workgroup.
    [[nodiscard]] static std::size_t small_run(std::span<const range> ranges) {
        std::size_t run = 0;
        std::uint32_t turns = 0;
        while (run < ranges.size() && ranges[run].count <= small_range) {
            turns += 1 + groups_of(ranges[run].count, 256);
            if (turns > most_turns) {
                break;
            }
            ++run;
        }
        return run;
    }

    void map_run(detail::compute_call levels, std::span<const range> ranges) {
        if (!alive()) {
            return;
        }
        auto staged = recording_->staging.take(ranges.size_bytes());
        if (!staged) {
            return stop(staged.error());
        }
        std::memcpy(staged->mapped, ranges.data(), ranges.size_bytes());
        state_->shared.traffic.up += ranges.size_bytes();
        levels.push.set_header({0, static_cast<std::uint32_t>(ranges.size()), 0, 0});
        levels.buffers[ranges_binding] = staged->where;
        dispatch(levels, 1);
    }

    // ---- scan

    void scan(const slice& values, std::uint32_t count, const slice& total) {
        constexpr std::uint32_t block = 4096;
        const std::uint32_t blocks = std::max(1u, groups_of(count, block));
        const slice sums = blocks == 1 ? total : scratch(std::uint64_t{blocks} * 4);
        detail::compute_call pass{scan_comp, "skybark: scan", {}, {}};
        pass.push.set_header({0, count, 0, 0});
        pass.buffers[vertices_binding] = values;
        pass.buffers[offsets_binding] = values;
        pass.buffers[length_binding] = sums;
        dispatch(pass, blocks);
        if (blocks > 1) {
            scan(sums, blocks, total);
            pass.words = scan_add_comp;
            pass.name = "skybark: scan, sums of blocks";
            dispatch(pass, groups_of(count, 256));
        }
    }

    // ---- expand

    template <class K>
    [[nodiscard]] detail::list_call list_call(const K& kernel, const bindings<device, K>& buffers,
                                              const triangle_list<device>& out) {
        detail::list_call call;
        call.count = program<K>::strip_counts_comp;
        call.emit = program<K>::strips_comp;
        call.push = detail::push_of(kernel);
        call.buffers = bound_all(buffers);
        call.vertices = bound(out.vertices);
        call.record = bound(out.count);
        call.policy = out.policy;
        call.strips = kernel.strips();
        call.strip_triangles = kernel.strip_triangles();
        call.triangle_bytes = 3 * sizeof(typename K::vertex);
        return call;
    }

    /// A part has at most `most` of the `each` things that each of an element's `runs` has.
    [[nodiscard]] detail::work_plan plan(std::uint32_t runs, std::uint32_t each,
                                         std::uint32_t most_on_cpu, std::uint32_t most_on_gpu) {
        const bool neighbours = state_->shared.per_vertices();
        detail::work_plan p;
        p.part = neighbours ? most_on_gpu : most_on_cpu;
        p.works = runs * ((each + p.part - 1) / p.part);
        p.flags = neighbours ? detail::flag_neighbours : 0;
        p.side = neighbours ? p.works : 1;
        p.groups = neighbours ? 1 : p.works;
        p.most = std::max(64u, (1u << 31) / std::max(1u, p.works) / 64 * 64);
        return p;
    }

    void expand_rings(detail::compute_call what, range elements, std::uint32_t ring_vertices,
                      std::size_t vertex_bytes, const slice& out) {
        const std::uint64_t element_bytes = std::uint64_t{ring_vertices} * vertex_bytes;
        if (element_bytes == 0) {
            return;
        }
        const auto count = static_cast<std::uint32_t>(
            std::min<std::uint64_t>(elements.count, out.size / element_bytes));
        const detail::work_plan p = plan(1, ring_vertices, 2048, 4);
        for (std::uint32_t first = 0; first < count;) {
            const std::uint32_t n = std::min(count - first, p.most);
            what.push.set_header({elements.first + first, n, p.part, p.flags});
            what.buffers[vertices_binding] = {out.buffer, out.offset + first * element_bytes,
                                              n * element_bytes};
            dispatch(what, p.groups_for(n));
            first += n;
        }
    }

    void expand_list(const detail::list_call& what) {
        const std::uint64_t fit = what.vertices.size / what.triangle_bytes;
        const std::uint64_t each = std::uint64_t{what.strips} * what.strip_triangles;
        assert(each < 1u << 31);
        slice total;
        if (each == 0) {
            write_record(what, fit, {}); // no triangles at all, in one padding as in the other
        } else if (what.policy == padding::degenerate) {
            const auto count = static_cast<std::uint32_t>(
                std::min<std::uint64_t>(what.elements.count, (fit + each - 1) / each));
            emit(what, count, each, {});
            write_record(what, fit, {});
        } else {
            const std::uint32_t count = what.elements.count;
            const slice offsets = scratch(std::max<std::uint64_t>(4, std::uint64_t{count} * 4));
            total = scratch(4);
            count_triangles(what, offsets);
            scan(offsets, count, total);
            if (fit != 0) {
                emit(what, count, each, offsets);
            }
            write_record(what, fit, total);
        }
    }

    /// Each element's number of triangles.
    void count_triangles(const detail::list_call& what, const slice& counts) {
        detail::compute_call pass{what.count, "skybark: strip counts", what.push, what.buffers};
        pass.push.set_header({what.elements.first, what.elements.count, 0, counted_flag(what)});
        pass.buffers[offsets_binding] = counts;
        pass.buffers[length_binding] = what.length;
        dispatch(pass, groups_of(what.elements.count, 64));
    }

    [[nodiscard]] static std::uint32_t counted_flag(const detail::list_call& what) {
        return what.length.buffer != VK_NULL_HANDLE ? detail::flag_counted : 0;
    }

    /// The triangles of the first `count` elements: at `offsets`, or `each` an element.
    void emit(const detail::list_call& what, std::uint32_t count, std::uint64_t each,
              const slice& offsets) {
        const bool degenerate = what.policy == padding::degenerate;
        const detail::work_plan p = plan(what.strips, what.strip_triangles, 512, 2);
        detail::compute_call pass{what.emit, "skybark: strips", what.push, what.buffers};
        pass.buffers[length_binding] = what.length;
        const std::uint32_t flags =
            p.flags | counted_flag(what) | (degenerate ? detail::flag_degenerate : 0);
        // Where the caller's limit is far above what there is, only what there is should run.
        const bool indirect = counted_flag(what) != 0 && count > direct_limit && count <= p.most;
        const slice arguments =
            indirect ? arguments_for(what.length, count, p.side, p.groups) : slice{};
        for (std::uint32_t first = 0; first < count;) {
            const std::uint32_t n = std::min(count - first, p.most);
            const std::uint64_t skip = degenerate ? first * each * what.triangle_bytes : 0;
            pass.push.set_header({what.elements.first + first, n, p.part, flags});
            pass.buffers[vertices_binding] = {what.vertices.buffer, what.vertices.offset + skip,
                                              what.vertices.size - skip};
            if (!degenerate) {
                pass.buffers[offsets_binding] = {offsets.buffer,
                                                 offsets.offset + std::uint64_t{first} * 4,
                                                 std::uint64_t{n} * 4};
            }
            if (indirect) {
                dispatch_indirect(pass, arguments);
            } else {
                dispatch(pass, p.groups_for(n));
            }
            first += n;
        }
    }

    /// {written, required}; last of all, as the length may lie in the same record.
    void write_record(const detail::list_call& what, std::uint64_t fit, const slice& total) {
        const std::uint32_t degenerate =
            total.buffer == VK_NULL_HANDLE ? detail::flag_degenerate : 0;
        detail::compute_call pass{count_comp, "skybark: count", {}, {}};
        pass.push.set_header({static_cast<std::uint32_t>(std::min<std::uint64_t>(fit, ~0u)),
                              what.elements.count, what.strips * what.strip_triangles,
                              degenerate | counted_flag(what)});
        pass.buffers[vertices_binding] = what.record;
        pass.buffers[offsets_binding] = total;
        pass.buffers[length_binding] = what.length;
        dispatch(pass, 1);
    }

    // ---- draw

    void draw(detail::draw_call& what, std::span<const sampled_image<device>> images,
              const draw_target<device>& target) {
        assert(target.color || target.depth);
        if (!alive()) {
            return;
        }
        what.program.color = target.color ? target.color->format() : VK_FORMAT_UNDEFINED;
        what.program.depth = target.depth ? target.depth->format() : VK_FORMAT_UNDEFINED;
        image_infos_.clear();
        for (const sampled_image<device>& one : images) {
            add_image(one);
        }
        if (!alive()) {
            return;
        }
        auto pipeline = state_->pipelines.draw(what.program, "skybark: draw");
        if (!pipeline) {
            return stop(pipeline.error());
        }
        auto layout = state_->pipelines.draw_layout(what.program.images);
        if (!layout) {
            return stop(layout.error());
        }
        auto set = fill_set(**layout, what.buffers, image_infos_);
        if (!set) {
            return stop(set.error());
        }
        const slice arguments = draw_arguments(what);
        if (!alive()) {
            return;
        }
        barrier();
        for (const sampled_image<device>& one : images) {
            use(one.image);
        }
        use(target.color);
        use(target.depth);
        begin_rendering(target);
        bind(VK_PIPELINE_BIND_POINT_GRAPHICS, *pipeline, **layout, *set, what.push);
        issue(what, arguments);
        call().end_rendering(commands());
    }

    void add_image(const sampled_image<device>& one) {
        assert(one.image);
        auto sampler = state_->pipelines.sampler(
            one.image->filterable() ? one.filter : filter_mode::nearest, one.wrap);
        if (!sampler) {
            return stop(sampler.error());
        }
        image_infos_.push_back({*sampler, one.image->view(), VK_IMAGE_LAYOUT_GENERAL});
    }

    /// Indirect arguments, where the number of triangles is on the device.
    [[nodiscard]] slice draw_arguments(const detail::draw_call& what) {
        if (what.length.buffer == VK_NULL_HANDLE) {
            return {};
        }
        const bool indexed = what.indices.buffer != VK_NULL_HANDLE;
        const std::uint64_t indices = what.indices.size / 4;
        const std::uint64_t most = !indexed ? ~0u : indices > what.first ? indices - what.first : 0;
        const slice arguments = scratch(sizeof(VkDrawIndexedIndirectCommand));
        detail::compute_call pass{draw_arguments_comp, "skybark: draw arguments", {}, {}};
        pass.push.set_header({what.first + first_index(what), what.base_vertex,
                              static_cast<std::uint32_t>(std::min<std::uint64_t>(most, ~0u)),
                              indexed ? 1u : 0u});
        pass.buffers[vertices_binding] = arguments;
        pass.buffers[length_binding] = what.length;
        dispatch(pass, 1);
        return arguments;
    }

    [[nodiscard]] static VkRenderingAttachmentInfo attachment(const image& on, bool clear) {
        auto info = make<VkRenderingAttachmentInfo>(VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO);
        info.imageView = on.view();
        info.imageLayout = VK_IMAGE_LAYOUT_GENERAL;
        info.loadOp = clear ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD;
        info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
        return info;
    }

    void begin_rendering(const draw_target<device>& target) {
        VkRenderingAttachmentInfo color{};
        VkRenderingAttachmentInfo depth{};
        auto info = make<VkRenderingInfo>(VK_STRUCTURE_TYPE_RENDERING_INFO);
        const image_description size = (target.color ? target.color : target.depth)->description();
        info.renderArea = {{0, 0}, {size.width, size.height}};
        info.layerCount = 1;
        if (target.color) {
            color = attachment(*target.color, target.clear_color.has_value());
            const glm::vec4 c = target.clear_color.value_or(glm::vec4{0});
            color.clearValue.color = {{c.x, c.y, c.z, c.w}};
            info.colorAttachmentCount = 1;
            info.pColorAttachments = &color;
        }
        if (target.depth) {
            depth = attachment(*target.depth, target.clear_depth.has_value());
            depth.clearValue.depthStencil = {target.clear_depth.value_or(1.0f), 0};
            info.pDepthAttachment = &depth;
        }
        call().begin_rendering(commands(), &info);
        // Clip space has y up and row 0 is the top: the height is negative.
        const auto height = static_cast<float>(size.height);
        const VkViewport viewport{0, height, static_cast<float>(size.width), -height, 0, 1};
        call().set_viewport(commands(), 0, 1, &viewport);
        call().set_scissor(commands(), 0, 1, &info.renderArea);
    }

    /// Where the indices start in their buffer. It is bound from its start on: lavapipe's indirect
    /// draws forget the offset of an index buffer.
    [[nodiscard]] static std::uint32_t first_index(const detail::draw_call& what) {
        return static_cast<std::uint32_t>(what.indices.offset / 4);
    }

    void issue(const detail::draw_call& what, const slice& arguments) {
        const bool indexed = what.indices.buffer != VK_NULL_HANDLE;
        const bool indirect = arguments.buffer != VK_NULL_HANDLE;
        if (indexed) {
            call().bind_index_buffer(commands(), what.indices.buffer, 0, VK_INDEX_TYPE_UINT32);
        }
        if (indexed && indirect) {
            call().draw_indexed_indirect(commands(), arguments.buffer, arguments.offset, 1, 0);
        } else if (indirect) {
            call().draw_indirect(commands(), arguments.buffer, arguments.offset, 1, 0);
        } else if (indexed) {
            call().draw_indexed(commands(), what.count, 1, what.first + first_index(what),
                                static_cast<std::int32_t>(what.base_vertex), 0);
        } else {
            call().draw(commands(), what.count, 1, what.first + what.base_vertex, 0);
        }
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
        for (const image* used : images_) {
            image_barrier(*used, VK_IMAGE_LAYOUT_GENERAL, used->foreign().layout_after,
                          foreign_access{}, used->foreign().after);
        }
    }

    /// Gives the recording away, and the first error or nothing.
    [[nodiscard]] std::unique_ptr<detail::recording> take_recording() {
        images_.clear();
        return std::move(recording_);
    }

    detail::device_state* state_ = nullptr;
    std::unique_ptr<detail::recording> recording_;
    std::optional<error> error_;
    bool own_ = true; ///< the command buffer is ours
    std::uint64_t barriers_ = 0;
    foreign_access before_;            ///< what the next barrier waits for
    foreign_access after_;             ///< what the last barrier holds back
    std::vector<const image*> images_; ///< foreign ones that were brought into our layout
    std::vector<VkDescriptorImageInfo> image_infos_;
};

} // namespace skybark::vulkan
