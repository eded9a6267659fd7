#pragma once
// What a pattern changes of the caller's OpenGL state, and puts back.
//
// Each class below saves when it is made and restores when it goes out of scope, in the reverse
// order. Objects are reached by name wherever OpenGL 4.5 allows it, so this is all that is ever
// touched: what is not listed here stays as it is. Own objects (a vertex array, a framebuffer, a
// transform feedback) shield the caller's from being edited.

#include <skybark/opengl/context.hpp>

namespace skybark::opengl::detail {

[[nodiscard]] inline gl::handle get_handle(const gl::functions& gl, gl::token name) {
    int value = 0;
    gl.get_integer(name, &value);
    return static_cast<gl::handle>(value);
}

/// The program in use. A transform feedback of the caller's that is running is paused: it would
/// forbid another program, and would record what we draw.
class saved_program {
  public:
    explicit saved_program(const gl::functions& functions) : gl_(functions) {
        program_ = get_handle(gl_, gl::current_program);
        paused_ = get_handle(gl_, gl::transform_feedback_active) != 0 &&
                  get_handle(gl_, gl::transform_feedback_paused) == 0;
        if (paused_) {
            gl_.pause_transform_feedback();
        }
    }
    ~saved_program() {
        gl_.use_program(program_);
        if (paused_) {
            gl_.resume_transform_feedback();
        }
    }
    saved_program(const saved_program&) = delete;
    saved_program& operator=(const saved_program&) = delete;

  private:
    const gl::functions& gl_;
    gl::handle program_ = 0;
    bool paused_ = false;
};

/// The uniform buffer at binding 0 and the storage buffers at the bindings in `mask`. Our own are
/// bound by glBindBuffersRange, which leaves the generic bindings alone.
class saved_buffers {
  public:
    saved_buffers(const gl::functions& functions, std::uint32_t mask)
        : gl_(functions), mask_(mask) {
        uniform_ =
            get(gl::uniform_buffer_binding, gl::uniform_buffer_start, gl::uniform_buffer_size, 0);
        for (std::uint32_t i = 0; i < storage_.size(); ++i) {
            if ((mask_ >> i & 1) != 0) {
                storage_[i] =
                    get(gl::shader_storage_buffer_binding, gl::shader_storage_buffer_start,
                        gl::shader_storage_buffer_size, i);
            }
        }
    }
    ~saved_buffers() {
        set(gl::uniform_buffer, 0, uniform_);
        for (std::uint32_t i = 0; i < storage_.size(); ++i) {
            if ((mask_ >> i & 1) != 0) {
                set(gl::shader_storage_buffer, i, storage_[i]);
            }
        }
    }
    saved_buffers(const saved_buffers&) = delete;
    saved_buffers& operator=(const saved_buffers&) = delete;

  private:
    [[nodiscard]] bound_range get(gl::token binding, gl::token start, gl::token size,
                                  std::uint32_t i) const {
        int buffer = 0;
        std::int64_t offset = 0;
        std::int64_t bytes = 0;
        gl_.get_integer_i(binding, i, &buffer);
        if (buffer != 0) {
            gl_.get_integer64_i(start, i, &offset);
            gl_.get_integer64_i(size, i, &bytes);
        }
        return {static_cast<gl::handle>(buffer), static_cast<std::ptrdiff_t>(offset),
                static_cast<std::ptrdiff_t>(bytes)};
    }
    void set(gl::token target, std::uint32_t i, const bound_range& range) const {
        if (range.size == 0) { // bound whole, by glBindBufferBase, or not at all
            gl_.bind_buffers_base(target, i, 1, &range.buffer);
        } else {
            gl_.bind_buffers_range(target, i, 1, &range.buffer, &range.offset, &range.size);
        }
    }

    const gl::functions& gl_;
    std::uint32_t mask_ = 0;
    bound_range uniform_;
    std::array<bound_range, 12> storage_{};
};

/// A generic buffer binding.
class saved_binding {
  public:
    saved_binding(const gl::functions& functions, gl::token target, gl::token name)
        : gl_(functions), target_(target), buffer_(get_handle(functions, name)) {}
    ~saved_binding() { gl_.bind_buffer(target_, buffer_); }
    saved_binding(const saved_binding&) = delete;
    saved_binding& operator=(const saved_binding&) = delete;

