// Every state of the caller's is as it was: all that glGet tells, before and after each pattern.

#include "caller.hpp"

#include <map>

namespace skybark::opengl::tests {
namespace {

using kernels::probe_image;
using kernels::probe_map;
using kernels::probe_peel;
using kernels::probe_rings;
using kernels::probe_slabs;
using kernels::probe_strips;
using kernels::probe_volume;
using kernels::probe_volume_draw;
using kernels::probe_voxels;

/// Calls an OpenGL function by its pointer's type and its name.
class caller_functions {
  public:
    explicit caller_functions(const caller_context& context) : context_(context) {}
    template <class Pointer, class... Arguments>
    auto call(const char* name, Arguments... arguments) const {
        return call(reinterpret_cast<Pointer>(context_.find(name)), arguments...);
    }
    template <class Pointer>
    [[nodiscard]] Pointer get(const char* name) const {
        return reinterpret_cast<Pointer>(context_.find(name));
    }

  private:
    /// OpenGL's constants are ints and its enumerations unsigned: each argument as it is declared.
    template <class Result, class... Parameters, class... Arguments>
    static auto call(Result(APIENTRY* function)(Parameters...), Arguments... arguments) {
        return function(static_cast<Parameters>(arguments)...);
    }

    const caller_context& context_;
};
#define GL_CALL(type, name, ...) gl.call<type>(#name __VA_OPT__(, ) __VA_ARGS__)

/// OpenGL's constants are ints.
std::vector<GLenum> names(std::initializer_list<int> list) { return {list.begin(), list.end()}; }

using snapshot = std::map<std::string, std::vector<double>>;

/// What changes by itself: time, free memory, the log of the debug output.
bool is_volatile(GLenum name) {
    return name == GL_TIMESTAMP || (name >= 0x9047 && name <= 0x904B) ||
           (name >= 0x87FB && name <= 0x87FD) || name == GL_DEBUG_LOGGED_MESSAGES ||
           name == GL_DEBUG_NEXT_LOGGED_MESSAGE_LENGTH;
}

std::string hex(GLenum name) {
    char text[16];
    std::snprintf(text, sizeof(text), "0x%04X", name);
    return text;
}

/// Asks for every number that an OpenGL name could have. What is no state is an error and dropped.
class snapshot_maker {
  public:
    explicit snapshot_maker(const caller_functions& gl) : gl_(gl) {}

    snapshot make() {
        state_.clear();
        for (const auto& [first, last] :
             {std::pair{0x0B00u, 0x0E00u}, {0x3000u, 0x3010u}, {0x8000u, 0x9400u}}) {
            for (GLenum name = first; name < last; ++name) {
                if (!is_volatile(name)) {
                    ask(name);
                }
            }
        }
        for (GLenum unit = 0; unit < 14; ++unit) {
            ask_unit(unit);
        }
        for (const GLenum target :
             names({GL_PRIMITIVES_GENERATED, GL_SAMPLES_PASSED, GL_TIME_ELAPSED,
                    GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN})) {
            GLint query = 0;
            gl_.get<PFNGLGETQUERYIVPROC>("glGetQueryiv")(target, GL_CURRENT_QUERY, &query);
            state_["query " + hex(target)] = {static_cast<double>(query)};
        }
        for (const GLenum name :
             names({GL_DEBUG_CALLBACK_FUNCTION, GL_DEBUG_CALLBACK_USER_PARAM})) {
            void* pointer = nullptr;
            gl_.get<PFNGLGETPOINTERVPROC>("glGetPointerv")(name, &pointer);
            state_["pointer " + hex(name)] = {
                static_cast<double>(reinterpret_cast<std::uintptr_t>(pointer))};
        }
        return std::move(state_);
    }

  private:
    static constexpr double unset = -123456789;
    using values = std::array<double, 256>;

    template <class Ask>
    void keep(const std::string& key, Ask&& ask) {
        values got;
        got.fill(unset);
        ask(got.data());
        if (get_error_() != GL_NO_ERROR) {
            return;
        }
        std::size_t size = got.size();
        while (size > 0 && got[size - 1] == unset) {
            --size;
        }
        state_[key].assign(got.begin(), got.begin() + static_cast<std::ptrdiff_t>(size));
    }
    void ask(GLenum name) {
        keep(hex(name), [&](double* out) { get_double_(name, out); });
        keep("enabled " + hex(name), [&](double* out) { *out = is_enabled_(name); });
        for (GLuint i = 0; i < 16; ++i) {
            const std::string at = hex(name) + "[" + std::to_string(i) + "]";
            bool any = false;
            keep(at, [&](double* out) {
                GLint64 value[16] = {};
                get_integer64_i_(name, i, value);
                std::copy(value, value + 16, out);
            });
            any = any || state_.contains(at);
            keep("double " + at, [&](double* out) { get_double_i_(name, i, out); });
            any = any || state_.contains("double " + at);
            keep("enabled " + at, [&](double* out) { *out = is_enabled_i_(name, i); });
            any = any || state_.contains("enabled " + at);
            if (!any && i == 0) {
                break; // not an indexed state
            }
        }
    }
    void ask_unit(GLenum unit) {
        const auto active = gl_.get<PFNGLACTIVETEXTUREPROC>("glActiveTexture");
        GLint before = 0;
        gl_.get<PFNGLGETINTEGERVPROC>("glGetIntegerv")(GL_ACTIVE_TEXTURE, &before);
        active(GL_TEXTURE0 + unit);
        for (const GLenum name :
             names({GL_TEXTURE_BINDING_1D, GL_TEXTURE_BINDING_2D, GL_TEXTURE_BINDING_3D,
                    GL_TEXTURE_BINDING_CUBE_MAP, GL_TEXTURE_BINDING_2D_ARRAY,
                    GL_TEXTURE_BINDING_BUFFER, GL_TEXTURE_BINDING_RECTANGLE,
                    GL_TEXTURE_BINDING_2D_MULTISAMPLE, GL_SAMPLER_BINDING})) {
            keep("unit " + std::to_string(unit) + " " + hex(name),
                 [&](double* out) { get_double_(name, out); });
        }
        active(static_cast<GLenum>(before));
    }

