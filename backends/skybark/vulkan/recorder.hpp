#pragma once
// The recorder: appends patterns to a command buffer. See skybark/core/backend.hpp for what they
// mean and device.hpp for whose command buffer it is.

#include <skybark/vulkan/program.hpp>
#include <skybark/vulkan/programs/own_count.hpp>
#include <skybark/vulkan/programs/own_draw_arguments.hpp>
#include <skybark/vulkan/programs/own_peel.hpp>
#include <skybark/vulkan/programs/own_peeled.hpp>
#include <skybark/vulkan/programs/own_scan.hpp>
#include <skybark/vulkan/programs/own_scan_add.hpp>
#include <skybark/vulkan/programs/own_scan_float32_float16.hpp>
#include <skybark/vulkan/programs/own_scan_float32_float32.hpp>
#include <skybark/vulkan/programs/own_scan_int32_float16.hpp>
#include <skybark/vulkan/programs/own_scan_int32_float32.hpp>
#include <skybark/vulkan/programs/own_scan_int32_int32.hpp>
#include <skybark/vulkan/programs/own_sort_count.hpp>
#include <skybark/vulkan/programs/own_sort_scatter.hpp>
#include <skybark/vulkan/stream.hpp>

#include <bit>

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
concept has_slab_program = requires {
    program<K>::accumulate_comp;
};
template <class K>
concept has_voxel_program = requires {
    program<K>::voxels_comp;
};
template <class K>
concept has_draw_program = requires {
    program<K>::draw_vert;
    program<K>::draw_frag;
};
template <class K>
concept has_peel_program = requires {
    program<K>::peel_vert;
};

namespace detail {

/// An expansion into a list, its types forgotten.
struct list_call {
    const char* name = "";
    spirv_words count;
    spirv_words write;
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

/// An accumulation, its types forgotten.
struct slab_call {
    compute_call pass;
    range elements;
    slice length; ///< a count_record that limits the elements, or null
    std::uint32_t slabs = 0;
};

/// Of an accumulation's header: a slab's memory is read before it is added to.
inline constexpr std::uint32_t flag_fetch = 2;

/// How an accumulation falls on invocations: see accumulate.comp.
struct slab_plan {
    std::uint32_t lanes = 0;   ///< columns side by side
    std::uint32_t sharing = 1; ///< groups that share a slab
    std::uint32_t each = 0;    ///< slabs a group
    std::uint32_t flags = 0;
};

/// Where pairs to sort are, or go.
struct pair_slices {
    slice keys;
    slice values;
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
    const char* name = "";
    draw_program program;
    push_block push;
    std::array<slice, max_kernel_buffers> buffers{};
    bound_images images;
    slice indices;
    slice length;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    std::uint32_t base_vertex = 0;
};

struct bundle_lists; // of resolve.hpp
struct bundle_parameters;

/// A peel, its types forgotten.
struct peel_call {
    const char* name = "";
    spirv_words vertex;
    push_block push;
    std::array<slice, max_kernel_buffers + 1> buffers{}; ///< and the depths of the last layer
    range triangles;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    slice depth;
    slice numbers;
    slice count;
};

} // namespace detail

class recorder : private detail::stream {
  public:
    /// The bytes are copied before the call returns.
    void upload(const buffer_view<device>& to, std::span<const std::byte> bytes) {
        const auto here = enter("upload");
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
        copy_slice(staged->where, {target.buffer, target.offset, bytes.size()});
    }

    /// As many bytes as the smaller of the two has.
    void copy(const buffer_view<device>& from, const buffer_view<device>& to) {
        const auto here = enter("copy");
        copy_slice(bound(from), bound(to));
    }

    template <map_kernel K>
    requires has_map_program<K>
    void map(const K& kernel, const bindings<device, K>& buffers, range elements) {
        const auto here = enter(zone_name<pattern::map, K>());
        map_range(map_call(kernel, buffers), elements);
    }

    /// Runs of small ranges share one workgroup and one dispatch.
    template <map_kernel K>
    requires has_map_program<K>
    void map(const K& kernel, const bindings<device, K>& buffers,
             std::span<const range> consecutive) {
        const auto here = enter(zone_name<pattern::map, K>());
        detail::compute_call levels = map_call(kernel, buffers);
        levels.words = program<K>::levels_comp;
        map_ranges(map_call(kernel, buffers), levels, consecutive);
    }

