#pragma once
// Drawn accumulations: the paper's own way (Shimada et al. 2008, sections 3.3 to 4.3). A slab is
// a rectangle that is drawn with additive blending, a pixel a voxel.
//
//   tiles_copied  into a large image, a tile a layer, whose tiles are copied to a 3-D texture
//   tiles_drawn   the same, but the layers of the 3-D texture are drawn from the tiles
//   layers        straight into the layers of a 3-D texture, each rectangle into its own
//
//   degenerate    slabs() rectangles an element, the spare ones degenerate: made in the vertex
//                 stage, or with `layers`, where only a geometry stage can choose one, there
//   compact       a point an element becomes as many rectangles as there are, in a geometry stage
//
// Sums are exact. An amount n is blended as two floats, 256 · high + low with −128 ≤ low < 128.
// Floats hold whole numbers to 2²⁴, so that the sum of the high parts is exact while the sum of the
// amounts is an int32, and that of the low ones for 2¹⁷ amounts to a voxel. After as many
// rectangles, wherever they lie, a carry makes room for as many again. In the end 256 · high + low
// is added to the int32 volume, or takes the place of what is there. A caller keeps every sum, in
// the order of the elements, within an int32: sums that leave it on the way are exact with the
// direct route alone.
//
// The textures that are drawn into, 8 bytes a voxel and with tiles as much again, are kept by the
// context and only grow: calls for volumes that have been there, in any order, allocate nothing.
// What lies beyond a volume in a target that is larger is left alone.

#include <skybark/opengl/programs/own_add_sums.hpp>
#include <skybark/opengl/programs/own_carry.hpp>
#include <skybark/opengl/programs/own_tile.hpp>
#include <skybark/opengl/programs/own_whole_target.hpp>
#include <skybark/opengl/volume_patterns.hpp>

#include <bit>

namespace skybark::opengl::detail {

/// The image units of the targets, to read them from shaders.
inline constexpr std::uint32_t tiles_unit = 5;
inline constexpr std::uint32_t layers_unit = 6;

/// One less than 2¹⁷: what is left of a carry counts like one more amount.
inline constexpr std::uint32_t exact_rectangles = (1u << 17) - 1;
/// Of one invocation of the geometry stage: four vertices of seven components each, of 1,024.
inline constexpr std::uint32_t max_rectangles_a_point = 32;

// Of slabs.vert and slabs.geom: flags of the header.
inline constexpr std::uint32_t padded_flag = 2;
inline constexpr std::uint32_t points_flag = 8;

/// How the layers of a volume lie in a target, and how many at a time.
struct layer_plan {
    glm::uvec2 layer{0};       ///< sides of a layer
    std::uint32_t columns = 0; ///< tiles in a row; 0: each layer is a layer of the target
    std::uint32_t layers = 0;  ///< in a turn
    glm::uvec2 target{0};      ///< sides of the target
};

[[nodiscard]] inline layer_plan plan_layers(const context& c, const volume_description& size,
                                            accumulate_route route) {
    const std::uint64_t bytes = sum_bytes({size.width, size.height, 1});
    layer_plan plan;
    plan.layer = {size.width, size.height};
    plan.layers = static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(c.max_target_bytes / bytes, 1, size.depth));
    plan.target = plan.layer;
    if (route == accumulate_route::layers) {
        plan.layers = std::min(plan.layers, c.max_layers);
        return plan;
    }
    const std::uint32_t most = c.limits.max_image_size;
    std::uint32_t side = 1;
    while (side * side < plan.layers) {
        ++side;
    }
    plan.columns = std::min(side, most / size.width);
    const std::uint32_t rows = std::min((plan.layers - 1) / plan.columns + 1, most / size.height);
    plan.layers = std::min(plan.layers, plan.columns * rows);
    plan.target = {plan.columns * size.width, rows * size.height};
    return plan;
}

