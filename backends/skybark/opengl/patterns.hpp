#pragma once
// The patterns, without types: what recorder.hpp calls once it has a kernel's bytes and programs.
//
//   map           compute; where the device knows the length, an indirect dispatch
//   map (ranges)  runs of small ranges in one workgroup each run, large ones as dispatches
//   expand        points → geometry shader → transform feedback, as strips of triangles
//   expand_rings  the same, as points
//   draw          vertices pulled from storage buffers by their number
//
// Volumes have patterns of their own, in volume_patterns.hpp and drawn_sums.hpp, words in
// word_patterns.hpp, and layers of depths in peel.hpp.
//
// Each restores what it changed before it returns. A memory barrier ends each, so that whatever
// comes next, here or in the caller's own code, sees what was written.

#include <skybark/core/when_used.hpp>
#include <skybark/opengl/context.hpp>
#include <skybark/opengl/state.hpp>

#include <optional>

namespace skybark::opengl::detail {

/// A kernel as every pattern needs it. Volumes are 3-D textures: those that it reads, and those of
/// float32 that it writes.
struct kernel_call {
    std::span<const std::byte> parameters;
    std::span<const bound_range> buffers;
    std::span<const gl::handle> volumes = {};
    std::span<const gl::handle> targets = {};
};

/// How many elements: `elements`, or, where there is a `length`, the count in it, at most as many.
struct element_range {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    bound_range length = {};
};

inline constexpr std::uint32_t arguments_binding = 9;
inline constexpr std::uint32_t length_binding = 10;
inline constexpr std::uint32_t ranges_binding = 11;
// Texture units and image units, as parameters.glsl has them.
inline constexpr std::uint32_t volume_unit = 8;
inline constexpr std::uint32_t target_unit = 0;

[[nodiscard]] inline std::uint32_t kernel_mask(const kernel_call& call) {
    return (std::uint32_t{1} << call.buffers.size()) - 1;
}
[[nodiscard]] constexpr std::uint32_t mask_of(std::uint32_t binding) {
    return std::uint32_t{1} << binding;
}

template <class = when_used>
void bind(context& c, gl::token target, std::uint32_t binding, const bound_range& range) {
    // Binding no bytes is an error in OpenGL, and nobody reads what stands there instead.
    const bound_range none{c.objects.scratch, 0, 16};
    const bound_range& used = range.buffer == 0 || range.size == 0 ? none : range;
    c.gl.bind_buffers_range(target, binding, 1, &used.buffer, &used.offset, &used.size);
}

template <class = when_used>
void bind_kernel(context& c, const kernel_call& call) {
    for (std::uint32_t i = 0; i < call.buffers.size(); ++i) {
        bind(c, gl::shader_storage_buffer, i, call.buffers[i]);
    }
}

/// The texture units of a kernel's volumes and the image units of its targets.
class saved_volumes {
  public:
    saved_volumes(const gl::functions& functions, const kernel_call& call)
        : textures_(functions, deep_texture, volume_unit, call.volumes.size()),
          targets_(functions, target_unit, call.targets.size()) {}