  private:
    const gl::functions& gl_;
    gl::token target_;
    gl::handle buffer_;
};

/// Capabilities, which are all switched off.
template <std::size_t N>
class saved_capabilities {
  public:
    saved_capabilities(const gl::functions& functions, const std::array<gl::token, N>& names)
        : gl_(functions), names_(names) {
        for (std::size_t i = 0; i < N; ++i) {
            on_[i] = gl_.is_enabled(names_[i]) != 0;
            if (on_[i]) {
                gl_.disable(names_[i]);
            }
        }
    }
    ~saved_capabilities() {
        for (std::size_t i = 0; i < N; ++i) {
            on_[i] ? gl_.enable(names_[i]) : gl_.disable(names_[i]);
        }
    }
    saved_capabilities(const saved_capabilities&) = delete;
    saved_capabilities& operator=(const saved_capabilities&) = delete;

  private:
    const gl::functions& gl_;
    const std::array<gl::token, N>& names_;
    std::array<bool, N> on_{};
};

/// What any draw needs: a vertex array, a framebuffer, the order of a triangle's vertices.
class saved_drawing {
  public:
    explicit saved_drawing(const gl::functions& functions)
        : gl_(functions),
          indirect_(functions, gl::draw_indirect_buffer, gl::draw_indirect_buffer_binding),
          vertex_array_(get_handle(functions, gl::vertex_array_binding)),
          framebuffer_(get_handle(functions, gl::draw_framebuffer_binding)),
          provoking_vertex_(get_handle(functions, gl::provoking_vertex)),
          discard_(functions.is_enabled(gl::rasterizer_discard) != 0) {
        // Odd triangles of a strip come out as (t + 1, t, t + 2) where the last vertex provokes.
        gl_.provoking_vertex(gl::last_vertex_convention);
    }
    ~saved_drawing() {
        gl_.bind_vertex_array(vertex_array_);
        gl_.bind_framebuffer(gl::draw_framebuffer, framebuffer_);
        gl_.provoking_vertex(provoking_vertex_);
        discard_ ? gl_.enable(gl::rasterizer_discard) : gl_.disable(gl::rasterizer_discard);
    }
    saved_drawing(const saved_drawing&) = delete;
    saved_drawing& operator=(const saved_drawing&) = delete;

  private:
    const gl::functions& gl_;
    saved_binding indirect_;
    gl::handle vertex_array_;
    gl::handle framebuffer_;
    gl::token provoking_vertex_;
    bool discard_;
};

/// The framebuffer that is copied from.
class saved_read_framebuffer {
  public:
    explicit saved_read_framebuffer(const gl::functions& functions)
        : gl_(functions), framebuffer_(get_handle(functions, gl::read_framebuffer_binding)) {}
    ~saved_read_framebuffer() { gl_.bind_framebuffer(gl::read_framebuffer, framebuffer_); }
    saved_read_framebuffer(const saved_read_framebuffer&) = delete;
    saved_read_framebuffer& operator=(const saved_read_framebuffer&) = delete;

  private:
    const gl::functions& gl_;
    gl::handle framebuffer_;
};

/// The transform feedback object.
class saved_feedback {
  public:
    explicit saved_feedback(const gl::functions& functions)
        : gl_(functions), object_(get_handle(functions, gl::transform_feedback_binding)) {}
    ~saved_feedback() { gl_.bind_transform_feedback(gl::transform_feedback, object_); }
    saved_feedback(const saved_feedback&) = delete;
    saved_feedback& operator=(const saved_feedback&) = delete;