/// How elements become vertices.
struct rectangle_plan {
    bool points = false;            ///< a point a part, and a geometry stage
    std::uint32_t part = 0;         ///< rectangles of a point
    std::uint32_t vertices = 0;     ///< an element
    std::uint32_t elements = 0;     ///< a draw: as many as can be summed exactly
    std::uint32_t max_vertices = 0; ///< that the geometry stage emits at a time; 0: there is none
};

[[nodiscard]] inline rectangle_plan plan_rectangles(const slab_call& out) {
    rectangle_plan plan;
    plan.points = out.policy == padding::compact || out.route == accumulate_route::layers;
    plan.elements = exact_rectangles / out.slabs;
    plan.vertices = 6 * out.slabs;
    if (plan.points) {
        const std::uint32_t parts = (out.slabs - 1) / max_rectangles_a_point + 1;
        plan.part = (out.slabs - 1) / parts + 1;
        plan.vertices = (out.slabs - 1) / plan.part + 1;
        // Few kinds of programs, and not one more whenever an element has one slab more.
        plan.max_vertices = 4 * std::bit_ceil(plan.part);
    }
    return plan;
}

inline void bind_sums(context& c, std::uint32_t unit, gl::token access) {
    const gl::handle texture = unit == tiles_unit ? c.objects.sums.tiles : c.objects.sums.layers;
    c.gl.bind_image_texture(unit, texture, 0, 1, 0, access, gl::rg32f);
}

/// The programs of a drawn accumulation.
struct sum_programs {
    gl::handle draw = 0;
    gl::handle carry = 0;
    gl::handle add = 0;
    gl::handle tile = 0;
};

[[nodiscard]] inline result<sum_programs> find_sum_programs(context& c, const slab_call& out,
                                                            std::uint32_t max_vertices) {
    const shader_stage with_points[] = {{gl::vertex_shader, out.vertex_text},
                                        {gl::geometry_shader, out.geometry_text},
                                        {gl::fragment_shader, out.fragment_text}};
    const shader_stage without[] = {with_points[0], with_points[2]};
    const shader_stage carry[] = {{gl::compute_shader, carry_comp}};
    const shader_stage add[] = {{gl::compute_shader, add_sums_comp}};
    const shader_stage tile[] = {{gl::vertex_shader, whole_target_vert},
                                 {gl::fragment_shader, tile_frag}};
    sum_programs found;
    const auto find = [&c](std::span<const shader_stage> stages, std::uint32_t most,
                           gl::handle& program) -> result<void> {
        const auto made = c.find_program(stages, most);
        if (!made) {
            return failure(made.error());
        }
        program = *made;
        return {};
    };
    auto done = max_vertices != 0 ? find(with_points, max_vertices, found.draw)
                                  : find(without, 0, found.draw);
    for (const auto& [stages, program] :
         {std::pair{std::span<const shader_stage>(carry), &found.carry},
          std::pair{std::span<const shader_stage>(add), &found.add},
          std::pair{std::span<const shader_stage>(tile), &found.tile}}) {
        if (done) {
            done = find(stages, 0, *program);
        }
    }
    if (!done) {
        return failure(done.error());
    }
    return found;
}

/// What the turns of one drawn accumulation have in common.
struct sum_drawing {
    const kernel_call& call;
    const element_range& elements;
    const slab_call& out;
    layer_plan layers;
    rectangle_plan rectangles;
    sum_programs programs;
};

/// Low parts of all sums go over to the high ones.
inline void carry_sums(context& c, const sum_drawing& d, std::uint32_t layers) {
    const bool tiled = d.layers.columns != 0;
    bind_parameters(c, {tiled ? 0u : 1u, d.layers.target.x, 0, 0}, {});
    c.gl.use_program(d.programs.carry);
    c.gl.memory_barrier(gl::all_barrier_bits);
    c.gl.dispatch_compute((d.layers.target.x + 63) / 64, d.layers.target.y, tiled ? 1 : layers);
    c.gl.memory_barrier(gl::all_barrier_bits);
}