    const caller_functions& gl_;
    snapshot state_;
    PFNGLGETERRORPROC get_error_ = gl_.get<PFNGLGETERRORPROC>("glGetError");
    PFNGLGETDOUBLEVPROC get_double_ = gl_.get<PFNGLGETDOUBLEVPROC>("glGetDoublev");
    PFNGLISENABLEDPROC is_enabled_ = gl_.get<PFNGLISENABLEDPROC>("glIsEnabled");
    PFNGLGETINTEGER64I_VPROC get_integer64_i_ =
        gl_.get<PFNGLGETINTEGER64I_VPROC>("glGetInteger64i_v");
    PFNGLGETDOUBLEI_VPROC get_double_i_ = gl_.get<PFNGLGETDOUBLEI_VPROC>("glGetDoublei_v");
    PFNGLISENABLEDIPROC is_enabled_i_ = gl_.get<PFNGLISENABLEDIPROC>("glIsEnabledi");
};

std::vector<std::string> differences(const snapshot& before, const snapshot& after) {
    std::vector<std::string> found;
    for (const auto& [key, value] : before) {
        const auto other = after.find(key);
        if (other == after.end() || other->second != value) {
            found.push_back(key);
        }
    }
    for (const auto& entry : after) {
        if (!before.contains(entry.first)) {
            found.push_back(entry.first + " (new)");
        }
    }
    return found;
}

GLuint compile(const caller_functions& gl, GLenum stage, const char* text) {
    const GLuint shader = GL_CALL(PFNGLCREATESHADERPROC, glCreateShader, stage);
    GL_CALL(PFNGLSHADERSOURCEPROC, glShaderSource, shader, 1, &text, nullptr);
    GL_CALL(PFNGLCOMPILESHADERPROC, glCompileShader, shader);
    return shader;
}

/// A program of the caller's that records gl_VertexID + 0.5 by transform feedback.
GLuint counting_program(const caller_functions& gl) {
    const GLuint program = GL_CALL(PFNGLCREATEPROGRAMPROC, glCreateProgram);
    GL_CALL(PFNGLATTACHSHADERPROC, glAttachShader, program,
            compile(gl, GL_VERTEX_SHADER,
                    "#version 450\nlayout(xfb_buffer = 0, xfb_offset = 0) out float number;\n"
                    "void main() { number = float(gl_VertexID) + 0.5; gl_Position = vec4(0); }\n"));
    GL_CALL(PFNGLATTACHSHADERPROC, glAttachShader, program,
            compile(gl, GL_FRAGMENT_SHADER, "#version 450\nvoid main() {}\n"));
    GL_CALL(PFNGLLINKPROGRAMPROC, glLinkProgram, program);
    return program;
}

/// Sets whatever there is to something that is not its default and would spoil our work.
void set_unusual_state(const caller_functions& gl) {
    GL_CALL(PFNGLUSEPROGRAMPROC, glUseProgram, counting_program(gl));
    for (const GLenum name : names({GL_DEPTH_TEST,
                                    GL_STENCIL_TEST,
                                    GL_CULL_FACE,
                                    GL_COLOR_LOGIC_OP,
                                    GL_POLYGON_OFFSET_FILL,
                                    GL_POLYGON_SMOOTH,
                                    GL_DEPTH_CLAMP,
                                    GL_FRAMEBUFFER_SRGB,
                                    GL_PRIMITIVE_RESTART,
                                    GL_PRIMITIVE_RESTART_FIXED_INDEX,
                                    GL_SAMPLE_ALPHA_TO_COVERAGE,
                                    GL_SAMPLE_ALPHA_TO_ONE,
                                    GL_SAMPLE_COVERAGE,
                                    GL_SAMPLE_MASK,
                                    GL_SAMPLE_SHADING,
                                    GL_RASTERIZER_DISCARD,
                                    GL_CLIP_DISTANCE0,
                                    GL_CLIP_DISTANCE3,
                                    GL_CLIP_DISTANCE7,
                                    GL_LINE_SMOOTH,
                                    GL_POLYGON_OFFSET_LINE,
                                    GL_PROGRAM_POINT_SIZE,
                                    GL_TEXTURE_CUBE_MAP_SEAMLESS})) {
        GL_CALL(PFNGLENABLEPROC, glEnable, name);
    }
    GL_CALL(PFNGLDISABLEPROC, glDisable, GL_MULTISAMPLE);
    for (const GLuint i : {0u, 2u, 3u}) {
        GL_CALL(PFNGLENABLEIPROC, glEnablei, GL_BLEND, i);
        GL_CALL(PFNGLENABLEIPROC, glEnablei, GL_SCISSOR_TEST, i);
    }
    for (GLuint i = 0; i < 8; ++i) {
        const auto f = static_cast<float>(i);
        GL_CALL(PFNGLCOLORMASKIPROC, glColorMaski, i, GLboolean(i % 2), GLboolean(i / 2 % 2),
                GLboolean(i / 4 % 2), GLboolean(0));
        GL_CALL(PFNGLBLENDFUNCSEPARATEIPROC, glBlendFuncSeparatei, i, GL_DST_COLOR, GL_ZERO + i % 2,
                GL_CONSTANT_ALPHA, GL_SRC_ALPHA_SATURATE);
        GL_CALL(PFNGLBLENDEQUATIONSEPARATEIPROC, glBlendEquationSeparatei, i, GL_MIN,
                GL_FUNC_REVERSE_SUBTRACT);
        GL_CALL(PFNGLVIEWPORTINDEXEDFPROC, glViewportIndexedf, i, f + 1.5f, f + 2.25f, 3.5f, f);
        GL_CALL(PFNGLSCISSORINDEXEDPROC, glScissorIndexed, i, 1, 1, 1, static_cast<int>(i));
        GL_CALL(PFNGLDEPTHRANGEINDEXEDPROC, glDepthRangeIndexed, i, 0.75, 0.125);
    }
    GL_CALL(PFNGLBLENDCOLORPROC, glBlendColor, 0.1f, 0.2f, 0.3f, 0.4f);
    GL_CALL(PFNGLDEPTHFUNCPROC, glDepthFunc, GL_NOTEQUAL);
    GL_CALL(PFNGLDEPTHMASKPROC, glDepthMask, GLboolean(0));
    GL_CALL(PFNGLCULLFACEPROC, glCullFace, GL_FRONT_AND_BACK);
    GL_CALL(PFNGLFRONTFACEPROC, glFrontFace, GL_CW);
    GL_CALL(PFNGLPOLYGONMODEPROC, glPolygonMode, GL_FRONT_AND_BACK, GL_LINE);
    GL_CALL(PFNGLPOLYGONOFFSETPROC, glPolygonOffset, 3.0f, 5.0f);
    GL_CALL(PFNGLCLIPCONTROLPROC, glClipControl, GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    GL_CALL(PFNGLPROVOKINGVERTEXPROC, glProvokingVertex, GL_FIRST_VERTEX_CONVENTION);
    GL_CALL(PFNGLLOGICOPPROC, glLogicOp, GL_XOR);
    GL_CALL(PFNGLSTENCILFUNCPROC, glStencilFunc, GL_NEVER, 3, 0x55u);
    GL_CALL(PFNGLSTENCILMASKPROC, glStencilMask, 0x33u);
    GL_CALL(PFNGLCLEARCOLORPROC, glClearColor, 0.9f, 0.8f, 0.7f, 0.6f);
    GL_CALL(PFNGLCLEARDEPTHPROC, glClearDepth, 0.3);
    GL_CALL(PFNGLCLEARSTENCILPROC, glClearStencil, 7);
    GL_CALL(PFNGLSAMPLECOVERAGEPROC, glSampleCoverage, 0.25f, GLboolean(1));
    GL_CALL(PFNGLSAMPLEMASKIPROC, glSampleMaski, 0u, 0u);
    GL_CALL(PFNGLMINSAMPLESHADINGPROC, glMinSampleShading, 0.5f);
    GL_CALL(PFNGLPRIMITIVERESTARTINDEXPROC, glPrimitiveRestartIndex, 1u);
    GL_CALL(PFNGLLINEWIDTHPROC, glLineWidth, 1.0f);
    GL_CALL(PFNGLPOINTSIZEPROC, glPointSize, 5.0f);
    GL_CALL(PFNGLPATCHPARAMETERIPROC, glPatchParameteri, GL_PATCH_VERTICES, 5);
    for (const GLenum name : names(
             {GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS,
              GL_UNPACK_SKIP_IMAGES, GL_UNPACK_IMAGE_HEIGHT, GL_PACK_ROW_LENGTH, GL_PACK_SKIP_ROWS,
              GL_PACK_SKIP_PIXELS, GL_PACK_SKIP_IMAGES, GL_PACK_IMAGE_HEIGHT})) {
        GL_CALL(PFNGLPIXELSTOREIPROC, glPixelStorei, name, 37);
    }
    for (const GLenum name : names({GL_UNPACK_SWAP_BYTES, GL_UNPACK_LSB_FIRST, GL_PACK_SWAP_BYTES,
                                    GL_PACK_LSB_FIRST, GL_UNPACK_ALIGNMENT, GL_PACK_ALIGNMENT})) {
        GL_CALL(PFNGLPIXELSTOREIPROC, glPixelStorei, name, 1);
    }
    GL_CALL(PFNGLPIXELSTOREIPROC, glPixelStorei, GL_PACK_ALIGNMENT, 8);
}

/// Objects at every binding point that we use, and at some that we don't.
void bind_unusual_objects(const caller_functions& gl) {
    GLuint buffers[40];
    GL_CALL(PFNGLCREATEBUFFERSPROC, glCreateBuffers, 40, buffers);
    for (const GLuint buffer : buffers) {
        GL_CALL(PFNGLNAMEDBUFFERSTORAGEPROC, glNamedBufferStorage, buffer, GLsizeiptr(8192),
                nullptr, GL_DYNAMIC_STORAGE_BIT);
    }
    const auto base = gl.get<PFNGLBINDBUFFERBASEPROC>("glBindBufferBase");
    const auto part = gl.get<PFNGLBINDBUFFERRANGEPROC>("glBindBufferRange");
    for (GLuint i = 0; i < 14; ++i) {
        if (i % 3 == 0) {
            base(GL_SHADER_STORAGE_BUFFER, i, buffers[i]);
        } else if (i % 3 == 1) {
            part(GL_SHADER_STORAGE_BUFFER, i, buffers[i], 256 * i, 1024);
        }
    }
    part(GL_UNIFORM_BUFFER, 0, buffers[14], 256, 512);
    base(GL_UNIFORM_BUFFER, 1, buffers[15]);
    base(GL_ATOMIC_COUNTER_BUFFER, 0, buffers[16]);
    GLuint object = 0;
    GL_CALL(PFNGLCREATETRANSFORMFEEDBACKSPROC, glCreateTransformFeedbacks, 1, &object);
    GL_CALL(PFNGLBINDTRANSFORMFEEDBACKPROC, glBindTransformFeedback, GL_TRANSFORM_FEEDBACK, object);
    part(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffers[17], 64, 128);
    GLuint next = 18;
    for (const GLenum target :
         names({GL_ARRAY_BUFFER, GL_COPY_READ_BUFFER, GL_COPY_WRITE_BUFFER, GL_DRAW_INDIRECT_BUFFER,
                GL_DISPATCH_INDIRECT_BUFFER, GL_PIXEL_PACK_BUFFER, GL_PIXEL_UNPACK_BUFFER,
                GL_QUERY_BUFFER, GL_TEXTURE_BUFFER, GL_SHADER_STORAGE_BUFFER, GL_UNIFORM_BUFFER,
                GL_TRANSFORM_FEEDBACK_BUFFER})) {
        GL_CALL(PFNGLBINDBUFFERPROC, glBindBuffer, target, buffers[next++]);
    }
    GL_CALL(PFNGLCREATEVERTEXARRAYSPROC, glCreateVertexArrays, 1, &object);
    GL_CALL(PFNGLBINDVERTEXARRAYPROC, glBindVertexArray, object);
    GL_CALL(PFNGLBINDBUFFERPROC, glBindBuffer, GL_ELEMENT_ARRAY_BUFFER, buffers[next++]);
    GLuint framebuffers[2];
    GL_CALL(PFNGLCREATEFRAMEBUFFERSPROC, glCreateFramebuffers, 2, framebuffers);
    GL_CALL(PFNGLBINDFRAMEBUFFERPROC, glBindFramebuffer, GL_DRAW_FRAMEBUFFER, framebuffers[0]);
    GL_CALL(PFNGLBINDFRAMEBUFFERPROC, glBindFramebuffer, GL_READ_FRAMEBUFFER, framebuffers[1]);
    GLuint renderbuffer = 0;
    GL_CALL(PFNGLCREATERENDERBUFFERSPROC, glCreateRenderbuffers, 1, &renderbuffer);
    GL_CALL(PFNGLBINDRENDERBUFFERPROC, glBindRenderbuffer, GL_RENDERBUFFER, renderbuffer);
    for (GLuint unit = 0; unit < 13; ++unit) {
        GLuint textures[2];
        GLuint sampler = 0;
        GL_CALL(PFNGLCREATETEXTURESPROC, glCreateTextures, GL_TEXTURE_2D, 1, textures);
        GL_CALL(PFNGLCREATETEXTURESPROC, glCreateTextures, GL_TEXTURE_3D, 1, textures + 1);
        GL_CALL(PFNGLBINDTEXTUREUNITPROC, glBindTextureUnit, unit, textures[0]);
        GL_CALL(PFNGLBINDTEXTUREUNITPROC, glBindTextureUnit, unit, textures[1]);
        GL_CALL(PFNGLCREATESAMPLERSPROC, glCreateSamplers, 1, &sampler);
        GL_CALL(PFNGLBINDSAMPLERPROC, glBindSampler, unit, sampler);
    }
    GL_CALL(PFNGLACTIVETEXTUREPROC, glActiveTexture, GL_TEXTURE5);
    GLuint flat = 0;
    GLuint deep = 0;
    GL_CALL(PFNGLCREATETEXTURESPROC, glCreateTextures, GL_TEXTURE_2D, 1, &flat);
    GL_CALL(PFNGLCREATETEXTURESPROC, glCreateTextures, GL_TEXTURE_3D, 1, &deep);
    GL_CALL(PFNGLTEXTURESTORAGE2DPROC, glTextureStorage2D, flat, 2, GL_RGBA8, 4, 4);
    GL_CALL(PFNGLTEXTURESTORAGE3DPROC, glTextureStorage3D, deep, 2, GL_R32F, 4, 4, 4);
    for (GLuint unit = 0; unit < 8; ++unit) {
        if (unit % 3 == 0) {
            GL_CALL(PFNGLBINDIMAGETEXTUREPROC, glBindImageTexture, unit, flat, 1, GLboolean(0), 0,
                    GL_READ_WRITE, GL_RGBA8UI);
        } else if (unit % 3 == 1) {
            GL_CALL(PFNGLBINDIMAGETEXTUREPROC, glBindImageTexture, unit, deep, 0, GLboolean(0), 2,
                    GL_WRITE_ONLY, GL_R32F);
        }
    }
}

/// What a device does with volumes and words.
template <class After>
class volume_patterns {
  public:
    volume_patterns(gpu& device, After& after) : device_(device), after_(after) {
        const volume_format formats[] = {volume_format::int32, volume_format::int32,
                                         volume_format::float32, volume_format::float16,
                                         volume_format::float32};
        for (std::size_t i = 0; i < volumes_.size(); ++i) {
            volumes_[i] = *device_.create_volume({6, 5, 4, formats[i]});
        }
        after_("create_volume");
        const std::vector<float> voxels(120, 0.5f);
        for (const std::size_t i : {2u, 4u}) {
            EXPECT_TRUE(device_.upload(volumes_[i], std::as_bytes(std::span(voxels))));
        }
        after_("upload volume");
    }

    void record(recorder& r, const image& color) {
        const std::vector<kernels::probe_box> boxes{{{-1, 1, 0, 300}, {4, 9, 3, -2}},
                                                    {{2, -3, 1, -7}, {9, 4, 9, 1}}};
        const std::vector<count_record> two{{2, 2, {0, 0}}};
        boxes_ = *make_buffer<gpu, kernels::probe_box>(device_, boxes);
        length_ = *make_buffer<gpu, count_record>(device_, two);
        const bindings<gpu, probe_slabs> bound{view<gpu>(boxes_)};
        for (const accumulate_route route :
             {accumulate_route::direct, accumulate_route::tiles_copied,
              accumulate_route::tiles_drawn, accumulate_route::layers}) {
            for (const padding policy : {padding::compact, padding::degenerate}) {
                const std::string name =
                    "accumulate " + std::to_string(int(route)) + " " + std::to_string(int(policy));
                r.accumulate(probe_slabs{4, 1, 2, 3}, bound, range{0, 2},
                             {&volumes_[0], policy == padding::compact, route, policy});
                after_(name.c_str());
                r.accumulate(probe_slabs{4, 1, 2, 3}, bound, counted<gpu>{view<gpu>(length_), 9},
                             {&volumes_[0], false, route, policy});
                after_((name + " counted").c_str());
            }
        }
        r.scan(volumes_[0], volumes_[1], {scan_axis::x, scan_direction::ascending});
        r.scan(volumes_[0], volumes_[3], {});
        after_("scan volume");
        places_ = zeros(64);
        numbers_ = zeros(4096);
        sizes_ = zeros(4096);
        r.map(probe_volume{}, {view<gpu>(places_), view<gpu>(numbers_), view<gpu>(sizes_)},
              {{&volumes_[2], &volumes_[3]}, {&volumes_[4]}}, range{0, 2});
        after_("map volumes");
        r.map_voxels(probe_voxels{6, 5, 0.25f}, {view<gpu>(places_), view<gpu>(numbers_)},
                     {{&volumes_[2], &volumes_[3]}, {&volumes_[4], &more()}}, {6, 5, 4});
        after_("map_voxels");
        const std::vector<kernels::probe_vertex> corners(
            3, {glm::vec4(0.5f, 0.5f, 0.5f, 1), glm::vec4(0.5f)});
        corners_ = *make_buffer<gpu, kernels::probe_vertex>(device_, corners);
        source_ = *device_.create_image({2, 2, image_format::rgba8});
        draw_geometry<gpu> geometry;
        geometry.count = 3;
        r.draw(probe_volume_draw{}, {view<gpu>(corners_)}, {sampled_image<gpu>{&source_}},
               {{&volumes_[2], &volumes_[3]}, {}}, geometry, {&color, nullptr, {}, {}}, {});
        after_("draw volumes");
        r.scan({&numbers_, 0, 480}, {&sizes_, 0, 16});
        after_("scan words");
        r.sort({&numbers_, 512, 256}, {&numbers_, 1024, 256});
        r.sort({&numbers_, 512, 256}, {&numbers_, 1024, 256}, {view<gpu>(length_), 64});
        after_("sort");
    }

    void download(std::vector<std::byte>& all) {
        for (const volume& each : volumes_) {
            std::vector<std::byte> bytes(each.description().size_bytes());
            EXPECT_TRUE(device_.download(each, bytes));
            all.insert(all.end(), bytes.begin(), bytes.end());
        }
        for (const buffer* each : {&numbers_, &sizes_}) {
            std::vector<std::byte> bytes(4096);
            EXPECT_TRUE(device_.download(*each, 0, bytes));
            all.insert(all.end(), bytes.begin(), bytes.end());
        }
    }

  private:
    [[nodiscard]] buffer zeros(std::uint64_t bytes) { return *device_.create_buffer(bytes); }
    [[nodiscard]] const volume& more() {
        more_ = *device_.create_volume({6, 5, 4, volume_format::float32});
        return more_;
    }

    gpu& device_;
    After& after_;
    std::array<volume, 5> volumes_;
    volume more_;
    image source_;
    buffer boxes_;
    buffer length_;
    buffer places_;
    buffer numbers_;
    buffer sizes_;
    buffer corners_;
};

/// Everything that a device does, one step at a time, and all that came of it.
class all_patterns {
  public:
    explicit all_patterns(gpu& device) : device_(device) {}

    /// Calls `after(name)` after each step.
    template <class After>
    std::vector<std::byte> run(After&& after) {
        const std::vector<std::uint32_t> numbers{3, 1, 2, 0, 1, 2, 2, 1};
        const std::vector<glm::vec4> vectors(8, glm::vec4(1, 0.5f, 0.25f, 1));
        const std::vector<glm::vec4> corners{{-1, -1, 0.5f, 1}, {0, 0, 0, 0},     {3, -1, 0.5f, 1},
                                             {2, 0, 0, 0},      {-1, 3, 0.5f, 1}, {0, 2, 0, 0}};
        const std::vector<std::uint32_t> pixels{0xff0000ff, 0xff00ff00, 0xffff0000, 0xffffffff};
        const buffer in = *make_buffer<gpu, std::uint32_t>(device_, numbers);
        const buffer payloads = *make_buffer<gpu, glm::vec4>(device_, vectors);
        const buffer screen = *make_buffer<gpu, glm::vec4>(device_, corners);
        const std::vector<std::uint32_t> three{0, 1, 2};
        const buffer indices = *make_buffer<gpu, std::uint32_t>(device_, three);
        const std::vector<count_record> one{{1, 1, {0, 0}}};
        const buffer length = *make_buffer<gpu, count_record>(device_, one);
        const std::vector<glm::vec4> sheet{{-1, -1, 0.5f, 1}, {1, -1, 0.75f, 1}, {-1, 1, 0.25f, 1},
                                           {-1, 1, 0.5f, 1},  {1, -1, 0.5f, 1},  {1, 1, 0.25f, 1}};
        const buffer sheets = *make_buffer<gpu, glm::vec4>(device_, sheet);
        const buffer layers = *make_buffer<gpu, float>(device_, std::vector<float>(256, 1.0f));
        const std::vector<gather_triangle> wall{{{-1, -1, 1}, 0, {1, -1, 1}, 0, {0, 1, 1}, 0}};
        const buffer walls = *make_buffer<gpu, gather_triangle>(device_, wall);
        const std::vector<gather_sample> eye(2, {{0, 0, 0}, 0, {0, 0, 1}, 0});
        const buffer eyes = *make_buffer<gpu, gather_sample>(device_, eye);
        after("make_buffer");
        image source = *device_.create_image({2, 2, image_format::rgba8});
        image color = *device_.create_image({4, 4, image_format::rgba8});
        image depth = *device_.create_image({4, 4, image_format::depth32f});
        after("create_image");
        EXPECT_TRUE(device_.upload(source, std::as_bytes(std::span(pixels))));
        after("upload image");
        buffer outs[8];
        for (buffer& out : outs) {
            out = *device_.create_buffer(4096);
        }
        auto made = device_.begin();
        EXPECT_TRUE(made);
        recorder& r = *made;
        const bindings<gpu, probe_map> mapped{view<gpu>(in), view<gpu>(payloads),
                                              view<gpu>(outs[0]), view<gpu>(outs[1])};
        r.map(probe_map{2, 1, 3, 1}, mapped, range{0, 4});
        after("map");
        const std::vector<range> ranges{{4, 1}, {5, 1}};
        r.map(probe_map{3, 1, 4, 1}, mapped, std::span<const range>(ranges));
        after("map ranges");
        r.map(probe_map{4, 1, 4, 1}, mapped, counted<gpu>{view<gpu>(length), 8});
        after("map counted");
        const bindings<gpu, probe_strips> strips{view<gpu>(in), view<gpu>(payloads)};
        r.expand(probe_strips{2, 3}, strips, range{0, 4},
                 {view<gpu>(outs[2]), {&outs[3], 0, 16}, padding::compact});
        after("expand compact");
        r.expand(probe_strips{2, 3}, strips, range{0, 4},
                 {view<gpu>(outs[4]), {&outs[3], 16, 16}, padding::degenerate});
        after("expand degenerate");
        r.expand(probe_strips{2, 3}, strips, counted<gpu>{view<gpu>(length), 4},
                 {view<gpu>(outs[5]), {&outs[3], 32, 16}, padding::compact});
        after("expand counted");
        r.expand_rings(probe_rings{5}, {view<gpu>(payloads)}, range{0, 4}, view<gpu>(outs[6]));
        after("expand_rings");
        probe_image kernel;
        kernel.read = kernels::probe_read::sample;
        const std::array<sampled_image<gpu>, 2> images{sampled_image<gpu>{&source},
                                                       sampled_image<gpu>{&source}};
        draw_geometry<gpu> geometry;
        geometry.indices = view<gpu>(indices);
        geometry.count = 3;
        r.draw(kernel, {view<gpu>(screen)}, images, geometry,
               {&color, &depth, glm::vec4(0.25f), 1.0f}, {});
        after("draw");
        geometry.length = view<gpu>(length);
        r.draw(kernel, {view<gpu>(screen)}, images, geometry, {&color, &depth, {}, {}},
               {true, true, blend_mode::alpha, cull_mode::back});
        after("draw indirect");
        r.copy({&outs[0], 0, 64}, {&outs[7], 0, 64});
        after("copy");
        r.peel(probe_peel{}, {view<gpu>(sheets)}, range{0, 2},
               {8, 6, {&layers, 0, 192}, {&layers, 256, 192}, {&layers, 512, 16}});
        after("peel");
        const ray_bundle bundle{{0, 0, 0, 2}, {1, 0, 0, 0}, {0, 1, 0, 1}, {0, 0, 1, 4}};
        r.resolve(bundle, {view<gpu>(walls), {}, view<gpu>(eyes), {&layers, 768, 32}});
        r.resolve(bundle, {view<gpu>(walls), view<gpu>(in), view<gpu>(eyes), {&layers, 800, 32}});
        after("resolve");
        volume_patterns volumes(device_, after);
        volumes.record(r, color);
        EXPECT_TRUE(device_.submit(r));
        after("submit");
        std::vector<std::byte> all;
        for (const buffer& out : outs) {
            std::vector<std::byte> bytes(4096);
            EXPECT_TRUE(device_.download(out, 0, bytes));
            all.insert(all.end(), bytes.begin(), bytes.end());
        }
        after("download buffer");
        std::vector<std::byte> peeled(1024);
        EXPECT_TRUE(device_.download(layers, 0, peeled));
        all.insert(all.end(), peeled.begin(), peeled.end());
        std::vector<std::byte> seen(64);
        for (const image* each : {&color, &depth}) {
            EXPECT_TRUE(device_.download(*each, seen));
            all.insert(all.end(), seen.begin(), seen.end());
        }
        after("download image");
        volumes.download(all);
        after("download volume");
        return all;
    }

  private:
    gpu& device_;
};

class state_test : public testing::Test {
  protected:
    void SetUp() override {
        if (!caller.current()) {
            ASSERT_FALSE(required());
            GTEST_SKIP() << "There is no EGL with OpenGL 4.5.";
        }
    }
    caller_context caller;
    caller_functions gl{caller};
};

TEST_F(state_test, is_the_callers_again_after_each_step) {
    snapshot_maker maker(gl);
    const snapshot fresh = maker.make();
    std::vector<std::byte> clean;
    {
        auto made = gpu::create(caller.describe());
        ASSERT_TRUE(made) << made.error().message;
        EXPECT_EQ(differences(fresh, maker.make()), std::vector<std::string>{}) << "create";
        clean = all_patterns(*made).run([&](const char* step) {
            EXPECT_EQ(differences(fresh, maker.make()), std::vector<std::string>{}) << step;
        });
    }
    EXPECT_EQ(differences(fresh, maker.make()), std::vector<std::string>{}) << "destroy";

    set_unusual_state(gl);
    bind_unusual_objects(gl);
    ASSERT_EQ(GL_CALL(PFNGLGETERRORPROC, glGetError), GLenum(GL_NO_ERROR));
    const snapshot unusual = maker.make();
    // The snapshot sees what was set: that many states, and among them these.
    const auto set = differences(fresh, unusual);
    EXPECT_GT(set.size(), 200u);
    for (const GLenum name :
         names({GL_CLIP_DEPTH_MODE, GL_PROVOKING_VERTEX, GL_CURRENT_PROGRAM, GL_SAMPLE_MASK,
                GL_UNPACK_ROW_LENGTH, GL_VERTEX_ARRAY_BINDING})) {
        EXPECT_NE(std::find(set.begin(), set.end(), hex(name)), set.end()) << hex(name);
    }
    auto made = gpu::create(caller.describe());
    ASSERT_TRUE(made) << made.error().message;
    EXPECT_EQ(differences(unusual, maker.make()), std::vector<std::string>{}) << "create";
    const auto got = all_patterns(*made).run([&](const char* step) {
        EXPECT_EQ(differences(unusual, maker.make()), std::vector<std::string>{}) << step;
    });
    EXPECT_EQ(got, clean) << "the caller's state changed our results";
    EXPECT_NE(got, std::vector<std::byte>(got.size()));
}

TEST_F(state_test, a_running_transform_feedback_of_the_callers_goes_on) {
    auto made = gpu::create(caller.describe());
    ASSERT_TRUE(made) << made.error().message;
    const auto clean = all_patterns(*made).run([](const char*) {});
    bind_unusual_objects(gl);
    GLuint framebuffer = 0;
    GL_CALL(PFNGLCREATEFRAMEBUFFERSPROC, glCreateFramebuffers, 1, &framebuffer);
    for (const GLenum name : names({GL_FRAMEBUFFER_DEFAULT_WIDTH, GL_FRAMEBUFFER_DEFAULT_HEIGHT})) {
        GL_CALL(PFNGLNAMEDFRAMEBUFFERPARAMETERIPROC, glNamedFramebufferParameteri, framebuffer,
                name, 1);
    }
    GL_CALL(PFNGLBINDFRAMEBUFFERPROC, glBindFramebuffer, GL_DRAW_FRAMEBUFFER, framebuffer);
    GLuint buffer = 0;
    GL_CALL(PFNGLCREATEBUFFERSPROC, glCreateBuffers, 1, &buffer);
    const std::vector<float> minus(16, -1.0f);
    GL_CALL(PFNGLNAMEDBUFFERSTORAGEPROC, glNamedBufferStorage, buffer, GLsizeiptr(64), minus.data(),
            GLbitfield(0));
    GL_CALL(PFNGLBINDBUFFERBASEPROC, glBindBufferBase, GL_TRANSFORM_FEEDBACK_BUFFER, 0u, buffer);
    GL_CALL(PFNGLUSEPROGRAMPROC, glUseProgram, counting_program(gl));
    GL_CALL(PFNGLBEGINTRANSFORMFEEDBACKPROC, glBeginTransformFeedback, GL_POINTS);
    GL_CALL(PFNGLDRAWARRAYSPROC, glDrawArrays, GL_POINTS, 0, 2);
    EXPECT_EQ(all_patterns(*made).run([](const char*) {}), clean);
    GL_CALL(PFNGLDRAWARRAYSPROC, glDrawArrays, GL_POINTS, 7, 1);
    GL_CALL(PFNGLENDTRANSFORMFEEDBACKPROC, glEndTransformFeedback);
    EXPECT_EQ(GL_CALL(PFNGLGETERRORPROC, glGetError), GLenum(GL_NO_ERROR));
    std::vector<float> got(5);
    GL_CALL(PFNGLGETNAMEDBUFFERSUBDATAPROC, glGetNamedBufferSubData, buffer, GLintptr(0),
            GLsizeiptr(20), got.data());
    EXPECT_EQ(got, (std::vector<float>{0.5f, 1.5f, 7.5f, -1, -1}));
}

TEST_F(state_test, a_query_of_the_callers_that_we_need_ourselves_is_an_error) {
    auto made = gpu::create(caller.describe());
    ASSERT_TRUE(made) << made.error().message;
    const buffer counts = *made->create_buffer(64);
    const buffer count = *made->create_buffer(16);
    GLuint query = 0;
    GL_CALL(PFNGLCREATEQUERIESPROC, glCreateQueries, GL_PRIMITIVES_GENERATED, 1, &query);
    GL_CALL(PFNGLBEGINQUERYPROC, glBeginQuery, GL_PRIMITIVES_GENERATED, query);
    const auto expand = [&](recorder& r) {
        r.expand(probe_strips{1, 1}, {view<gpu>(counts), view<gpu>(counts)}, range{0, 4},
                 {view<gpu>(counts), view<gpu>(count), padding::degenerate});
    };
    const auto done = run(*made, expand);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().code, error_code::unavailable);
    GL_CALL(PFNGLENDQUERYPROC, glEndQuery, GL_PRIMITIVES_GENERATED);
    EXPECT_TRUE(run(*made, expand));
}

TEST_F(state_test, errors_of_the_callers_are_not_taken_for_ours) {
    auto made = gpu::create(caller.describe());
    ASSERT_TRUE(made) << made.error().message;
    GL_CALL(PFNGLENABLEPROC, glEnable, GLenum(0xFFFF));
    EXPECT_TRUE(made->create_buffer(16));
    GL_CALL(PFNGLENABLEPROC, glEnable, GLenum(0xFFFF));
    EXPECT_TRUE(run(*made, [](recorder&) {}));
}

} // namespace
} // namespace skybark::opengl::tests