  private:
    const gl::functions& gl_;
    gl::handle object_;
};

/// What would change a pixel, or keep it from being drawn, and is not ours to set otherwise.
inline constexpr std::array<gl::token, 15> disturbing_capabilities = {
    gl::stencil_test,
    gl::color_logic_op,
    gl::polygon_offset_fill,
    gl::polygon_smooth,
    gl::depth_clamp,
    gl::dither,
    gl::framebuffer_srgb,
    gl::primitive_restart,
    gl::primitive_restart_fixed_index,
    gl::sample_alpha_to_coverage,
    gl::sample_alpha_to_one,
    gl::sample_coverage,
    gl::sample_mask,
    gl::sample_shading,
    gl::rasterizer_discard,
};
/// A plane that no shader writes a distance for clips as it likes.
inline constexpr std::array<gl::token, 8> clip_planes = {
    gl::clip_distance0,     gl::clip_distance0 + 1, gl::clip_distance0 + 2, gl::clip_distance0 + 3,
    gl::clip_distance0 + 4, gl::clip_distance0 + 5, gl::clip_distance0 + 6, gl::clip_distance0 + 7};

/// The fixed functions around a fragment shader: those of viewport 0 and of draw buffer 0.
class saved_raster {
  public:
    explicit saved_raster(const gl::functions& functions)
        : gl_(functions), disturbing_(functions, disturbing_capabilities),
          clipping_(functions, clip_planes) {
        gl_.get_float_i(gl::viewport, 0, viewport_.data());
        gl_.get_double_i(gl::depth_range, 0, depth_range_.data());
        scissor_ = gl_.is_enabled_i(gl::scissor_test, 0) != 0;
        blend_ = gl_.is_enabled_i(gl::blend, 0) != 0;
        depth_test_ = gl_.is_enabled(gl::depth_test) != 0;
        cull_ = gl_.is_enabled(gl::cull_face) != 0;
        gl_.get_boolean_i(gl::color_writemask, 0, color_mask_.data());
        for (std::size_t i = 0; i < blend_state_.size(); ++i) {
            int value = 0;
            gl_.get_integer_i(blend_names[i], 0, &value);
            blend_state_[i] = static_cast<gl::token>(value);
        }
        for (std::size_t i = 0; i < state_.size(); ++i) {
            // Some drivers write both faces' polygon mode.
            int value[2] = {};
            gl_.get_integer(state_names[i], value);
            state_[i] = static_cast<gl::token>(value[0]);
        }
    }
    ~saved_raster() {
        gl_.viewport_indexed(0, viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
        gl_.depth_range_indexed(0, depth_range_[0], depth_range_[1]);
        scissor_ ? gl_.enable_i(gl::scissor_test, 0) : gl_.disable_i(gl::scissor_test, 0);
        blend_ ? gl_.enable_i(gl::blend, 0) : gl_.disable_i(gl::blend, 0);
        depth_test_ ? gl_.enable(gl::depth_test) : gl_.disable(gl::depth_test);
        cull_ ? gl_.enable(gl::cull_face) : gl_.disable(gl::cull_face);
        gl_.color_mask_i(0, color_mask_[0], color_mask_[1], color_mask_[2], color_mask_[3]);
        gl_.blend_func_separate_i(0, blend_state_[0], blend_state_[1], blend_state_[2],
                                  blend_state_[3]);
        gl_.blend_equation_separate_i(0, blend_state_[4], blend_state_[5]);
        gl_.depth_func(state_[0]);
        gl_.depth_mask(static_cast<gl::boolean>(state_[1] != 0));
        gl_.cull_face(state_[2]);
        gl_.front_face(state_[3]);
        gl_.polygon_mode(gl::front_and_back, state_[4]);
        gl_.clip_control(state_[5], state_[6]);
    }
    saved_raster(const saved_raster&) = delete;
    saved_raster& operator=(const saved_raster&) = delete;

  private:
    static constexpr std::array<gl::token, 6> blend_names = {
        gl::blend_src_rgb,   gl::blend_dst_rgb,      gl::blend_src_alpha,
        gl::blend_dst_alpha, gl::blend_equation_rgb, gl::blend_equation_alpha};
    static constexpr std::array<gl::token, 7> state_names = {
        gl::depth_func,   gl::depth_writemask, gl::cull_face_mode, gl::front_face,
        gl::polygon_mode, gl::clip_origin,     gl::clip_depth_mode};

    const gl::functions& gl_;
    saved_capabilities<15> disturbing_;
    saved_capabilities<8> clipping_;
    std::array<float, 4> viewport_{};
    std::array<double, 2> depth_range_{};
    std::array<gl::boolean, 4> color_mask_{};
    std::array<gl::token, 6> blend_state_{};
    std::array<gl::token, 7> state_{};
    bool scissor_ = false;
    bool blend_ = false;
    bool depth_test_ = false;
    bool cull_ = false;
};

/// A kind of texture, and what tells which one of it is bound.
struct texture_target {
    gl::token target = gl::texture_2d;
    gl::token binding = gl::texture_binding_2d;
};
inline constexpr texture_target flat_texture{gl::texture_2d, gl::texture_binding_2d};
inline constexpr texture_target deep_texture{gl::texture_3d, gl::texture_binding_3d};

inline constexpr texture_target buffer_texture{gl::texture_target_buffer,
                                               gl::texture_binding_buffer};

/// The textures of one kind, and the samplers, of the units [first, first + count).
class saved_textures {
  public:
    saved_textures(const gl::functions& functions, texture_target kind, std::size_t first,
                   std::size_t count)
        : gl_(functions), kind_(kind), first_(first), count_(count) {
        if (count_ == 0) {
            return;
        }
        active_ = get_handle(gl_, gl::active_texture);
        for (std::size_t i = 0; i < count_; ++i) {
            gl_.active_texture(gl::texture0 + static_cast<gl::token>(first_ + i));
            textures_[i] = get_handle(gl_, kind_.binding);
            samplers_[i] = get_handle(gl_, gl::sampler_binding);
        }
    }
    ~saved_textures() {
        if (count_ == 0) {
            return;
        }
        for (std::size_t i = 0; i < count_; ++i) {
            gl_.active_texture(gl::texture0 + static_cast<gl::token>(first_ + i));
            gl_.bind_texture(kind_.target, textures_[i]);
            gl_.bind_sampler(static_cast<gl::handle>(first_ + i), samplers_[i]);
        }
        gl_.active_texture(active_);
    }
    saved_textures(const saved_textures&) = delete;
    saved_textures& operator=(const saved_textures&) = delete;