/// Draws all elements' rectangles in the layers [first, first + count) of the volume.
[[nodiscard]] inline result<void> draw_rectangles(context& c, const sum_drawing& d,
                                                  std::uint32_t first, std::uint32_t count) {
    const bool counted = d.elements.length.buffer != 0;
    const bool tiled = d.layers.columns != 0;
    const std::uint32_t flags = (d.out.policy == padding::degenerate ? padded_flag : 0u) |
                                (d.rectangles.points ? points_flag : 0u);
    const gl::handle frame = tiled ? c.objects.sums.tiles_frame : c.objects.sums.layers_frame;
    const auto& layer = d.layers.layer;
    const auto& target = d.layers.target;
    c.gl.program_uniform_4i(d.programs.draw, 0, static_cast<int>(layer.x),
                            static_cast<int>(layer.y), static_cast<int>(first),
                            static_cast<int>(count));
    c.gl.program_uniform_4i(d.programs.draw, 1, static_cast<int>(d.layers.columns), 0,
                            static_cast<int>(target.x), static_cast<int>(target.y));
    c.gl.bind_framebuffer(gl::draw_framebuffer, frame);
    set_pixel_raster(c.gl, target, true);
    c.gl.clear_tex_sub_image(tiled ? c.objects.sums.tiles : c.objects.sums.layers, 0, 0, 0, 0,
                             static_cast<int>(target.x), static_cast<int>(target.y),
                             static_cast<int>(tiled ? 1 : count), gl::rg, gl::float32, nullptr);
    for (std::uint32_t done = 0; done < d.elements.count;) {
        const std::uint32_t now = std::min(d.rectangles.elements, d.elements.count - done);
        if (done != 0) {
            carry_sums(c, d, count);
        }
        if (counted) {
            indirect_call arguments;
            arguments.kind = indirect_call::arrays;
            arguments.skip = done;
            arguments.most = now;
            arguments.each = d.rectangles.vertices;
            if (auto written = write_arguments(c, arguments, d.elements.length); !written) {
                return written;
            }
        }
        bind_parameters(c, {d.elements.first + done, now, d.rectangles.part, flags},
                        d.call.parameters);
        c.gl.use_program(d.programs.draw);
        const gl::token primitive = d.rectangles.points ? gl::points : gl::triangles;
        if (counted) {
            c.gl.draw_arrays_indirect(primitive, nullptr);
        } else {
            c.gl.draw_arrays(primitive, 0, static_cast<int>(now * d.rectangles.vertices));
        }
        done += now;
    }
    c.gl.memory_barrier(gl::all_barrier_bits);
    return {};
}

/// The tile of each layer goes to the 3-D texture, from the framebuffer.
inline void copy_tiles(context& c, const layer_plan& plan, std::uint32_t count) {
    c.gl.bind_framebuffer(gl::read_framebuffer, c.objects.sums.tiles_frame);
    for (std::uint32_t n = 0; n < count; ++n) {
        const std::uint32_t x = n % plan.columns * plan.layer.x;
        const std::uint32_t y = n / plan.columns * plan.layer.y;
        c.gl.copy_texture_sub_image_3d(
            c.objects.sums.layers, 0, 0, 0, static_cast<int>(n), static_cast<int>(x),
            static_cast<int>(y), static_cast<int>(plan.layer.x), static_cast<int>(plan.layer.y));
    }
}