  private:
    saved_textures textures_;
    saved_image_units targets_;
};

template <class = when_used>
void bind_volumes(context& c, const kernel_call& call) {
    for (std::uint32_t i = 0; i < call.volumes.size(); ++i) {
        c.gl.active_texture(gl::texture0 + volume_unit + i);
        c.gl.bind_texture(gl::texture_3d, call.volumes[i]);
        c.gl.bind_sampler(volume_unit + i, c.objects.samplers[2]);
    }
    for (std::uint32_t i = 0; i < call.targets.size(); ++i) {
        c.gl.bind_image_texture(target_unit + i, call.targets[i], 0, 1, 0, gl::write_only,
                                gl::r32f);
    }
}

template <class = when_used>
void bind_parameters(context& c, const std::array<std::uint32_t, 4>& header,
                     std::span<const std::byte> kernel) {
    bind(c, gl::uniform_buffer, 0, c.write_parameters(header, kernel));
}

// ---- Indirect arguments -------------------------------------------------------------------------

/// What opengl_arguments.comp is asked for.
struct indirect_call {
    enum kind_type : std::uint32_t { dispatch, arrays, elements } kind = dispatch;
    std::uint32_t skip = 0;  ///< of the elements counted
    std::uint32_t most = 0;  ///< elements after those
    std::uint32_t each = 1;  ///< vertices or indices an element
    std::uint32_t first = 0; ///< vertex or index
    std::uint32_t base_vertex = 0;
};

/// Leaves an indirect call's arguments in `objects.arguments`; changes the program, the uniform
/// buffer and the storage buffers 9 and 10.
template <class = when_used>
[[nodiscard]] result<void> write_arguments(context& c, const indirect_call& call,
                                           const bound_range& length) {
    const shader_stage stages[] = {{gl::compute_shader, arguments_comp}};
    const auto program = c.find_program(stages);
    if (!program) {
        return failure(program.error());
    }
    const std::array<std::uint32_t, 4> geometry{call.first, call.base_vertex, 0, 0};
    bind_parameters(c, {call.kind, call.skip, call.most, call.each},
                    std::as_bytes(std::span(geometry)));
    bind(c, gl::shader_storage_buffer, arguments_binding, {c.objects.arguments, 0, 32});
    bind(c, gl::shader_storage_buffer, length_binding, length);
    c.gl.use_program(*program);
    c.gl.dispatch_compute(1, 1, 1);
    c.gl.memory_barrier(gl::all_barrier_bits);
    return {};
}

// ---- map ----------------------------------------------------------------------------------------

/// So many groups of the program; beyond 65,535 they go into the second dimension.
template <class = when_used>
void dispatch(context& c, gl::handle program, std::uint32_t groups) {
    const std::uint32_t columns = std::min(groups, 65535u);
    c.gl.use_program(program);
    c.gl.dispatch_compute(columns, (groups + columns - 1) / columns, 1);
    c.gl.memory_barrier(gl::all_barrier_bits);
}

template <class = when_used>
void dispatch_map(context& c, gl::handle program, const kernel_call& call, range elements) {
    bind_parameters(c, {elements.first, elements.count, 0, 0}, call.parameters);
    dispatch(c, program, elements.count / 64 + (elements.count % 64 != 0 ? 1 : 0));
}

/// As many groups as `objects.arguments` says.
template <class = when_used>
void dispatch_indirect(context& c, gl::handle program) {
    c.gl.use_program(program);
    c.gl.dispatch_compute_indirect(0);
    c.gl.memory_barrier(gl::all_barrier_bits);
}

template <class = when_used>
[[nodiscard]] result<void> map(context& c, std::string_view text, const kernel_call& call,
                               const element_range& elements) {
    const shader_stage stages[] = {{gl::compute_shader, text}};
    const auto program = c.find_program(stages);
    if (!program || elements.count == 0) {
        return program ? result<void>{} : failure(program.error());
    }
    const saved_program saved(c.gl);
    const saved_volumes saved_units(c.gl, call);
    bind_volumes(c, call);
    if (elements.length.buffer == 0) {
        const saved_buffers saved_too(c.gl, kernel_mask(call) | mask_of(length_binding));
        bind_kernel(c, call);
        bind(c, gl::shader_storage_buffer, length_binding, {});
        dispatch_map(c, *program, call, {elements.first, elements.count});
        return {};
    }
    const saved_buffers saved_too(c.gl, kernel_mask(call) | mask_of(length_binding) |
                                            mask_of(arguments_binding));
    const saved_binding indirect(c.gl, gl::dispatch_indirect_buffer,
                                 gl::dispatch_indirect_buffer_binding);
    indirect_call arguments;
    arguments.most = elements.count;
    if (auto done = write_arguments(c, arguments, elements.length); !done) {
        return done;
    }
    bind_kernel(c, call);
    bind_parameters(c, {elements.first, elements.count, 0, 1}, call.parameters);
    c.gl.bind_buffer(gl::dispatch_indirect_buffer, c.objects.arguments);
    dispatch_indirect(c, *program);
    return {};
}

/// Ranges up to this long share a workgroup with their neighbours.
inline constexpr std::uint32_t small_range = 4096;
/// Mesa's software rasterisers end a loop after 65,535 rounds; all of a dispatch's together count.
inline constexpr std::uint32_t max_rounds = 60000;

/// How many of the ranges from the first one on one workgroup can walk.
[[nodiscard]] inline std::size_t small_run(std::span<const range> ranges) {
    std::uint32_t rounds = 0;
    std::size_t i = 0;
    for (; i < ranges.size() && ranges[i].count <= small_range; ++i) {
        // One of the outer loop, one more where the inner loop ends, and those of the inner loop.
        rounds += 2 + (ranges[i].count + 255) / 256;
        if (rounds > max_rounds) {
            break;
        }
    }
    return i;
}

template <class = when_used>
[[nodiscard]] result<void> map_levels(context& c, std::string_view one, std::string_view many,
                                      const kernel_call& call, std::span<const range> ranges) {
    const shader_stage one_stages[] = {{gl::compute_shader, one}};
    const shader_stage many_stages[] = {{gl::compute_shader, many}};
    const auto one_program = c.find_program(one_stages);
    const auto many_program = c.find_program(many_stages);
    if (!one_program || !many_program) {
        return failure(one_program ? many_program.error() : one_program.error());
    }
    if (ranges.empty()) {
        return {};
    }
    const auto list = c.write_ranges(ranges);
    if (!list) {
        return failure(list.error());
    }
    const saved_program saved(c.gl);
    const saved_buffers saved_too(c.gl, kernel_mask(call) | mask_of(length_binding) |
                                            mask_of(ranges_binding));
    bind_kernel(c, call);
    bind(c, gl::shader_storage_buffer, length_binding, {});
    bind(c, gl::shader_storage_buffer, ranges_binding, *list);
    for (std::size_t i = 0; i < ranges.size();) {
        const std::size_t run = small_run(ranges.subspan(i));
        if (run < 2) {
            if (ranges[i].count != 0) {
                dispatch_map(c, *one_program, call, ranges[i]);
            }
            ++i;
            continue;
        }
        bind_parameters(c, {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(run), 0, 0},
                        call.parameters);
        c.gl.use_program(*many_program);
        c.gl.dispatch_compute(1, 1, 1);
        c.gl.memory_barrier(gl::all_barrier_bits);
        i += run;
    }
    return {};
}

// ---- expand -------------------------------------------------------------------------------------

/// How an element is cut so that each part fits into a geometry shader's output.
struct element_parts {
    std::uint32_t size = 1;         ///< triangles (strips) or vertices (rings): header.z
    std::uint64_t count = 0;        ///< parts an element
    std::uint32_t max_vertices = 1; ///< that a part emits
};

/// Whole rings' vertices: as few parts as possible, all about equally long.
[[nodiscard]] inline element_parts ring_parts(std::uint32_t vertices, std::size_t vertex_bytes) {
    const std::uint32_t most =
        std::min(static_cast<std::uint32_t>(max_geometry_components * 4 / vertex_bytes),
                 max_geometry_vertices);
    if (vertices == 0) {
        return {};
    }
    const std::uint32_t count = (vertices - 1) / most + 1;
    const std::uint32_t size = (vertices - 1) / count + 1;
    return {size, (vertices - 1) / size + 1, size};
}

/// As many whole strips as fit, or an even number of one strip's triangles. A strip of n triangles
/// has n + 2 vertices; with padding, it may be followed by a second strip of spare ones.
[[nodiscard]] inline element_parts strip_parts(std::uint32_t strips, std::uint32_t triangles,
                                               std::size_t vertex_bytes, padding policy) {
    const std::uint32_t most =
        std::min(static_cast<std::uint32_t>(max_geometry_components * 4 / vertex_bytes),
                 max_geometry_vertices);
    const std::uint32_t extra = policy == padding::degenerate ? 4 : 2;
    if (strips == 0 || triangles == 0) {
        return {};
    }
    if (triangles <= most - extra) {
        const std::uint32_t fit = std::min(strips, most / (triangles + extra));
        const std::uint32_t count = (strips - 1) / fit + 1;
        const std::uint32_t whole = (strips - 1) / count + 1;
        return {whole * triangles, (strips - 1) / whole + 1, whole * (triangles + extra)};
    }
    const std::uint32_t longest = (most - extra) / 2 * 2;
    const std::uint32_t pieces = (triangles - 1) / longest + 1;
    const std::uint32_t even = ((triangles - 1) / pieces + 1 + 1) / 2 * 2;
    return {even, std::uint64_t{strips} * ((triangles - 1) / even + 1), even + extra};
}

/// Points of one draw: far below 2³¹, where gl_VertexID ends.
inline constexpr std::uint64_t max_points = std::uint64_t{1} << 30;

/// Where an expansion writes, and how.
struct expansion {
    std::string_view vertex_text;
    std::string_view geometry_text;
    gl::token primitive = gl::points;
    element_parts parts;
    std::uint32_t flags = 0; ///< of the header
    bound_range vertices;
    bound_range count;                        ///< a count_record, or nothing
    std::uint64_t points_a_draw = max_points; ///< more are drawn by several draws
};

template <class = when_used>
[[nodiscard]] result<void> require_free_queries(const gl::functions& gl) {
    for (const gl::token target :
         {gl::transform_feedback_primitives_written, gl::primitives_generated}) {
        int active = 0;
        gl.get_query(target, gl::current_query, &active);
        if (active != 0) {
            return fail(error_code::unavailable,
                        "An expansion counts with queries of its own, and query " +
                            std::to_string(active) + " of the same kind is active.");
        }
    }
    return {};
}

/// Draws the points of all elements, chunk by chunk, into the bound transform feedback.
template <class = when_used>
[[nodiscard]] result<void> feed_points(context& c, gl::handle program, const kernel_call& call,
                                       const element_range& elements, const expansion& out) {
    const std::uint64_t parts = out.parts.count;
    const auto chunk = static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(out.points_a_draw / parts, 1, elements.count));
    for (std::uint32_t done = 0; done < elements.count;) {
        const std::uint32_t now = std::min(chunk, elements.count - done);
        if (elements.length.buffer != 0) {
            if (done != 0) {
                c.gl.pause_transform_feedback();
            }
            indirect_call arguments;
            arguments.kind = indirect_call::arrays;
            arguments.skip = done;
            arguments.most = now;
            arguments.each = static_cast<std::uint32_t>(parts);
            if (auto written = write_arguments(c, arguments, elements.length); !written) {
                return written;
            }
        }
        bind_parameters(c, {elements.first + done, now, out.parts.size, out.flags},
                        call.parameters);
        // While a transform feedback runs, not even the program in use may be used again.
        if (done == 0) {
            c.gl.use_program(program);
            c.gl.begin_transform_feedback(out.primitive);
        } else if (elements.length.buffer != 0) {
            c.gl.use_program(program);
            c.gl.resume_transform_feedback();
        }
        if (elements.length.buffer != 0) {
            c.gl.draw_arrays_indirect(gl::points, nullptr);
        } else {
            c.gl.draw_arrays(gl::points, 0, static_cast<int>(now * parts));
        }
        done += now;
    }
    c.gl.end_transform_feedback();
    return {};
}

