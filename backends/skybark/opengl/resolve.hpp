#pragma once
// Bundles of rays in one go: samples are sorted into a grid by counting, and triangles test those
// that their boxes touch; see shaders/programs/resolve.glsl. What is needed besides is kept by the
// context, 28 bytes a sample of a slice and 4 a triangle, and grows where it must.

#include <skybark/opengl/programs/own_resolve_count.hpp>
#include <skybark/opengl/programs/own_resolve_hits.hpp>
#include <skybark/opengl/programs/own_resolve_large.hpp>
#include <skybark/opengl/programs/own_resolve_place.hpp>
#include <skybark/opengl/programs/own_resolve_small.hpp>
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

/// Samples of a slice: an invocation may look at a 64th of them in one run, and Mesa's software
/// rasterisers end its loops after 65,535 rounds.
inline constexpr std::uint32_t most_sliced_samples = 1u << 21;
inline constexpr std::uint32_t most_grid_cells = 1024; ///< on a side
/// More tests than this are shared by `large_share` groups.
inline constexpr std::uint32_t small_tests = 512;
inline constexpr std::uint32_t large_share = 4;

/// The parameters of resolve.glsl.
struct resolve_parameters {
    ray_bundle bundle;
    std::uint32_t first_sample = 0;
    std::uint32_t samples = 0;
    std::uint32_t triangles = 0;
    std::uint32_t side = 1;
    float scale = 1;
};
static_assert(sizeof(resolve_parameters) == 84);

struct resolve_programs {
    gl::handle count = 0;
    gl::handle place = 0;
    gl::handle small = 0;
    gl::handle large = 0;
    gl::handle hits = 0;
};

[[nodiscard]] inline result<resolve_programs> find_resolve_programs(context& c) {
    resolve_programs found;
    for (const auto& [text, program] :
         {std::pair{resolve_count_comp, &found.count}, std::pair{resolve_place_comp, &found.place},
          std::pair{resolve_small_comp, &found.small}, std::pair{resolve_large_comp, &found.large},
          std::pair{resolve_hits_comp, &found.hits}}) {
        const shader_stage stages[] = {{gl::compute_shader, text}};
        const auto made = c.find_program(stages);
        if (!made) {
            return failure(made.error());
        }
        *program = *made;
    }
    return found;
}

/// About four cells a sample: fewer make boxes meet samples that triangles don't, and more are
/// empty.
[[nodiscard]] inline std::uint32_t grid_side(std::uint32_t samples) {
    const double side = 2 * std::sqrt(static_cast<double>(samples));
    return static_cast<std::uint32_t>(std::clamp(side, 1.0, double{most_grid_cells}));
}

/// The scratch buffers' parts that a slice uses.
struct resolve_scratch {
    bound_range starts;
    bound_range ranks;
    bound_range places;
    bound_range nearest;
    bound_range large;
    bound_range large_count; ///< a count_record; what a scan leaves as its total follows it
    bound_range total;
};

[[nodiscard]] inline result<resolve_scratch>
size_resolve(context& c, std::uint32_t samples, std::uint32_t triangles, std::uint32_t side) {
    resolve_objects& objects = c.objects.resolve;
    const std::uint64_t cells = std::uint64_t{side} * side + 1;
    const std::uint64_t counts = aligned(c, 16);
    const std::uint64_t words = std::uint64_t{samples} * 4;
    const std::uint64_t listed = std::max<std::uint64_t>(triangles, 1) * 4;
    for (const auto& [buffer, bytes] :
         {std::pair{&objects.starts, cells * 4}, std::pair{&objects.ranks, words},
          std::pair{&objects.places, 4 * words}, std::pair{&objects.nearest, 2 * words},
          std::pair{&objects.large, 2 * counts + listed}}) {
        if (auto done = c.grow(*buffer, bytes); !done) {
            return failure(done.error());
        }
    }
    c.view_places();
    return resolve_scratch{
        part_of(objects.starts, 0, cells * 4),      part_of(objects.ranks, 0, words),
        part_of(objects.places, 0, 4 * words),      part_of(objects.nearest, 0, 2 * words),
        part_of(objects.large, 2 * counts, listed), part_of(objects.large, 0, 16),
        part_of(objects.large, counts, 16)};
}

inline void clear_words(context& c, const bound_range& words) {
    c.gl.clear_named_buffer_sub_data(words.buffer, gl::r32ui, words.offset, words.size,
                                     gl::red_integer, gl::unsigned_int, nullptr);
}

