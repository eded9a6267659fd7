#pragma once
// recorder::resolve: bundles of rays, resolved in one go. See shaders/programs/bundle_cells.glsl.
//
// What the patterns compose (gather/bundle_resolver.hpp) runs as well here. This is faster where a
// load costs more than arithmetic does, as on software rasterisers: a triangle is listed in every
// cell that it may cover, so that a sample looks at one list a grid and not at nine cells, and at
// few of its triangles.

#include <skybark/vulkan/programs/own_bundle_cover.hpp>
#include <skybark/vulkan/programs/own_bundle_levels.hpp>
#include <skybark/vulkan/programs/own_bundle_list.hpp>
#include <skybark/vulkan/programs/own_bundle_look.hpp>
#include <skybark/vulkan/programs/own_bundle_look_through.hpp>
#include <skybark/vulkan/recorder.hpp>

namespace skybark::vulkan {

namespace detail {

/// What the programs are given, after their header.
struct bundle_parameters {
    ray_bundle bundle;
    std::uint32_t first_triangle = 0;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    std::uint32_t again = 0;
};
static_assert(sizeof(bundle_parameters) == 80);

/// Some of the triangles, in lists.
struct bundle_lists {
    std::uint32_t first = 0; ///< triangle
    std::uint32_t count = 0;
    slice triangles;
    slice corners;
    slice covers;
    slice ends;
    slice listed;
    slice levels;
    slice crowded; ///< all bits where a list is longer than one pass can take
};

/// Cells of all grids.
[[nodiscard]] constexpr std::uint32_t bundle_list_cells(std::uint32_t finest) noexcept {
    std::uint32_t cells = 0;
    for (std::uint32_t side = finest; side > 0; side /= 4) {
        cells += side * side;
    }
    return cells;
}

inline constexpr std::uint32_t bundle_grids = 6; ///< at most: 2048, 512, … cells on a side
inline constexpr std::uint64_t bundle_cells_covered = 25;

} // namespace detail

inline void recorder::resolve(const ray_bundle& bundle, const bundle_work<device>& work) {
    const auto here = enter("resolve");
    assert(std::has_single_bit(static_cast<std::uint32_t>(bundle.direction.w)) &&
           bundle.direction.w <= 2048);
    const slice triangles = bound(work.triangles);
    const slice samples = bound(work.samples);
    const auto count = static_cast<std::uint32_t>(triangles.size / sizeof(gather_triangle));
    if (samples.size < sizeof(gather_sample)) {
        return;
    }
    // Lists are as long as a view may be, and name their triangles by 18 bits.
    const std::uint64_t fit =
        state_->shared.limits.max_buffer_bytes / (8 * detail::bundle_cells_covered);
    const auto most =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(fit, 1u << 18) / 4096 * 4096);
    detail::bundle_lists lists = bundle_memory(bundle, std::min(count, most));
    const slice alpha = bound(work.alpha);
    const slice hits = bound(work.hits);
    do {
        lists.count = std::min(count - lists.first, most);
        lists.triangles = {triangles.buffer,
                           triangles.offset + std::uint64_t{lists.first} * sizeof(gather_triangle),
                           std::uint64_t{lists.count} * sizeof(gather_triangle)};
        list_triangles(bundle, lists);
        look_samples_up(bundle, lists, samples, alpha, hits);
        lists.first += lists.count;
    } while (lists.first < count);
}

/// Room for so many triangles.
inline detail::bundle_lists recorder::bundle_memory(const ray_bundle& bundle, std::uint32_t count) {
    const std::uint64_t some = std::max(count, 1u);
    const std::uint64_t cells =
        detail::bundle_list_cells(static_cast<std::uint32_t>(bundle.direction.w));
    detail::bundle_lists lists;
    lists.corners = scratch(some * 48);
    lists.covers = scratch(some * 16);
    lists.ends = scratch((cells + 2) * 4);
    lists.listed = scratch(some * 8 * detail::bundle_cells_covered + 8); // reads go one too far
    lists.levels = scratch((detail::bundle_grids + 1) * 16);
    lists.crowded = scratch(4);
    return lists;
}

/// Triangles that a sample looks at in one pass. Software rasterisers end a shader's loops after
/// 65,535 turns, of all loops together; a triangle takes two, and the eight invocations that run as
/// one wait for each other in every grid.
inline std::uint32_t recorder::bundle_turns() const {
    return state_->shared.on_cpu() ? 4096 : 60000;
}

inline detail::compute_call recorder::bundle_pass(spirv_words words, const char* name,
                                                  const detail::bundle_parameters& parameters,
                                                  std::uint32_t elements) {
    detail::compute_call pass{words, name, {}, {}, {}};
    pass.push.set_header({0, elements, 0, 0});
    std::memcpy(pass.push.bytes.data() + 16, &parameters, sizeof parameters);
    pass.push.size = 16 + sizeof parameters;
    return pass;
}

inline void recorder::list_triangles(const ray_bundle& bundle, const detail::bundle_lists& lists) {
    if (!alive()) {
        return;
    }
    barrier();
    for (const slice& zeroed : {lists.ends, lists.crowded}) {
        call().fill_buffer(commands(), zeroed.buffer, zeroed.offset, zeroed.size, 0);
    }
    const std::uint32_t groups = groups_of(lists.count, 64);
    const detail::bundle_parameters parameters{bundle, lists.first, 0,
                                               bundle_turns() / detail::bundle_grids, 0};
    detail::compute_call cover =
        bundle_pass(bundle_cover_comp, "bundle, cover", parameters, lists.count);
    cover.buffers = {lists.triangles, lists.corners, lists.covers, lists.ends, lists.crowded};
    dispatch(cover, groups);
    scan_words(lists.ends, static_cast<std::uint32_t>(lists.ends.size / 4), scratch(4));
    detail::compute_call levels = bundle_pass(bundle_levels_comp, "bundle, levels", parameters, 0);
    levels.buffers = {lists.ends, lists.levels};
    dispatch(levels, 1);
    detail::compute_call list =
        bundle_pass(bundle_list_comp, "bundle, list", parameters, lists.count);
    list.buffers = {lists.corners, lists.covers, lists.ends, lists.listed};
    dispatch(list, groups);
}

/// One pass over the samples, and further ones, which have none unless a list is crowded.
inline void recorder::look_samples_up(const ray_bundle& bundle, const detail::bundle_lists& lists,
                                      const slice& samples, const slice& alpha, const slice& hits) {
    const auto count = static_cast<std::uint32_t>(samples.size / sizeof(gather_sample));
    const std::uint32_t turns = bundle_turns();
    detail::bundle_parameters parameters{bundle, lists.first, 0, turns, lists.first != 0 ? 1u : 0u};
    const bool holes = alpha.buffer != VK_NULL_HANDLE;
    const auto pass = [&] {
        detail::compute_call look = bundle_pass(holes ? spirv_words(bundle_look_through_comp)
                                                      : spirv_words(bundle_look_comp),
                                                "bundle, look", parameters, count);
        look.buffers = {samples,      lists.corners, lists.ends, lists.listed,
                        lists.levels, hits,          hits,       alpha};
        return look;
    };
    dispatch(pass(), groups_of(count, 64));
    if (lists.count <= turns) {
        return;
    }
    const slice arguments = arguments_for(lists.crowded, count, 1, 1);
    parameters.again = 1;
    while (lists.count - parameters.first > turns) {
        parameters.first += turns;
        dispatch_indirect(pass(), arguments);
    }
}

} // namespace skybark::vulkan