template <class = when_used>
[[nodiscard]] result<void> expand(context& c, const kernel_call& call,
                                  const element_range& elements, const expansion& out) {
    const shader_stage stages[] = {{gl::vertex_shader, out.vertex_text},
                                   {gl::geometry_shader, out.geometry_text}};
    const auto program = c.find_program(stages, out.parts.max_vertices);
    if (!program) {
        return failure(program.error());
    }
    const auto counts = [&out](auto&& use) {
        if (out.count.buffer != 0 && out.count.size != 0) {
            use(out.count);
        }
    };
    counts([&c](const bound_range& count) {
        c.gl.clear_named_buffer_sub_data(count.buffer, gl::r32ui, count.offset,
                                         sizeof(count_record), gl::red_integer, gl::unsigned_int,
                                         nullptr);
    });
    if (elements.count == 0 || out.parts.count == 0) {
        return {};
    }
    if (out.parts.count > max_points) {
        return fail(error_code::out_of_memory, "An element of " + std::to_string(out.parts.count) +
                                                   " parts is more than one draw can expand.");
    }
    if (auto free = require_free_queries(c.gl); !free) {
        return free;
    }
    const saved_program saved(c.gl);
    const saved_buffers saved_too(c.gl, kernel_mask(call) | mask_of(length_binding) |
                                            mask_of(arguments_binding));
    const saved_drawing saved_drawing_state(c.gl);
    const saved_feedback saved_target(c.gl);
    c.gl.bind_vertex_array(c.objects.vertex_array);
    c.gl.bind_framebuffer(gl::draw_framebuffer, c.objects.nothing);
    c.gl.bind_transform_feedback(gl::transform_feedback, c.objects.feedback);
    c.gl.enable(gl::rasterizer_discard);
    c.gl.bind_buffer(gl::draw_indirect_buffer, c.objects.arguments);
    bind_kernel(c, call);
    // Transform feedback stops before the first primitive that does not fit, and 16 bytes fit none
    // of any expansion but a ring's of one vec4, which then lands where nobody looks.
    const bool empty = out.vertices.buffer == 0 || out.vertices.size < 4;
    c.gl.transform_feedback_buffer_range(
        c.objects.feedback, 0, empty ? c.objects.scratch : out.vertices.buffer,
        empty ? 0 : out.vertices.offset, empty ? 4 : out.vertices.size / 4 * 4);
    counts([&c](const bound_range&) {
        c.gl.begin_query(gl::transform_feedback_primitives_written, c.objects.written);
        c.gl.begin_query(gl::primitives_generated, c.objects.generated);
    });
    auto fed = feed_points(c, *program, call, elements, out);
    counts([&c](const bound_range& count) {
        c.gl.end_query(gl::transform_feedback_primitives_written);
        c.gl.end_query(gl::primitives_generated);
        c.gl.get_query_buffer_object(c.objects.written, count.buffer, gl::query_result,
                                     count.offset);
        c.gl.get_query_buffer_object(c.objects.generated, count.buffer, gl::query_result,
                                     count.offset + 4);
    });
    c.gl.transform_feedback_buffer_base(c.objects.feedback, 0, 0);
    c.gl.memory_barrier(gl::all_barrier_bits);
    return fed;
}