    template <map_kernel K>
    requires has_map_program<K>
    void map(const K& kernel, const bindings<device, K>& buffers, const counted<device>& elements) {
        const auto here = enter(zone_name<pattern::map, K>());
        map_counted(map_call(kernel, buffers), bound(elements.count), elements.limit);
    }

    template <strip_kernel K>
    requires has_strip_program<K>
    void expand(const K& kernel, const bindings<device, K>& buffers, range elements,
                const triangle_list<device>& out) {
        const auto here = enter(zone_name<pattern::expand, K>());
        detail::list_call call = list_call(kernel, buffers, out);
        call.elements = elements;
        expand_list(call);
    }

    template <strip_kernel K>
    requires has_strip_program<K>
    void expand(const K& kernel, const bindings<device, K>& buffers,
                const counted<device>& elements, const triangle_list<device>& out) {
        const auto here = enter(zone_name<pattern::expand, K>());
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
        const auto here = enter(zone_name<pattern::expand_rings, K>());
        detail::compute_call call{program<K>::rings_comp,
                                  zone_name<pattern::expand_rings, K>(),
                                  detail::push_of(kernel),
                                  bound_all(buffers),
                                  {}};
        expand_rings(call, elements, kernel.ring_vertices(), sizeof(typename K::vertex),
                     bound(vertices));
    }

    template <slab_kernel K>
    requires has_slab_program<K>
    void accumulate(const K& kernel, const bindings<device, K>& buffers, range elements,
                    const accumulation<device>& out) {
        const auto here = enter(zone_name<pattern::accumulate, K>());
        accumulate_slabs({slab_pass(kernel, buffers), elements, {}, kernel.slabs()}, out);
    }

    template <slab_kernel K>
    requires has_slab_program<K>
    void accumulate(const K& kernel, const bindings<device, K>& buffers,
                    const counted<device>& elements, const accumulation<device>& out) {
        const auto here = enter(zone_name<pattern::accumulate, K>());
        accumulate_slabs({slab_pass(kernel, buffers),
                          {0, elements.limit},
                          bound(elements.count),
                          kernel.slabs()},
                         out);
    }

    template <grid_map_kernel K>
    requires has_map_program<K>
    void map(const K& kernel, const bindings<device, K>& buffers,
             const volume_bindings<device, K>& volumes, range elements) {
        const auto here = enter(zone_name<pattern::map, K>());
        detail::compute_call call = map_call(kernel, buffers);
        add_volumes(call.images, volumes);
        map_range(call, elements);
    }

    template <voxel_kernel K>
    requires has_voxel_program<K>
    void map_voxels(const K& kernel, const bindings<device, K>& buffers,
                    const volume_bindings<device, K>& volumes, glm::uvec3 extent) {
        const auto here = enter(zone_name<pattern::map_voxels, K>());
        detail::compute_call call{program<K>::voxels_comp,
                                  zone_name<pattern::map_voxels, K>(),
                                  detail::push_of(kernel),
                                  bound_all(buffers),
                                  {}};
        add_volumes(call.images, volumes);
        call.push.set_header({extent.x, extent.y, extent.z, 0});
        dispatch(call, {groups_of(extent.x, 8), groups_of(extent.y, 8), extent.z});
    }

    template <draw_kernel K>
    requires has_draw_program<K> &&
        (!names_volumes<K>)void draw(const K& kernel, const bindings<device, K>& buffers,
                                     const image_bindings<device, K>& images,
                                     const draw_geometry<device>& geometry,
                                     const draw_target<device>& target, draw_state state) {
        const auto here = enter(zone_name<pattern::draw, K>());
        detail::draw_call call = draw_call(kernel, buffers, images, geometry, state);
        draw(call, target);
    }

