#pragma once
// Bundles of rays in one go: triangles are put into a hierarchy of grids by counting, in no order,
// which takes a fraction of the time of a sort, and samples look at few of them; see
// shaders/programs/resolve.glsl. What is needed besides is kept by the context, at most 148
// bytes a triangle of a slice and 4 a cell, and grows where it must.

#include <skybark/core/when_used.hpp>
#include <skybark/opengl/programs/own_resolve_count.hpp>
#include <skybark/opengl/programs/own_resolve_fill.hpp>
#include <skybark/opengl/programs/own_resolve_hits.hpp>
#include <skybark/opengl/programs/own_resolve_holes.hpp>
#include <skybark/opengl/word_patterns.hpp>

#include <bit>
#include <cmath>

namespace skybark::opengl::detail {

/// Records and words that a bundle is resolved from and into.
struct resolve_call {
    ray_bundle bundle;
    bound_range triangles;
    bound_range alpha;
    bound_range samples;
    bound_range hits;
};

inline constexpr std::uint32_t most_sliced_triangles = 1u << 20;
inline constexpr std::uint32_t most_entries = 25;      ///< of a triangle
inline constexpr std::uint32_t most_grid_cells = 2048; ///< on a side
/// Triangles that a sample looks at in a pass: Mesa's software rasterisers end the loops of up to
/// 16 invocations after 65,535 rounds that any of them makes.
inline constexpr std::uint32_t most_tests = 4000;

// Bindings of the programs, texture units 0 and 1 besides.
inline constexpr std::uint32_t resolve_bindings = 0x7ff;
inline constexpr std::uint32_t corners_unit = 0;
inline constexpr std::uint32_t entries_unit = 1;

/// The parameters of resolve.glsl.
struct resolve_parameters {
    ray_bundle bundle;
    std::uint32_t first_triangle = 0;
    std::uint32_t triangles = 0;
    std::uint32_t side = 1;
    float scale = 1;
    std::uint32_t first = 0;
    std::uint32_t last = 0;
};
static_assert(sizeof(resolve_parameters) == 88);

struct resolve_programs {
    gl::handle count = 0;
    gl::handle fill = 0;
    gl::handle hits = 0;
};

template <class = when_used>
[[nodiscard]] result<resolve_programs> find_resolve_programs(context& c, bool holes) {
    resolve_programs found;
    for (const auto& [text, program] :
         {std::pair{resolve_count_comp, &found.count}, std::pair{resolve_fill_comp, &found.fill},
          std::pair{holes ? resolve_holes_comp : resolve_hits_comp, &found.hits}}) {
        const shader_stage stages[] = {{gl::compute_shader, text}};
        const auto made = c.find_program(stages);
        if (!made) {
            return failure(made.error());
        }
        *program = *made;
    }
    return found;
}

/// Cells on a side of the finest grid, a power of two: about as many in all as triangles, or up to
/// four times as many where there are samples to make up for it.
[[nodiscard]] inline std::uint32_t grid_side(std::uint64_t triangles, std::uint64_t samples) {
    const std::uint64_t cells = std::clamp(samples, triangles, 4 * triangles);
    const double side = std::ceil(std::sqrt(static_cast<double>(cells)));
    return std::bit_ceil(
        static_cast<std::uint32_t>(std::clamp(side, 1.0, double{most_grid_cells})));
}

/// The parts of scratch buffers that a slice uses.
struct resolve_scratch {
    bound_range starts; ///< words
    bound_range levels; ///< a word
    bound_range more;   ///< a count_record
    bound_range total;  ///< a word
    bound_range corners;
    bound_range entries;
};

template <class = when_used>
[[nodiscard]] result<resolve_scratch> size_resolve(context& c, std::uint32_t triangles,
                                                   std::uint32_t side) {
    resolve_objects& objects = c.objects.resolve;
    const std::uint64_t cells = (4 * std::uint64_t{side} * side - 1) / 3 + 1;
    const std::uint64_t words = aligned(c, 16);
    const std::uint64_t corners = std::uint64_t{std::max(triangles, 1u)} * 48;
    const std::uint64_t entries = std::uint64_t{std::max(triangles, 1u)} * most_entries * 4;
    for (const auto& [buffer, bytes] :
         {std::pair{&objects.starts, 3 * words + cells * 4}, std::pair{&objects.corners, corners},
          std::pair{&objects.entries, entries}}) {
        if (auto done = c.grow(*buffer, bytes); !done) {
            return failure(done.error());
        }
    }
    c.show_resolve_buffers();
    return resolve_scratch{part_of(objects.starts, 3 * words, cells * 4),
                           part_of(objects.starts, 0, 16),
                           part_of(objects.starts, words, 16),
                           part_of(objects.starts, 2 * words, 16),
                           part_of(objects.corners, 0, corners),
                           part_of(objects.entries, 0, entries)};
}

template <class = when_used>
void clear_words(context& c, const bound_range& words) {
    c.gl.clear_named_buffer_sub_data(words.buffer, gl::r32ui, words.offset, words.size,
                                     gl::red_integer, gl::unsigned_int, nullptr);
}

template <class = when_used>
void bind_storage(context& c, std::initializer_list<std::pair<std::uint32_t, bound_range>> bound) {
    for (const auto& [binding, range] : bound) {
        bind(c, gl::shader_storage_buffer, binding, range);
    }
}

template <class = when_used>
void bind_texel_buffer(context& c, std::uint32_t unit, gl::handle texture) {
    c.gl.active_texture(gl::texture0 + unit);
    c.gl.bind_texture(gl::texture_target_buffer, texture);
}

/// A group for every 64.
[[nodiscard]] inline std::uint32_t groups_of(std::uint32_t elements) {
    return (elements - 1) / 64 + 1;
}

/// A slice of the triangles goes into the grids.
template <class = when_used>
[[nodiscard]] result<void> sort_into_grids(context& c, const resolve_programs& programs,
                                           const resolve_call& call, const resolve_scratch& scratch,
                                           const resolve_parameters& parameters) {
    const auto bytes = std::as_bytes(std::span(&parameters, 1));
    clear_words(c, scratch.starts);
    clear_words(c, scratch.levels);
    if (parameters.triangles == 0) {
        return {};
    }
    bind_parameters(c, {0, 0, 0, 0}, bytes);
    bind_storage(
        c, {{1, call.triangles}, {4, scratch.starts}, {5, scratch.levels}, {6, scratch.corners}});
    dispatch(c, programs.count, groups_of(parameters.triangles));
    if (auto done = scan_blocks(c, scratch.starts, scratch.total); !done) {
        return done;
    }
    bind_parameters(c, {0, 0, 0, 0}, bytes);
    bind_storage(c, {{4, scratch.starts}, {7, scratch.entries}});
    dispatch(c, programs.fill, groups_of(parameters.triangles));
    return {};
}

/// Samples look at the slice: at the first triangles of their cells, and those that have more, at
/// the others.
template <class = when_used>
[[nodiscard]] result<void> look_at_grids(context& c, const resolve_programs& programs,
                                         const resolve_call& call, const resolve_scratch& scratch,
                                         resolve_parameters parameters, std::uint32_t samples) {
    const auto bytes = std::as_bytes(std::span(&parameters, 1));
    const auto bind_lists = [&](const bound_range& length) {
        bind_storage(c, {{0, call.samples},
                         {2, call.hits},
                         {3, call.hits},
                         {4, scratch.starts},
                         {5, scratch.levels},
                         {8, scratch.more},
                         {9, call.alpha},
                         {length_binding, length}});
    };
    clear_words(c, scratch.more);
    parameters.last = most_tests;
    bind_parameters(c, {0, samples, parameters.first_triangle != 0 ? 1u : 0u, 0}, bytes);
    bind_lists({});
    dispatch(c, programs.hits, groups_of(samples));
    while (parameters.last < parameters.triangles) {
        parameters.first = parameters.last;
        parameters.last += most_tests;
        indirect_call arguments;
        arguments.most = samples;
        if (auto done = write_arguments(c, arguments, scratch.more); !done) {
            return done;
        }
        bind_parameters(c, {0, samples, 1, 1}, bytes);
        bind_lists(scratch.more);
        dispatch_indirect(c, programs.hits);
    }
    return {};
}

template <class = when_used>
[[nodiscard]] result<void> resolve(context& c, const resolve_call& call) {
    const auto programs = find_resolve_programs(c, call.alpha.size != 0);
    if (!programs) {
        return failure(programs.error());
    }
    const auto triangles = static_cast<std::uint32_t>(
        static_cast<std::uint64_t>(call.triangles.size) / sizeof(gather_triangle));
    const auto samples = static_cast<std::uint32_t>(static_cast<std::uint64_t>(call.samples.size) /
                                                    sizeof(gather_sample));
    if (samples == 0) {
        return {};
    }
    const std::uint32_t slice =
        std::min({triangles, most_sliced_triangles, c.max_buffer_texels / most_entries});
    resolve_parameters parameters;
    parameters.bundle = call.bundle;
    parameters.side = grid_side(slice, samples);
    parameters.scale = static_cast<float>(parameters.side) / (2 * call.bundle.centre.w);
    const auto scratch = size_resolve(c, slice, parameters.side);
    if (!scratch) {
        return failure(scratch.error());
    }
    const saved_program saved(c.gl);
    const saved_buffers saved_too(c.gl, resolve_bindings);
    const saved_binding indirect(c.gl, gl::dispatch_indirect_buffer,
                                 gl::dispatch_indirect_buffer_binding);
    const saved_textures saved_units(c.gl, buffer_texture, corners_unit, 2);
    bind_texel_buffer(c, corners_unit, c.objects.resolve.corner_texels);
    bind_texel_buffer(c, entries_unit, c.objects.resolve.entry_texels);
    c.gl.bind_buffer(gl::dispatch_indirect_buffer, c.objects.arguments);
    do {
        parameters.triangles = std::min(slice, triangles - parameters.first_triangle);
        if (auto done = sort_into_grids(c, *programs, call, *scratch, parameters); !done) {
            return done;
        }
        if (auto done = look_at_grids(c, *programs, call, *scratch, parameters, samples); !done) {
            return done;
        }
        parameters.first_triangle += slice;
    } while (parameters.first_triangle < triangles);
    return {};
}

} // namespace skybark::opengl::detail