// ---- draw ---------------------------------------------------------------------------------------

struct image_binding {
    gl::handle texture = 0;
    bool linear = false;
    bool repeat = false;
};

/// A draw without types. Textures of 0 are absent.
struct draw_call {
    std::string_view vertex_text;
    std::string_view fragment_text;
    std::span<const image_binding> images;
    bound_range indices;
    bound_range length;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    std::uint32_t base_vertex = 0;
    gl::handle color = 0;
    gl::handle depth = 0;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::optional<glm::vec4> clear_color;
    std::optional<float> clear_depth;
    draw_state state;
};

inline void set(const gl::functions& gl, gl::token capability, bool on) {
    on ? gl.enable(capability) : gl.disable(capability);
}

/// Clip space has y up and 0 ≤ z ≤ w; row 0 of the target is the top; fronts wind counter-clockwise
/// in clip space, whichever way rows are counted.
template <class = when_used>
void set_raster(const gl::functions& gl, const draw_call& call) {
    const draw_state& state = call.state;
    gl.clip_control(gl::upper_left, gl::zero_to_one);
    gl.viewport_indexed(0, 0, 0, static_cast<float>(call.width), static_cast<float>(call.height));
    gl.depth_range_indexed(0, 0, 1);
    gl.disable_i(gl::scissor_test, 0);
    gl.color_mask_i(0, 1, 1, 1, 1);
    gl.polygon_mode(gl::front_and_back, gl::fill);
    gl.front_face(gl::ccw);
    gl.cull_face(gl::back);
    set(gl, gl::cull_face, state.cull == cull_mode::back);
    // Depth is written only where it is tested: a test that always passes leaves the choice free.
    set(gl, gl::depth_test, state.depth_test || state.depth_write);
    gl.depth_func(state.depth_test ? gl::lequal : gl::always);
    state.blend == blend_mode::alpha ? gl.enable_i(gl::blend, 0) : gl.disable_i(gl::blend, 0);
    gl.blend_func_separate_i(0, gl::one, gl::one_minus_src_alpha, gl::one, gl::one_minus_src_alpha);
    gl.blend_equation_separate_i(0, gl::func_add, gl::func_add);
}