    template <draw_kernel K>
    requires has_draw_program<K> && names_volumes<K>
    void draw(const K& kernel, const bindings<device, K>& buffers,
              const image_bindings<device, K>& images, const volume_bindings<device, K>& volumes,
              const draw_geometry<device>& geometry, const draw_target<device>& target,
              draw_state state) {
        const auto here = enter(zone_name<pattern::draw, K>());
        detail::draw_call call = draw_call(kernel, buffers, images, geometry, state);
        add_volumes(call.images, volumes);
        draw(call, target);
    }

    /// Drawn into pictures of our own, and copied to where the layer goes.
    template <peel_kernel K>
    requires has_peel_program<K>
    void peel(const K& kernel, const bindings<device, K>& buffers, range triangles,
              const peeled_layer<device>& layer) {
        const auto here = enter(zone_name<pattern::peel, K>());
        detail::peel_call call;
        call.name = zone_name<pattern::peel, K>();
        call.vertex = program<K>::peel_vert;
        call.push = detail::push_of(kernel);
        for (std::size_t i = 0; i < buffers.size(); ++i) {
            call.buffers[i] = bound(buffers[i]);
        }
        call.triangles = triangles;
        call.width = layer.width;
        call.height = layer.height;
        call.depth = bound(layer.depth);
        call.numbers = bound(layer.triangle);
        call.count = bound(layer.count);
        peel(call);
    }

    void scan(const buffer_view<device>& words, const buffer_view<device>& total) {
        const auto here = enter("scan");
        const slice values = bound(words);
        scan_words(values, static_cast<std::uint32_t>(values.size / 4), bound(total));
    }

    void scan(const volume& from, const volume& to, const volume_scan& how) {
        const auto here = enter("scan volume");
        scan_volume(from, to, how);
    }

    void sort(const buffer_view<device>& keys, const buffer_view<device>& values) {
        sort(keys, values, 32);
    }
    void sort(const buffer_view<device>& keys, const buffer_view<device>& values,
              const counted<device>& pairs) {
        sort(keys, values, pairs, 32);
    }
    void sort(const buffer_view<device>& keys, const buffer_view<device>& values,
              std::uint32_t key_bits) {
        sort_pairs({bound(keys), bound(values)}, {}, ~0u, key_bits);
    }
    void sort(const buffer_view<device>& keys, const buffer_view<device>& values,
              const counted<device>& pairs, std::uint32_t key_bits) {
        sort_pairs({bound(keys), bound(values)}, bound(pairs.count), pairs.limit, key_bits);
    }

    /// What each sample meets first along a bundle. In resolve.hpp, which vulkan.hpp includes.
    void resolve(const ray_bundle& bundle, const bundle_work<device>& work);

  private:
    friend class device;

    recorder(detail::device_state& state, std::unique_ptr<detail::recording> r, bool own)
        : detail::stream(state, std::move(r), own) {}

    /// Below this many elements an indirect dispatch isn't worth the one that prepares it.
    static constexpr std::uint32_t direct_limit = 16384;
    /// A range up to this size may share its workgroup with other ranges.
    static constexpr std::uint32_t small_range = 4096;
    /// Software rasterisers end a shader's loops after 65,535 turns.
    static constexpr std::uint64_t most_loop_turns = 65000;
    /// Turns of the loop in levels.comp; software rasterisers end a shader's loops after 65,535.
    static constexpr std::uint32_t most_turns = 16384;

    // ---- map

    template <class K>
    [[nodiscard]] detail::compute_call map_call(const K& kernel,
                                                const bindings<device, K>& buffers) {
        return {program<K>::map_comp,
                zone_name<pattern::map, K>(),
                detail::push_of(kernel),
                bound_all(buffers),
                {}};
    }