/// The same by drawing into each layer.
inline void draw_tiles(context& c, gl::handle program, const layer_plan& plan,
                       std::uint32_t count) {
    const gl::handle frame = c.objects.sums.layer_frame;
    bind_sums(c, tiles_unit, gl::read_only);
    set_pixel_raster(c.gl, plan.layer, false);
    c.gl.use_program(program);
    for (std::uint32_t n = 0; n < count; ++n) {
        const std::uint32_t x = n % plan.columns * plan.layer.x;
        const std::uint32_t y = n / plan.columns * plan.layer.y;
        c.gl.named_framebuffer_texture_layer(frame, gl::color_attachment0, c.objects.sums.layers, 0,
                                             static_cast<int>(n));
        c.gl.bind_framebuffer(gl::draw_framebuffer, frame);
        c.gl.program_uniform_4i(program, 0, static_cast<int>(x), static_cast<int>(y), 0, 0);
        c.gl.draw_arrays(gl::triangles, 0, 3);
    }
    // Not while it is bound: a framebuffer of nothing would be incomplete.
    c.gl.bind_framebuffer(gl::draw_framebuffer, c.objects.sums.tiles_frame);
    c.gl.named_framebuffer_texture(frame, gl::color_attachment0, 0, 0);
}

/// The sums of `count` layers go to the volume, from its layer `first` on.
inline void add_sums(context& c, const sum_drawing& d, std::uint32_t first, std::uint32_t count) {
    bind_parameters(c, {d.out.clear ? 1u : 0u, first, d.layers.layer.x, 0}, {});
    c.gl.use_program(d.programs.add);
    c.gl.memory_barrier(gl::all_barrier_bits);
    c.gl.dispatch_compute((d.layers.layer.x + 63) / 64, d.layers.layer.y, count);
    c.gl.memory_barrier(gl::all_barrier_bits);
}

[[nodiscard]] inline result<void> size_targets(context& c, const layer_plan& plan) {
    if (plan.columns != 0) {
        if (auto done = c.size_tiles(plan.target); !done) {
            return done;
        }
    }
    return c.size_layers({plan.layer.x, plan.layer.y, plan.layers});
}

[[nodiscard]] inline result<void> draw_sums(context& c, const kernel_call& call,
                                            const element_range& elements, const slab_call& out) {
    assert(out.into.size.format == volume_format::int32 && "sums are int32");
    if (elements.count == 0 || out.slabs == 0) {
        if (out.clear) {
            clear_volume(c, out.into);
        }
        return {};
    }
    if (out.slabs > exact_rectangles) {
        return fail(error_code::out_of_memory, "An element of " + std::to_string(out.slabs) +
                                                   " slabs is more than one draw can sum exactly.");
    }
    const layer_plan layers = plan_layers(c, out.into.size, out.route);
    const rectangle_plan rectangles = plan_rectangles(out);
    const auto programs = find_sum_programs(c, out, rectangles.max_vertices);
    if (!programs) {
        return failure(programs.error());
    }
    if (auto done = size_targets(c, layers); !done) {
        return done;
    }
    const sum_drawing drawing{call, elements, out, layers, rectangles, *programs};
    const saved_program saved(c.gl);
    const saved_buffers saved_too(c.gl, kernel_mask(call) | mask_of(length_binding) |
                                            mask_of(arguments_binding));
    const saved_drawing saved_drawing_state(c.gl);
    const saved_read_framebuffer saved_source(c.gl);
    const saved_raster saved_raster_state(c.gl);
    const saved_image_units saved_units(c.gl, sums_unit, 3);
    c.gl.bind_vertex_array(c.objects.vertex_array);
    c.gl.bind_buffer(gl::draw_indirect_buffer, c.objects.arguments);
    bind_kernel(c, call);
    for (std::uint32_t first = 0; first < out.into.size.depth; first += layers.layers) {
        const std::uint32_t count = std::min(layers.layers, out.into.size.depth - first);
        bind_volume(c, sums_unit, out.into, gl::read_write);
        bind_sums(c, tiles_unit, gl::read_write);
        bind_sums(c, layers_unit, gl::read_write);
        if (auto done = draw_rectangles(c, drawing, first, count); !done) {
            return done;
        }
        if (out.route == accumulate_route::tiles_copied) {
            copy_tiles(c, layers, count);
        } else if (out.route == accumulate_route::tiles_drawn) {
            draw_tiles(c, programs->tile, layers, count);
        }
        add_sums(c, drawing, first, count);
    }
    return {};
}

} // namespace skybark::opengl::detail