/// The same for pixels that are numbers: all are written, and row 0 of the target is at clip y =
/// −1.
template <class = when_used>
void set_pixel_raster(const gl::functions& gl, const glm::uvec2& size, bool blend) {
    gl.clip_control(gl::lower_left, gl::zero_to_one);
    gl.viewport_indexed(0, 0, 0, static_cast<float>(size.x), static_cast<float>(size.y));
    gl.depth_range_indexed(0, 0, 1);
    gl.disable_i(gl::scissor_test, 0);
    gl.color_mask_i(0, 1, 1, 1, 1);
    gl.polygon_mode(gl::front_and_back, gl::fill);
    gl.disable(gl::cull_face);
    gl.disable(gl::depth_test);
    blend ? gl.enable_i(gl::blend, 0) : gl.disable_i(gl::blend, 0);
    gl.blend_func_separate_i(0, gl::one, gl::one, gl::one, gl::one);
    gl.blend_equation_separate_i(0, gl::func_add, gl::func_add);
}

template <class = when_used>
void clear(context& c, const draw_call& call) {
    c.gl.depth_mask(1);
    if (call.color != 0 && call.clear_color) {
        const glm::vec4& v = *call.clear_color;
        const float color[] = {v.x, v.y, v.z, v.w};
        c.gl.clear_named_framebuffer(c.objects.target, gl::color, 0, color);
    }
    if (call.depth != 0 && call.clear_depth) {
        c.gl.clear_named_framebuffer(c.objects.target, gl::depth, 0, &*call.clear_depth);
    }
    c.gl.depth_mask(static_cast<gl::boolean>(call.state.depth_write));
}