  private:
    const gl::functions& gl_;
    texture_target kind_;
    std::size_t first_;
    std::size_t count_;
    gl::token active_ = 0;
    std::array<gl::handle, max_kernel_images> textures_{};
    std::array<gl::handle, max_kernel_images> samplers_{};
};

/// What shaders load from and store to, of the image units [first, first + count).
class saved_image_units {
  public:
    saved_image_units(const gl::functions& functions, std::uint32_t first, std::size_t count)
        : gl_(functions), first_(first), count_(count) {
        for (std::uint32_t i = 0; i < count_; ++i) {
            for (std::size_t n = 0; n < names.size(); ++n) {
                gl_.get_integer_i(names[n], first_ + i, &units_[i][n]);
            }
        }
    }
    ~saved_image_units() {
        for (std::uint32_t i = 0; i < count_; ++i) {
            const auto& [texture, level, layered, layer, access, format] = units_[i];
            gl_.bind_image_texture(first_ + i, static_cast<gl::handle>(texture), level,
                                   static_cast<gl::boolean>(layered), layer,
                                   static_cast<gl::token>(access), static_cast<gl::token>(format));
        }
    }
    saved_image_units(const saved_image_units&) = delete;
    saved_image_units& operator=(const saved_image_units&) = delete;

  private:
    static constexpr std::array<gl::token, 6> names = {
        gl::image_binding_name,  gl::image_binding_level,  gl::image_binding_layered,
        gl::image_binding_layer, gl::image_binding_access, gl::image_binding_format};

    const gl::functions& gl_;
    std::uint32_t first_;
    std::size_t count_;
    std::array<std::array<int, 6>, 8> units_{};
};

/// How pixels lie in the memory that an image is copied from or to; set to packed rows.
class saved_pixel_store {
  public:
    /// `upload`: the unpacking half of the state, else the packing half.
    saved_pixel_store(const gl::functions& functions, bool upload)
        : gl_(functions), names_(upload ? unpack_names : pack_names),
          buffer_(functions, upload ? gl::pixel_unpack_buffer : gl::pixel_pack_buffer,
                  upload ? gl::pixel_unpack_buffer_binding : gl::pixel_pack_buffer_binding) {
        for (std::size_t i = 0; i < names_.size(); ++i) {
            gl_.get_integer(names_[i], &values_[i]);
            gl_.pixel_store(names_[i], names_[i] == alignment(upload) ? 1 : 0);
        }
        gl_.bind_buffer(upload ? gl::pixel_unpack_buffer : gl::pixel_pack_buffer, 0);
    }
    ~saved_pixel_store() {
        for (std::size_t i = 0; i < names_.size(); ++i) {
            gl_.pixel_store(names_[i], values_[i]);
        }
    }
    saved_pixel_store(const saved_pixel_store&) = delete;
    saved_pixel_store& operator=(const saved_pixel_store&) = delete;

  private:
    using names = std::array<gl::token, 8>;
    static constexpr names unpack_names = {gl::unpack_swap_bytes,  gl::unpack_lsb_first,
                                           gl::unpack_row_length,  gl::unpack_skip_rows,
                                           gl::unpack_skip_pixels, gl::unpack_alignment,
                                           gl::unpack_skip_images, gl::unpack_image_height};
    static constexpr names pack_names = {
        gl::pack_swap_bytes,  gl::pack_lsb_first, gl::pack_row_length,  gl::pack_skip_rows,
        gl::pack_skip_pixels, gl::pack_alignment, gl::pack_skip_images, gl::pack_image_height};
    [[nodiscard]] static gl::token alignment(bool upload) {
        return upload ? gl::unpack_alignment : gl::pack_alignment;
    }

    const gl::functions& gl_;
    const names& names_;
    saved_binding buffer_;
    std::array<int, 8> values_{};
};

} // namespace skybark::opengl::detail