    void map_range(detail::compute_call what, range elements) {
        what.push.set_header({elements.first, elements.count, 0, 0});
        dispatch(what, groups_of(elements.count, 64));
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

    void scan_words(const slice& values, std::uint32_t count, const slice& total) {
        constexpr std::uint32_t block = 4096;
        const std::uint32_t blocks = std::max(1u, groups_of(count, block));
        const slice sums = blocks == 1 ? total : scratch(std::uint64_t{blocks} * 4);
        detail::compute_call pass{scan_comp, "scan", {}, {}, {}};
        pass.push.set_header({0, count, 0, 0});
        pass.buffers[vertices_binding] = values;
        pass.buffers[offsets_binding] = values;
        pass.buffers[length_binding] = sums;
        dispatch(pass, blocks);
        if (blocks > 1) {
            scan_words(sums, blocks, total);
            pass.words = scan_add_comp;
            pass.name = "scan, sums of blocks";
            dispatch(pass, groups_of(count, 256));
        }
    }

    // ---- volumes

    template <class K>
    void add_volumes(detail::bound_images& to, const volume_bindings<device, K>& volumes) {
        for (const volume* one : volumes.read) {
            add_volume(to, sampled_volumes, one);
        }
        for (const volume* one : volumes.write) {
            add_volume(to, target_volumes, one);
        }
    }

    /// From format to format: the program, or none where the contract has no such scan.
    [[nodiscard]] static spirv_words scan_program(volume_format from, volume_format to) {
        if (from == volume_format::int32) {
            return to == volume_format::int32     ? spirv_words(scan_int32_int32_comp)
                   : to == volume_format::float32 ? spirv_words(scan_int32_float32_comp)
                                                  : spirv_words(scan_int32_float16_comp);
        }
        return to == volume_format::float32 ? spirv_words(scan_float32_float32_comp)
                                            : spirv_words(scan_float32_float16_comp);
    }

    void scan_volume(const volume& from, const volume& to, const volume_scan& how) {
        const volume_description size = from.description();
        detail::compute_call pass{
            scan_program(size.format, to.description().format), "scan of a volume", {}, {}, {}};
        add_volume(pass.images, sum_volumes, &from);
        add_volume(pass.images, target_volumes, &to);
        pass.push.set_header({static_cast<std::uint32_t>(how.axis),
                              how.direction == scan_direction::descending ? 1u : 0u,
                              static_cast<std::uint32_t>(how.share),
                              std::bit_cast<std::uint32_t>(how.scale)});
        const std::uint32_t across = how.axis == scan_axis::x ? size.height : size.width;
        const std::uint32_t deep = how.axis == scan_axis::z ? size.height : size.depth;
        dispatch(pass, {groups_of(across, 64), deep, 1});
    }

    void clear_volume(const volume& on) {
        use(on);
        if (alive()) {
            const VkClearColorValue zero{};
            const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
            barrier();
            call().clear_color_image(commands(), on.handle(), VK_IMAGE_LAYOUT_GENERAL, &zero, 1,
                                     &all);
        }
    }

    template <class K>
    [[nodiscard]] detail::compute_call slab_pass(const K& kernel,
                                                 const bindings<device, K>& buffers) {
        return {program<K>::accumulate_comp,
                zone_name<pattern::accumulate, K>(),
                detail::push_of(kernel),
                bound_all(buffers),
                {}};
    }

    /// Into as few groups an element as its loops allow, where they have a limit: for slabs as
    /// large as the volume.
    [[nodiscard]] detail::slab_plan plan_slabs(std::uint32_t slabs,
                                               const volume_description& size) const {
        detail::slab_plan p;
        const bool side_by_side = state_->shared.per_vertices();
        p.lanes = side_by_side ? 16 : 4;
        p.each = std::min(slabs, 65535u);
        p.flags = side_by_side ? 0 : detail::flag_fetch;
        const auto turns = [&] {
            const std::uint64_t columns = groups_of(size.width, p.lanes * p.sharing);
            return groups_of(p.each, state_->shared.slab_group() / p.lanes) *
                   (1 + (columns + 1) * (std::uint64_t{size.height} + 1));
        };
        while (state_->shared.on_cpu() && turns() > most_loop_turns) {
            p.each = (p.each + 1) / 2;
            p.sharing *= p.each == 1 ? 2 : 1;
        }
        return p;
    }

    void accumulate_slabs(detail::slab_call what, const accumulation<device>& out) {
        assert(out.into && out.into->description().format == volume_format::int32);
        if (out.clear) {
            clear_volume(*out.into);
        }
        if (what.slabs == 0) {
            return;
        }
        const detail::slab_plan p = plan_slabs(what.slabs, out.into->description());
        const std::uint32_t parts = groups_of(what.slabs, p.each) * p.sharing;
        const bool counted = what.length.buffer != VK_NULL_HANDLE;
        add_volume(what.pass.images, sum_volumes, out.into);
        what.pass.buffers[length_binding] = what.length;
        const std::uint32_t most = std::max(64u, (1u << 31) / parts / 64 * 64);
        const std::uint32_t count = what.elements.count;
        const bool indirect = counted && count > direct_limit && count <= most;
        const slice arguments =
            indirect ? arguments_for(what.length, count, 1, 64 * parts) : slice{};
        for (std::uint32_t first = 0; first < count;) {
            const std::uint32_t n = std::min(count - first, most);
            what.pass.push.set_header(
                {what.elements.first + first, n, p.lanes | p.sharing << 16,
                 p.each << 16 | p.flags | (counted ? detail::flag_counted : 0)});
            if (indirect) {
                dispatch_indirect(what.pass, arguments);
            } else {
                dispatch(what.pass, n * parts);
            }
            first += n;
        }
    }

    // ---- sort

    /// See sort.glsl. Passes go to and fro; where their number is odd, they begin at a copy, so
    /// that the pairs end where they were.
    void sort_pairs(detail::pair_slices from, const slice& length, std::uint32_t limit,
                    std::uint32_t key_bits) {
        const auto here = enter("sort");
        constexpr std::uint32_t block = 1024;
        constexpr std::uint32_t bits = 4;
        const auto count = static_cast<std::uint32_t>(
            std::min<std::uint64_t>({from.keys.size / 4, from.values.size / 4, limit}));
        const std::uint32_t passes = (std::min(key_bits, 32u) + bits - 1) / bits;
        if (count == 0 || passes == 0) {
            return;
        }
        const std::uint32_t blocks = groups_of(count, block);
        const slice counts = scratch(std::uint64_t{blocks} << (bits + 2));
        const slice total = scratch(4);
        detail::pair_slices to{scratch(std::uint64_t{count} * 4),
                               scratch(std::uint64_t{count} * 4)};
        const std::uint32_t flags = length.buffer != VK_NULL_HANDLE ? detail::flag_counted : 0;
        detail::compute_call pass{sort_count_comp, "sort, counts", {}, {}, {}};
        pass.buffers[length_binding] = length;
        if (passes % 2 == 1) {
            copy_slice(from.keys, to.keys);
            copy_slice(from.values, to.values);
            std::swap(from, to);
        }
        for (std::uint32_t shift = 0; shift < passes * bits; shift += bits) {
            pass.push.set_header({shift, count, blocks, flags});
            count_digits(pass, from.keys, counts, blocks);
            scan_words(counts, blocks << bits, total);
            scatter(pass, from, to, counts, blocks);
            std::swap(from, to);
        }
    }

    void count_digits(detail::compute_call pass, const slice& keys, const slice& counts,
                      std::uint32_t blocks) {
        pass.buffers[vertices_binding] = counts;
        pass.buffers[offsets_binding] = keys;
        dispatch(pass, blocks);
    }

    void scatter(detail::compute_call pass, const detail::pair_slices& from,
                 const detail::pair_slices& to, const slice& offsets, std::uint32_t blocks) {
        pass.words = sort_scatter_comp;
        pass.name = "sort, scatter";
        pass.buffers[0] = to.keys;
        pass.buffers[1] = to.values;
        pass.buffers[2] = from.keys;
        pass.buffers[3] = from.values;
        pass.buffers[offsets_binding] = offsets;
        dispatch(pass, blocks);
    }

    // ---- expand

    template <class K>
    [[nodiscard]] detail::list_call list_call(const K& kernel, const bindings<device, K>& buffers,
                                              const triangle_list<device>& out) {
        detail::list_call call;
        call.name = zone_name<pattern::expand, K>();
        call.count = program<K>::strip_counts_comp;
        call.write = program<K>::strips_comp;
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
            write_strips(what, count, each, {});
            write_record(what, fit, {});
        } else {
            const std::uint32_t count = what.elements.count;
            const slice offsets = scratch(std::max<std::uint64_t>(4, std::uint64_t{count} * 4));
            total = scratch(4);
            count_triangles(what, offsets);
            scan_words(offsets, count, total);
            if (fit != 0) {
                write_strips(what, count, each, offsets);
            }
            write_record(what, fit, total);
        }
    }