template <class = when_used>
void bind_images(context& c, std::span<const image_binding> images) {
    for (std::size_t i = 0; i < images.size(); ++i) {
        const std::size_t sampler = (images[i].linear ? 2u : 0u) + (images[i].repeat ? 1u : 0u);
        c.gl.active_texture(gl::texture0 + static_cast<gl::token>(i));
        c.gl.bind_texture(gl::texture_2d, images[i].texture);
        c.gl.bind_sampler(static_cast<gl::handle>(i), c.objects.samplers[sampler]);
    }
}

template <class = when_used>
void draw_triangles(context& c, const draw_call& call) {
    const bool indexed = call.indices.buffer != 0;
    const bool indirect = call.length.buffer != 0;
    // An element buffer has no offset of its own: the first index carries it.
    const std::uint64_t index = static_cast<std::uint64_t>(call.indices.offset) / 4 + call.first;
    if (indirect && indexed) {
        c.gl.draw_elements_indirect(gl::triangles, gl::unsigned_int, nullptr);
    } else if (indirect) {
        c.gl.draw_arrays_indirect(gl::triangles, nullptr);
    } else if (indexed) {
        c.gl.draw_elements_base_vertex(gl::triangles, static_cast<int>(call.count),
                                       gl::unsigned_int, reinterpret_cast<const void*>(index * 4),
                                       static_cast<int>(call.base_vertex));
    } else {
        c.gl.draw_arrays(gl::triangles, static_cast<int>(call.first + call.base_vertex),
                         static_cast<int>(call.count));
    }
}

/// The arguments of a draw whose length the device knows.
template <class = when_used>
[[nodiscard]] indirect_call draw_arguments(const draw_call& call) {
    indirect_call arguments;
    arguments.each = 3;
    arguments.most = 0xffffffffu / 3;
    if (call.indices.buffer == 0) {
        arguments.kind = indirect_call::arrays;
        arguments.first = call.first + call.base_vertex;
        return arguments;
    }
    // Nothing keeps an element buffer from being read beyond the view but this.
    const std::uint64_t has = static_cast<std::uint64_t>(call.indices.size) / 4;
    arguments.kind = indirect_call::elements;
    arguments.most = static_cast<std::uint32_t>(
        std::min<std::uint64_t>(has > call.first ? (has - call.first) / 3 : 0, arguments.most));
    arguments.first =
        static_cast<std::uint32_t>(static_cast<std::uint64_t>(call.indices.offset) / 4) +
        call.first;
    arguments.base_vertex = call.base_vertex;
    return arguments;
}

template <class = when_used>
[[nodiscard]] result<void> draw(context& c, const kernel_call& kernel, const draw_call& call) {
    const shader_stage stages[] = {{gl::vertex_shader, call.vertex_text},
                                   {gl::fragment_shader, call.fragment_text}};
    const auto program = c.find_program(stages);
    if (!program) {
        return failure(program.error());
    }
    const saved_program saved(c.gl);
    const saved_buffers saved_too(c.gl, kernel_mask(kernel) | mask_of(length_binding) |
                                            mask_of(arguments_binding));
    const saved_drawing saved_drawing_state(c.gl);
    const saved_raster saved_raster_state(c.gl);
    const saved_textures saved_images(c.gl, flat_texture, 0, call.images.size());
    const saved_volumes saved_units(c.gl, kernel);
    if (call.length.buffer != 0) {
        if (auto done = write_arguments(c, draw_arguments(call), call.length); !done) {
            return done;
        }
    }
    c.attach(call.color, call.depth);
    c.gl.bind_framebuffer(gl::draw_framebuffer, c.objects.target);
    set_raster(c.gl, call);
    clear(c, call);
    if (call.count == 0 && call.length.buffer == 0) {
        return {};
    }
    c.gl.bind_vertex_array(c.objects.vertex_array);
    c.gl.vertex_array_element_buffer(c.objects.vertex_array, call.indices.buffer);
    c.gl.bind_buffer(gl::draw_indirect_buffer, c.objects.arguments);
    bind_kernel(c, kernel);
    bind_parameters(c, {0, 0, 0, 0}, kernel.parameters);
    bind_images(c, call.images);
    bind_volumes(c, kernel);
    c.gl.use_program(*program);
    draw_triangles(c, call);
    c.gl.vertex_array_element_buffer(c.objects.vertex_array, 0);
    c.gl.memory_barrier(gl::all_barrier_bits);
    return {};
}

} // namespace skybark::opengl::detail