inline void bind_storage(context& c,
                         std::initializer_list<std::pair<std::uint32_t, bound_range>> bound) {
    for (const auto& [binding, range] : bound) {
        bind(c, gl::shader_storage_buffer, binding, range);
    }
}

/// So many groups of 64 as all of these need.
inline void dispatch_each(context& c, gl::handle program, std::uint32_t elements) {
    dispatch(c, program, (elements - 1) / 64 + 1);
}

/// Triangles test samples.
[[nodiscard]] inline result<void> test_triangles(context& c, const resolve_programs& programs,
                                                 const resolve_call& call,
                                                 const resolve_scratch& scratch,
                                                 const resolve_parameters& parameters) {
    const std::uint32_t flags = call.alpha.size != 0 ? 1 : 0;
    const auto bytes = std::as_bytes(std::span(&parameters, 1));
    const auto bind_lists = [&] {
        bind_storage(c, {{1, call.triangles},
                         {2, call.alpha},
                         {4, scratch.starts},
                         {7, scratch.nearest},
                         {8, scratch.large},
                         {9, scratch.large_count}});
    };
    clear_words(c, scratch.large_count);
    bind_lists();
    bind_parameters(c, {small_tests, 0, 0, flags}, bytes);
    dispatch_each(c, programs.small, parameters.triangles);
    indirect_call arguments;
    arguments.most = parameters.triangles;
    arguments.each = 64 * large_share;
    if (auto done = write_arguments(c, arguments, scratch.large_count); !done) {
        return done;
    }
    bind_lists();
    bind_parameters(c, {0, large_share, 0, flags}, bytes);
    dispatch_indirect(c, programs.large);
    return {};
}

/// One slice of the samples.
[[nodiscard]] inline result<void> resolve_slice(context& c, const resolve_programs& programs,
                                                const resolve_call& call,
                                                const resolve_scratch& scratch,
                                                const resolve_parameters& parameters) {
    const auto bytes = std::as_bytes(std::span(&parameters, 1));
    clear_words(c, scratch.starts);
    bind_parameters(c, {0, 0, 0, 0}, bytes);
    bind_storage(c, {{0, call.samples}, {4, scratch.starts}, {5, scratch.ranks}});
    dispatch_each(c, programs.count, parameters.samples);
    if (auto done = scan_blocks(c, scratch.starts, scratch.total); !done) {
        return done;
    }
    bind_parameters(c, {0, 0, 0, 0}, bytes);
    bind_storage(c, {{6, scratch.places}, {7, scratch.nearest}});
    dispatch_each(c, programs.place, parameters.samples);
    if (parameters.triangles != 0) {
        if (auto done = test_triangles(c, programs, call, scratch, parameters); !done) {
            return done;
        }
    }
    bind_parameters(c, {0, 0, 0, 0}, bytes);
    bind_storage(c, {{1, call.triangles}, {3, call.hits}, {7, scratch.nearest}});
    dispatch_each(c, programs.hits, parameters.samples);
    return {};
}

[[nodiscard]] inline result<void> resolve(context& c, const resolve_call& call) {
    const auto programs = find_resolve_programs(c);
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
    const std::uint32_t slice = std::min({samples, most_sliced_samples, c.max_buffer_texels});
    resolve_parameters parameters{call.bundle, 0, 0, triangles, grid_side(slice), 1};
    parameters.scale = static_cast<float>(parameters.side) / (2 * call.bundle.centre.w);
    const auto scratch = size_resolve(c, slice, triangles, parameters.side);
    if (!scratch) {
        return failure(scratch.error());
    }
    const saved_program saved(c.gl);
    const saved_buffers saved_too(c.gl, 0x7ff);
    const saved_binding indirect(c.gl, gl::dispatch_indirect_buffer,
                                 gl::dispatch_indirect_buffer_binding);
    const saved_textures saved_unit(c.gl, buffer_texture, 0, 1);
    c.gl.active_texture(gl::texture0);
    c.gl.bind_texture(gl::texture_target_buffer, c.objects.resolve.view);
    c.gl.bind_buffer(gl::dispatch_indirect_buffer, c.objects.arguments);
    for (std::uint32_t first = 0; first < samples; first += slice) {
        parameters.first_sample = first;
        parameters.samples = std::min(slice, samples - first);
        if (auto done = resolve_slice(c, *programs, call, *scratch, parameters); !done) {
            return done;
        }
    }
    return {};
}

} // namespace skybark::opengl::detail
