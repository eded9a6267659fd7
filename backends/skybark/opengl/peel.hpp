#pragma once
// Peeling: triangles are drawn with a depth test into a texture of words, whose pixels then go to
// the caller's views. What is drawn into is kept by the context: peels of the same size allocate
// nothing.

#include <skybark/core/when_used.hpp>
#include <skybark/opengl/patterns.hpp>
#include <skybark/opengl/programs/own_peel.hpp>
#include <skybark/opengl/programs/own_peeled.hpp>

namespace skybark::opengl::detail {

/// A peel without types.
struct peel_call {
    std::string_view vertex_text;
    glm::uvec2 size{0};
    bound_range depth;
    bound_range triangle;
    bound_range count;
};

// Of peel.glsl and peeled.glsl.
inline constexpr std::uint32_t peel_depth_binding = 8;
inline constexpr std::uint32_t peel_triangle_binding = 9;
inline constexpr std::uint32_t peel_count_binding = 10;
inline constexpr std::uint32_t peel_group = 256; ///< pixels
/// A draw has fewer than 2³¹ vertices.
inline constexpr std::uint32_t most_drawn_triangles = 0x7fffffffu / 3;

/// The farthest fragments stay. Depths begin at 0, so that fragments of depth 0 are not drawn.
template <class = when_used>
void begin_layer(context& c, const glm::uvec2& size) {
    const gl::handle frame = c.objects.layer.frame;
    c.gl.bind_framebuffer(gl::draw_framebuffer, frame);
    set_pixel_raster(c.gl, size, false);
    c.gl.enable(gl::depth_test);
    c.gl.depth_func(gl::greater);
    c.gl.depth_mask(1);
    const std::uint32_t nothing[] = {0xffffffffu, 0, 0, 0};
    const float farthest = 0;
    c.gl.clear_named_framebuffer_words(frame, gl::color, 0, nothing);
    c.gl.clear_named_framebuffer(frame, gl::depth, 0, &farthest);
}

template <class = when_used>
void draw_layer(context& c, gl::handle program, const kernel_call& kernel, const range& triangles,
                std::uint32_t width) {
    c.gl.bind_vertex_array(c.objects.vertex_array);
    c.gl.use_program(program);
    for (std::uint32_t done = 0; done < triangles.count;) {
        const std::uint32_t now = std::min(triangles.count - done, most_drawn_triangles);
        bind_parameters(c, {triangles.first + done, width, 0, 0}, kernel.parameters);
        c.gl.draw_arrays(gl::triangles, 0, static_cast<int>(3 * now));
        done += now;
    }
    c.gl.memory_barrier(gl::all_barrier_bits);
}

/// Pixels go to the caller's views.
template <class = when_used>
void take_layer(context& c, gl::handle program, const peel_call& call) {
    const std::uint32_t pixels = call.size.x * call.size.y;
    bind_parameters(c, {call.size.x, pixels, 0, 0}, {});
    bind(c, gl::shader_storage_buffer, peel_triangle_binding, call.triangle);
    bind(c, gl::shader_storage_buffer, peel_count_binding, call.count);
    c.gl.active_texture(gl::texture0);
    c.gl.bind_texture(gl::texture_2d, c.objects.layer.fragments);
    c.gl.bind_sampler(0, c.objects.samplers[0]);
    dispatch(c, program, (pixels - 1) / peel_group + 1);
}

template <class = when_used>
[[nodiscard]] result<void> peel(context& c, const kernel_call& kernel, const range& triangles,
                                const peel_call& call) {
    const shader_stage draw_stages[] = {{gl::vertex_shader, call.vertex_text},
                                        {gl::fragment_shader, peel_frag}};
    const shader_stage take_stages[] = {{gl::compute_shader, peeled_comp}};
    const auto draw = c.find_program(draw_stages);
    const auto take = c.find_program(take_stages);
    if (!draw || !take) {
        return failure(draw ? take.error() : draw.error());
    }
    c.gl.clear_named_buffer_sub_data(call.count.buffer, gl::r32ui, call.count.offset,
                                     sizeof(count_record), gl::red_integer, gl::unsigned_int,
                                     nullptr);
    if (call.size.x == 0 || call.size.y == 0) {
        return {};
    }
    if (auto done = c.size_layer(call.size); !done) {
        return done;
    }
    const saved_program saved(c.gl);
    const saved_buffers saved_too(c.gl, kernel_mask(kernel) | mask_of(peel_depth_binding) |
                                            mask_of(peel_triangle_binding) |
                                            mask_of(peel_count_binding));
    const saved_drawing saved_drawing_state(c.gl);
    const saved_raster saved_raster_state(c.gl);
    const saved_textures saved_image(c.gl, flat_texture, 0, 1);
    bind_kernel(c, kernel);
    bind(c, gl::shader_storage_buffer, peel_depth_binding, call.depth);
    begin_layer(c, call.size);
    draw_layer(c, *draw, kernel, triangles, call.size.x);
    take_layer(c, *take, call);
    return {};
}

} // namespace skybark::opengl::detail