    /// Each element's number of triangles.
    void count_triangles(const detail::list_call& what, const slice& counts) {
        detail::compute_call pass{what.count, what.name, what.push, what.buffers, {}};
        pass.push.set_header({what.elements.first, what.elements.count, 0, counted_flag(what)});
        pass.buffers[offsets_binding] = counts;
        pass.buffers[length_binding] = what.length;
        dispatch(pass, groups_of(what.elements.count, 64));
    }

    [[nodiscard]] static std::uint32_t counted_flag(const detail::list_call& what) {
        return what.length.buffer != VK_NULL_HANDLE ? detail::flag_counted : 0;
    }

    /// The triangles of the first `count` elements: at `offsets`, or `each` an element.
    void write_strips(const detail::list_call& what, std::uint32_t count, std::uint64_t each,
                      const slice& offsets) {
        const bool degenerate = what.policy == padding::degenerate;
        const detail::work_plan p = plan(what.strips, what.strip_triangles, 512, 2);
        detail::compute_call pass{what.write, what.name, what.push, what.buffers, {}};
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
        detail::compute_call pass{count_comp, "count", {}, {}, {}};
        pass.push.set_header({static_cast<std::uint32_t>(std::min<std::uint64_t>(fit, ~0u)),
                              what.elements.count, what.strips * what.strip_triangles,
                              degenerate | counted_flag(what)});
        pass.buffers[vertices_binding] = what.record;
        pass.buffers[offsets_binding] = total;
        pass.buffers[length_binding] = what.length;
        dispatch(pass, 1);
    }

