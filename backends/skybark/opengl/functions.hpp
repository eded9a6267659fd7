#pragma once
// The OpenGL functions that this backend calls: our own types, constants and table.
//
// There is one table for each context, filled by that context's own get_proc_address: two contexts
// of one process may come from two libraries. No OpenGL header is included and no macro is left
// behind, so that nothing here meets glad, epoxy or GL/gl.h in the same source file.

#include <cstddef>
#include <cstdint>

#if defined(_WIN32) && !defined(_WIN64)
#    define SKYBARK_OPENGL_CALL __stdcall
#else
#    define SKYBARK_OPENGL_CALL
#endif

namespace skybark::opengl {

/// What a context's get_proc_address returns. Loaders return a pointer for names that do not exist,
/// too: what a context can do is told by its version alone.
using procedure = void (*)();
using get_procedure = procedure (*)(const char* name, void* user);

namespace gl {

using handle = std::uint32_t; ///< GLuint: the name of an object
using token = std::uint32_t;  ///< GLenum
using boolean = unsigned char;

// clang-format off
inline constexpr token none = 0, one = 1, no_error = 0, points = 0, triangles = 4;
inline constexpr token invalid_enum = 0x0500, invalid_value = 0x0501, invalid_operation = 0x0502, out_of_memory = 0x0505,
    invalid_framebuffer_operation = 0x0506, context_lost = 0x0507;
inline constexpr token renderer = 0x1F01, version = 0x1F02, major_version = 0x821B,
    minor_version = 0x821C, context_profile_mask = 0x9126, context_core_profile_bit = 1;
inline constexpr token max_texture_size = 0x0D33, max_shader_storage_block_size = 0x90DE,
    max_shader_storage_buffer_bindings = 0x90DD, max_vertex_shader_storage_blocks = 0x90D6,
    max_geometry_shader_storage_blocks = 0x90D7, max_fragment_shader_storage_blocks = 0x90DA,
    max_compute_shader_storage_blocks = 0x90DB, shader_storage_buffer_offset_alignment = 0x90DF,
    uniform_buffer_offset_alignment = 0x8A34;
inline constexpr token dynamic_storage_bit = 0x0100,
    shader_storage_buffer = 0x90D2, shader_storage_buffer_binding = 0x90D3,
    shader_storage_buffer_start = 0x90D4, shader_storage_buffer_size = 0x90D5,
    uniform_buffer = 0x8A11, uniform_buffer_binding = 0x8A28, uniform_buffer_start = 0x8A29,
    uniform_buffer_size = 0x8A2A, draw_indirect_buffer = 0x8F3F, draw_indirect_buffer_binding = 0x8F43,
    dispatch_indirect_buffer = 0x90EE, dispatch_indirect_buffer_binding = 0x90EF,
    pixel_pack_buffer = 0x88EB, pixel_pack_buffer_binding = 0x88ED, pixel_unpack_buffer = 0x88EC,
    pixel_unpack_buffer_binding = 0x88EF;
inline constexpr token fragment_shader = 0x8B30, vertex_shader = 0x8B31, geometry_shader = 0x8DD9,
    compute_shader = 0x91B9, compile_status = 0x8B81, link_status = 0x8B82, info_log_length = 0x8B84,
    current_program = 0x8B8D;
inline constexpr token transform_feedback = 0x8E22, transform_feedback_binding = 0x8E25,
    transform_feedback_paused = 0x8E23, transform_feedback_active = 0x8E24,
    transform_feedback_primitives_written = 0x8C88, primitives_generated = 0x8C87,
    rasterizer_discard = 0x8C89, query_result = 0x8866, current_query = 0x8865;
inline constexpr token vertex_array_binding = 0x85B5, draw_framebuffer = 0x8CA9,
    draw_framebuffer_binding = 0x8CA6, color_attachment0 = 0x8CE0,
    depth_attachment = 0x8D00, framebuffer_default_width = 0x9310,
    framebuffer_default_height = 0x9311, color = 0x1800, depth = 0x1801;
inline constexpr token texture_2d = 0x0DE1, texture_binding_2d = 0x8069, texture0 = 0x84C0,
    active_texture = 0x84E0, sampler_binding = 0x8919, rgba = 0x1908, rgba8 = 0x8058, rgba32f = 0x8814,
    depth_component = 0x1902, depth_component32f = 0x8CAC, r32ui = 0x8236,
    rg32ui = 0x823C, rgba32ui = 0x8D70,
    texture_target_buffer = 0x8C2A, texture_binding_buffer = 0x8C2C, max_texture_buffer_size = 0x8C2B,
    red_integer = 0x8D94, unsigned_byte = 0x1401, unsigned_int = 0x1405, float32 = 0x1406,
    texture_mag_filter = 0x2800, texture_min_filter = 0x2801, texture_wrap_s = 0x2802,
    texture_wrap_t = 0x2803, nearest = 0x2600, linear = 0x2601, repeat = 0x2901,
    clamp_to_edge = 0x812F;
inline constexpr token viewport = 0x0BA2, depth_range = 0x0B70, scissor_test = 0x0C11,
    depth_test = 0x0B71, depth_func = 0x0B74, depth_writemask = 0x0B72, lequal = 0x0203, greater = 0x0204,
    always = 0x0207, stencil_test = 0x0B90, blend = 0x0BE2, blend_src_rgb = 0x80C9,
    blend_dst_rgb = 0x80C8, blend_src_alpha = 0x80CB, blend_dst_alpha = 0x80CA,
    blend_equation_rgb = 0x8009, blend_equation_alpha = 0x883D, func_add = 0x8006,
    one_minus_src_alpha = 0x0303, color_writemask = 0x0C23, color_logic_op = 0x0BF2,
    cull_face = 0x0B44, cull_face_mode = 0x0B45, back = 0x0405, front_face = 0x0B46, ccw = 0x0901,
    polygon_mode = 0x0B40, front_and_back = 0x0408, fill = 0x1B02, polygon_offset_fill = 0x8037, polygon_smooth = 0x0B41,
    depth_clamp = 0x864F, clip_distance0 = 0x3000, clip_origin = 0x935C, clip_depth_mode = 0x935D,
    upper_left = 0x8CA2, lower_left = 0x8CA1, zero_to_one = 0x935F, provoking_vertex = 0x8E4F,
    last_vertex_convention = 0x8E4E, dither = 0x0BD0, framebuffer_srgb = 0x8DB9, sample_alpha_to_coverage = 0x809E, sample_alpha_to_one = 0x809F,
    sample_coverage = 0x80A0, sample_mask = 0x8E51, sample_shading = 0x8C36,
    primitive_restart = 0x8F9D, primitive_restart_fixed_index = 0x8D69;
inline constexpr token unpack_swap_bytes = 0x0CF0, unpack_lsb_first = 0x0CF1,
    unpack_row_length = 0x0CF2, unpack_skip_rows = 0x0CF3, unpack_skip_pixels = 0x0CF4,
    unpack_alignment = 0x0CF5, unpack_skip_images = 0x806D, unpack_image_height = 0x806E,
    pack_swap_bytes = 0x0D00, pack_lsb_first = 0x0D01, pack_row_length = 0x0D02,
    pack_skip_rows = 0x0D03, pack_skip_pixels = 0x0D04, pack_alignment = 0x0D05,
    pack_skip_images = 0x806B, pack_image_height = 0x806C;
inline constexpr token texture_3d = 0x806F, texture_binding_3d = 0x806A, texture_wrap_r = 0x8072,
    max_3d_texture_size = 0x8073, max_image_units = 0x8F38, max_fragment_image_uniforms = 0x90CE, max_framebuffer_layers = 0x9317, r32i = 0x8235, r32f = 0x822E,
    r16f = 0x822D, rg32f = 0x8230, red = 0x1903, rg = 0x8227, int32 = 0x1404, float16 = 0x140B,
    read_framebuffer = 0x8CA8, read_framebuffer_binding = 0x8CAA;
inline constexpr token image_binding_name = 0x8F3A, image_binding_level = 0x8F3B,
    image_binding_layered = 0x8F3C, image_binding_layer = 0x8F3D, image_binding_access = 0x8F3E,
    image_binding_format = 0x906E, read_only = 0x88B8, write_only = 0x88B9, read_write = 0x88BA;
inline constexpr token all_barrier_bits = 0xFFFFFFFF;
inline constexpr token debug_output = 0x92E0, debug_output_synchronous = 0x8242,
    debug_callback_user_param = 0x8245, debug_severity_high = 0x9146, debug_severity_medium = 0x9147,
    debug_severity_low = 0x9148, debug_source_application = 0x824A,
    max_debug_group_stack_depth = 0x826C, debug_group_stack_depth = 0x826D;
/// What glObjectLabel calls the kinds of objects; of transform feedbacks as above.
inline constexpr token object_buffer = 0x82E0, object_shader = 0x82E1, object_program = 0x82E2,
    object_query = 0x82E3, object_sampler = 0x82E6, object_vertex_array = 0x8074,
    object_texture = 0x1702, object_framebuffer = 0x8D40;
// clang-format on

using debug_procedure = void(SKYBARK_OPENGL_CALL*)(token source, token type, handle id,
                                                   token severity, int length, const char* message,
                                                   const void* user);

} // namespace gl

// clang-format off
// Result, our name, OpenGL's name, parameters.
#define SKYBARK_OPENGL_FUNCTIONS(X) \
    X(token, get_error, "glGetError", ()) \
    X(token, get_graphics_reset_status, "glGetGraphicsResetStatus", ()) \
    X(const unsigned char*, get_string, "glGetString", (token)) \
    X(void, get_integer, "glGetIntegerv", (token, int*)) \
    X(void, get_integer64, "glGetInteger64v", (token, std::int64_t*)) \
    X(void, get_integer_i, "glGetIntegeri_v", (token, handle, int*)) \
    X(void, get_integer64_i, "glGetInteger64i_v", (token, handle, std::int64_t*)) \
    X(void, get_float_i, "glGetFloati_v", (token, handle, float*)) \
    X(void, get_double_i, "glGetDoublei_v", (token, handle, double*)) \
    X(void, get_boolean_i, "glGetBooleani_v", (token, handle, boolean*)) \
    X(void, get_pointer, "glGetPointerv", (token, void**)) \
    X(boolean, is_enabled, "glIsEnabled", (token)) \
    X(boolean, is_enabled_i, "glIsEnabledi", (token, handle)) \
    X(void, enable, "glEnable", (token)) \
    X(void, disable, "glDisable", (token)) \
    X(void, enable_i, "glEnablei", (token, handle)) \
    X(void, disable_i, "glDisablei", (token, handle)) \
    X(void, finish, "glFinish", ()) \
    X(void, memory_barrier, "glMemoryBarrier", (token)) \
    X(void, debug_message_callback, "glDebugMessageCallback", (debug_procedure, const void*)) \
    X(void, object_label, "glObjectLabel", (token, handle, int, const char*)) \
    X(void, push_debug_group, "glPushDebugGroup", (token, handle, int, const char*)) \
    X(void, pop_debug_group, "glPopDebugGroup", ()) \
    X(void, create_buffers, "glCreateBuffers", (int, handle*)) \
    X(void, delete_buffers, "glDeleteBuffers", (int, const handle*)) \
    X(void, named_buffer_storage, "glNamedBufferStorage", (handle, std::ptrdiff_t, const void*, token)) \
    X(void, named_buffer_sub_data, "glNamedBufferSubData", (handle, std::ptrdiff_t, std::ptrdiff_t, const void*)) \
    X(void, get_named_buffer_sub_data, "glGetNamedBufferSubData", (handle, std::ptrdiff_t, std::ptrdiff_t, void*)) \
    X(void, copy_named_buffer_sub_data, "glCopyNamedBufferSubData", (handle, handle, std::ptrdiff_t, std::ptrdiff_t, std::ptrdiff_t)) \
    X(void, clear_named_buffer_data, "glClearNamedBufferData", (handle, token, token, token, const void*)) \
    X(void, clear_named_buffer_sub_data, "glClearNamedBufferSubData", (handle, token, std::ptrdiff_t, std::ptrdiff_t, token, token, const void*)) \
    X(void, bind_buffer, "glBindBuffer", (token, handle)) \
    X(void, bind_buffers_base, "glBindBuffersBase", (token, handle, int, const handle*)) \
    X(void, bind_buffers_range, "glBindBuffersRange", (token, handle, int, const handle*, const std::ptrdiff_t*, const std::ptrdiff_t*)) \
    X(handle, create_shader, "glCreateShader", (token)) \
    X(void, delete_shader, "glDeleteShader", (handle)) \
    X(void, shader_source, "glShaderSource", (handle, int, const char* const*, const int*)) \
    X(void, compile_shader, "glCompileShader", (handle)) \
    X(void, get_shader, "glGetShaderiv", (handle, token, int*)) \
    X(void, get_shader_info_log, "glGetShaderInfoLog", (handle, int, int*, char*)) \
    X(handle, create_program, "glCreateProgram", ()) \
    X(void, delete_program, "glDeleteProgram", (handle)) \
    X(void, attach_shader, "glAttachShader", (handle, handle)) \
    X(void, link_program, "glLinkProgram", (handle)) \
    X(void, get_program, "glGetProgramiv", (handle, token, int*)) \
    X(void, get_program_info_log, "glGetProgramInfoLog", (handle, int, int*, char*)) \
    X(void, use_program, "glUseProgram", (handle)) \
    X(void, program_uniform_4i, "glProgramUniform4i", (handle, int, int, int, int, int)) \
    X(void, dispatch_compute, "glDispatchCompute", (handle, handle, handle)) \
    X(void, dispatch_compute_indirect, "glDispatchComputeIndirect", (std::ptrdiff_t)) \
    X(void, create_vertex_arrays, "glCreateVertexArrays", (int, handle*)) \
    X(void, delete_vertex_arrays, "glDeleteVertexArrays", (int, const handle*)) \
    X(void, bind_vertex_array, "glBindVertexArray", (handle)) \
    X(void, vertex_array_element_buffer, "glVertexArrayElementBuffer", (handle, handle)) \
    X(void, create_transform_feedbacks, "glCreateTransformFeedbacks", (int, handle*)) \
    X(void, delete_transform_feedbacks, "glDeleteTransformFeedbacks", (int, const handle*)) \
    X(void, bind_transform_feedback, "glBindTransformFeedback", (token, handle)) \
    X(void, transform_feedback_buffer_range, "glTransformFeedbackBufferRange", (handle, handle, handle, std::ptrdiff_t, std::ptrdiff_t)) \
    X(void, transform_feedback_buffer_base, "glTransformFeedbackBufferBase", (handle, handle, handle)) \
    X(void, begin_transform_feedback, "glBeginTransformFeedback", (token)) \
    X(void, end_transform_feedback, "glEndTransformFeedback", ()) \
    X(void, pause_transform_feedback, "glPauseTransformFeedback", ()) \
    X(void, resume_transform_feedback, "glResumeTransformFeedback", ()) \
    X(void, create_queries, "glCreateQueries", (token, int, handle*)) \
    X(void, delete_queries, "glDeleteQueries", (int, const handle*)) \
    X(void, begin_query, "glBeginQuery", (token, handle)) \
    X(void, end_query, "glEndQuery", (token)) \
    X(void, get_query, "glGetQueryiv", (token, token, int*)) \
    X(void, get_query_buffer_object, "glGetQueryBufferObjectuiv", (handle, handle, token, std::ptrdiff_t)) \
    X(void, draw_arrays, "glDrawArrays", (token, int, int)) \
    X(void, draw_arrays_indirect, "glDrawArraysIndirect", (token, const void*)) \
    X(void, draw_elements_base_vertex, "glDrawElementsBaseVertex", (token, int, token, const void*, int)) \
    X(void, draw_elements_indirect, "glDrawElementsIndirect", (token, token, const void*)) \
    X(void, create_framebuffers, "glCreateFramebuffers", (int, handle*)) \
    X(void, delete_framebuffers, "glDeleteFramebuffers", (int, const handle*)) \
    X(void, bind_framebuffer, "glBindFramebuffer", (token, handle)) \
    X(void, named_framebuffer_texture, "glNamedFramebufferTexture", (handle, token, handle, int)) \
    X(void, named_framebuffer_texture_layer, "glNamedFramebufferTextureLayer", (handle, token, handle, int, int)) \
    X(void, named_framebuffer_parameter, "glNamedFramebufferParameteri", (handle, token, int)) \
    X(void, named_framebuffer_draw_buffer, "glNamedFramebufferDrawBuffer", (handle, token)) \
    X(void, clear_named_framebuffer, "glClearNamedFramebufferfv", (handle, token, int, const float*)) \
    X(void, clear_named_framebuffer_words, "glClearNamedFramebufferuiv", (handle, token, int, const std::uint32_t*)) \
    X(void, create_textures, "glCreateTextures", (token, int, handle*)) \
    X(void, delete_textures, "glDeleteTextures", (int, const handle*)) \
    X(void, texture_buffer, "glTextureBuffer", (handle, token, handle)) \
    X(void, texture_storage_2d, "glTextureStorage2D", (handle, int, token, int, int)) \
    X(void, texture_sub_image_2d, "glTextureSubImage2D", (handle, int, int, int, int, int, token, token, const void*)) \
    X(void, texture_storage_3d, "glTextureStorage3D", (handle, int, token, int, int, int)) \
    X(void, texture_sub_image_3d, "glTextureSubImage3D", (handle, int, int, int, int, int, int, int, token, token, const void*)) \
    X(void, copy_texture_sub_image_3d, "glCopyTextureSubImage3D", (handle, int, int, int, int, int, int, int, int)) \
    X(void, clear_tex_image, "glClearTexImage", (handle, int, token, token, const void*)) \
    X(void, clear_tex_sub_image, "glClearTexSubImage", (handle, int, int, int, int, int, int, int, token, token, const void*)) \
    X(void, bind_image_texture, "glBindImageTexture", (handle, handle, int, boolean, int, token, token)) \
    X(void, get_texture_image, "glGetTextureImage", (handle, int, token, token, int, void*)) \
    X(void, get_texture_sub_image, "glGetTextureSubImage", (handle, int, int, int, int, int, int, int, token, token, int, void*)) \
    X(void, active_texture, "glActiveTexture", (token)) \
    X(void, bind_texture, "glBindTexture", (token, handle)) \
    X(void, create_samplers, "glCreateSamplers", (int, handle*)) \
    X(void, delete_samplers, "glDeleteSamplers", (int, const handle*)) \
    X(void, sampler_parameter, "glSamplerParameteri", (handle, token, int)) \
    X(void, bind_sampler, "glBindSampler", (handle, handle)) \
    X(void, viewport_indexed, "glViewportIndexedf", (handle, float, float, float, float)) \
    X(void, depth_range_indexed, "glDepthRangeIndexed", (handle, double, double)) \
    X(void, depth_func, "glDepthFunc", (token)) \
    X(void, depth_mask, "glDepthMask", (boolean)) \
    X(void, blend_func_separate_i, "glBlendFuncSeparatei", (handle, token, token, token, token)) \
    X(void, blend_equation_separate_i, "glBlendEquationSeparatei", (handle, token, token)) \
    X(void, color_mask_i, "glColorMaski", (handle, boolean, boolean, boolean, boolean)) \
    X(void, cull_face, "glCullFace", (token)) \
    X(void, front_face, "glFrontFace", (token)) \
    X(void, polygon_mode, "glPolygonMode", (token, token)) \
    X(void, clip_control, "glClipControl", (token, token)) \
    X(void, provoking_vertex, "glProvokingVertex", (token)) \
    X(void, pixel_store, "glPixelStorei", (token, int))
// clang-format on

namespace gl {

/// One context's functions.
struct functions {
#define SKYBARK_OPENGL_MEMBER(result, name, text, parameters)                                      \
    result(SKYBARK_OPENGL_CALL* name) parameters = nullptr;
    SKYBARK_OPENGL_FUNCTIONS(SKYBARK_OPENGL_MEMBER)
#undef SKYBARK_OPENGL_MEMBER
};

/// Fills the table. Returns the name of the first function that there is not, or null.
[[nodiscard]] inline const char* load(functions& table, get_procedure get, void* user) {
    const char* missing = nullptr;
#define SKYBARK_OPENGL_LOAD(result, name, text, parameters)                                        \
    table.name =                                                                                   \
        reinterpret_cast<result(SKYBARK_OPENGL_CALL*) parameters>(get(text, user)); /* NOLINT */   \
    if (table.name == nullptr && missing == nullptr) {                                             \
        missing = text;                                                                            \
    }
    SKYBARK_OPENGL_FUNCTIONS(SKYBARK_OPENGL_LOAD)
#undef SKYBARK_OPENGL_LOAD
    return missing;
}

} // namespace gl
} // namespace skybark::opengl

#undef SKYBARK_OPENGL_FUNCTIONS
#undef SKYBARK_OPENGL_CALL