    // ---- draw

    template <class K>
    [[nodiscard]] detail::draw_call draw_call(const K& kernel, const bindings<device, K>& buffers,
                                              const image_bindings<device, K>& images,
                                              const draw_geometry<device>& geometry,
                                              draw_state state) {
        detail::draw_call call;
        call.name = zone_name<pattern::draw, K>();
        call.program.vertex = program<K>::draw_vert;
        call.program.fragment = program<K>::draw_frag;
        call.program.state = state;
        call.push = detail::push_of(kernel);
        for (std::size_t i = 0; i < buffers.size(); ++i) {
            call.buffers[i] = bound(buffers[i]);
        }
        call.images.shape.draws = true;
        for (const sampled_image<device>& one : images) {
            add_image(call.images, one);
        }
        call.indices = bound(geometry.indices);
        call.length = bound(geometry.length);
        call.first = geometry.first;
        call.count = geometry.count;
        call.base_vertex = geometry.base_vertex;
        return call;
    }

    void draw(detail::draw_call& what, const draw_target<device>& target) {
        assert(target.color || target.depth);
        if (!alive()) {
            return;
        }
        what.program.shape = what.images.shape;
        what.program.color = target.color ? target.color->format() : VK_FORMAT_UNDEFINED;
        what.program.depth = target.depth ? target.depth->format() : VK_FORMAT_UNDEFINED;
        auto pipeline = state_->pipelines.draw(what.program, what.name);
        if (!pipeline) {
            return stop(pipeline.error());
        }
        auto layout = state_->pipelines.layout(what.program.shape);
        if (!layout) {
            return stop(layout.error());
        }
        auto set = fill_set(**layout, what.buffers, what.images);
        if (!set) {
            return stop(set.error());
        }
        const slice arguments = draw_arguments(what);
        if (!alive()) {
            return;
        }
        for (const image* on : {target.color, target.depth}) {
            if (on) {
                use(*on);
            }
        }
        barrier();
        begin_rendering(target);
        bind(VK_PIPELINE_BIND_POINT_GRAPHICS, *pipeline, **layout, *set, what.push);
        issue(what, arguments);
        call().end_rendering(commands());
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
        detail::compute_call pass{draw_arguments_comp, "draw arguments", {}, {}, {}};
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

    // ---- peel

    void peel(detail::peel_call& what) {
        [[maybe_unused]] const std::uint64_t pixels = std::uint64_t{what.width} * what.height;
        assert(pixels != 0 && pixels <= ~0u && what.depth.size >= pixels * 4 &&
               what.numbers.size >= pixels * 4);
        if (!alive()) {
            return;
        }
        const auto pictures = recording_->layers.take(what.width, what.height);
        if (!pictures) {
            return stop(pictures.error());
        }
        if (draw_layer(what, **pictures)) {
            take_layer(what, (*pictures)->fragments);
        }
    }

    [[nodiscard]] bool draw_layer(detail::peel_call& what,
                                  const detail::layer_pictures::pair& pictures) {
        draw_program program{what.vertex, peel_frag, {}, {}, {}, {}};
        program.shape.draws = program.shape.peels = true;
        program.color = pictures.fragments.format();
        program.depth = pictures.depth.format();
        auto pipeline = state_->pipelines.draw(program, what.name);
        auto layout = state_->pipelines.layout(program.shape);
        if (!pipeline || !layout) {
            stop(!pipeline ? pipeline.error() : layout.error());
            return false;
        }
        what.buffers.back() = what.depth;
        auto set = fill_set(**layout, what.buffers, {});
        if (!set) {
            stop(set.error());
            return false;
        }
        what.push.set_header({what.triangles.first, what.width, 0, 0});
        barrier();
        for (const image* one : {&pictures.depth, &pictures.fragments}) {
            image_barrier(one->handle(), aspect_of(one->description().format),
                          VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL, foreign_access{},
                          foreign_access{});
        }
        begin_layer(what, pictures);
        bind(VK_PIPELINE_BIND_POINT_GRAPHICS, *pipeline, **layout, *set, what.push);
        if (what.triangles.count != 0) {
            call().draw(commands(), 3 * what.triangles.count, 1, 0, 0);
        }
        call().end_rendering(commands());
        return true;
    }

    void begin_layer(const detail::peel_call& what, const detail::layer_pictures::pair& pictures) {
        VkRenderingAttachmentInfo fragments = attachment(pictures.fragments, true);
        fragments.clearValue.color.uint32[0] = ~0u;
        VkRenderingAttachmentInfo depth = attachment(pictures.depth, true); // cleared to 0
        depth.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
        auto info = make<VkRenderingInfo>(VK_STRUCTURE_TYPE_RENDERING_INFO);
        info.renderArea = {{0, 0}, {what.width, what.height}};
        info.layerCount = 1;
        info.colorAttachmentCount = 1;
        info.pColorAttachments = &fragments;
        info.pDepthAttachment = &depth;
        call().begin_rendering(commands(), &info);
        const VkViewport viewport{
            0, 0, static_cast<float>(what.width), static_cast<float>(what.height), 0, 1};
        call().set_viewport(commands(), 0, 1, &viewport);
        call().set_scissor(commands(), 0, 1, &info.renderArea);
    }

    /// Brings the fragments to where the layer goes, and counts them.
    void take_layer(const detail::peel_call& what, const image& fragments) {
        if (!alive()) {
            return;
        }
        barrier();
        call().fill_buffer(commands(), what.count.buffer, what.count.offset, sizeof(count_record),
                           0);
        detail::compute_call pass{peeled_comp, "peeled", {}, {}, {}};
        const std::uint32_t pixels = what.width * what.height;
        add(pass.images, sampled_images, fragments.view(), filter_mode::nearest, wrap_mode::clamp);
        pass.push.set_header({what.width, pixels, 0, 0});
        pass.buffers[vertices_binding] = what.depth;
        pass.buffers[offsets_binding] = what.numbers;
        pass.buffers[length_binding] = what.count;
        dispatch(pass, groups_of(pixels, 256));
    }

    // ---- resolve

    [[nodiscard]] detail::bundle_lists bundle_memory(const ray_bundle& bundle, std::uint32_t count);
    [[nodiscard]] std::uint32_t bundle_turns() const;
    [[nodiscard]] static detail::compute_call
    bundle_pass(spirv_words words, const char* name, const detail::bundle_parameters& parameters,
                std::uint32_t elements);
    void list_triangles(const ray_bundle& bundle, const detail::bundle_lists& lists);
    void look_samples_up(const ray_bundle& bundle, const detail::bundle_lists& lists,
                         const slice& samples, const slice& alpha, const slice& hits);

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
};

} // namespace skybark::vulkan
