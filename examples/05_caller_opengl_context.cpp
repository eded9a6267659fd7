// A program that has an OpenGL context already: it lends it, with whatever state it happens to be
// in, and finds that state as it was after a tree's branches were made and drawn.
//
// What is Skybark's is in `main`; the rest is what such a program has anyway, and the check.

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <skybark/kernels/cast_shadow.hpp>
#include <skybark/opengl/opengl.hpp>
#include <skybark/skybark.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>
#include <vector>

namespace {

namespace trees = skybark::trees;
using backend = skybark::opengl::device;

constexpr int no_such_backend = 3;

[[noreturn]] void stop(int status, const std::string& why) {
    std::fprintf(stderr, "%s\n", why.c_str());
    std::exit(status);
}
template <class T>
T value_of(skybark::result<T> made) {
    if (!made) {
        stop(1, made.error().message);
    }
    return std::move(*made);
}

/// The program's context, here an EGL one without a surface, current in this thread.
struct program {
    decltype(&eglGetProcAddress) get_proc_address = nullptr;

    program() {
        void* library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
        if (library == nullptr) {
            stop(no_such_backend, "There is no EGL on this machine.");
        }
        const auto find = [&](const char* name) { return dlsym(library, name); };
        get_proc_address =
            reinterpret_cast<decltype(&eglGetProcAddress)>(find("eglGetProcAddress"));
        const auto initialize = reinterpret_cast<decltype(&eglInitialize)>(find("eglInitialize"));
        const auto bind_api = reinterpret_cast<decltype(&eglBindAPI)>(find("eglBindAPI"));
        const auto create = reinterpret_cast<decltype(&eglCreateContext)>(find("eglCreateContext"));
        const auto make_current =
            reinterpret_cast<decltype(&eglMakeCurrent)>(find("eglMakeCurrent"));
        const auto get_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
            get_proc_address("eglGetPlatformDisplayEXT"));
        const EGLDisplay display = get_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
        initialize(display, nullptr, nullptr);
        bind_api(EGL_OPENGL_API);
        const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                     4,
                                     EGL_CONTEXT_MINOR_VERSION,
                                     5,
                                     EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                     EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                     EGL_NONE};
        const EGLContext context = create(display, EGLConfig(nullptr), EGL_NO_CONTEXT, attributes);
        if (context == EGL_NO_CONTEXT ||
            make_current(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_FALSE) {
            stop(no_such_backend, "EGL makes no context of OpenGL 4.5 without a surface.");
        }
    }

    template <class Function>
    [[nodiscard]] Function call(const char* name) const {
        return reinterpret_cast<Function>(get_proc_address(name));
    }

    /// The program is in the middle of something of its own.
    void set_unusual_state() const {
        const auto enable = call<PFNGLENABLEPROC>("glEnable");
        for (const GLenum capability :
             {GLenum{GL_SCISSOR_TEST}, GLenum{GL_STENCIL_TEST}, GLenum{GL_BLEND},
              GLenum{GL_CULL_FACE}, GLenum{GL_POLYGON_OFFSET_FILL}, GLenum{GL_DEPTH_CLAMP}}) {
            enable(capability);
        }
        call<PFNGLVIEWPORTPROC>("glViewport")(3, 5, 17, 19);
        call<PFNGLSCISSORPROC>("glScissor")(1, 2, 3, 4);
        call<PFNGLDEPTHFUNCPROC>("glDepthFunc")(GL_GEQUAL);
        call<PFNGLDEPTHMASKPROC>("glDepthMask")(GL_FALSE);
        call<PFNGLBLENDFUNCPROC>("glBlendFunc")(GL_DST_COLOR, GL_ZERO);
        call<PFNGLFRONTFACEPROC>("glFrontFace")(GL_CW);
        call<PFNGLCULLFACEPROC>("glCullFace")(GL_FRONT);
        call<PFNGLPOLYGONMODEPROC>("glPolygonMode")(GL_FRONT_AND_BACK, GL_LINE);
        call<PFNGLCOLORMASKPROC>("glColorMask")(GL_TRUE, GL_FALSE, GL_TRUE, GL_FALSE);
        call<PFNGLCLIPCONTROLPROC>("glClipControl")(GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
        call<PFNGLPIXELSTOREIPROC>("glPixelStorei")(GL_PACK_ROW_LENGTH, 37);
        GLuint buffers[3] = {};
        call<PFNGLCREATEBUFFERSPROC>("glCreateBuffers")(3, buffers);
        for (const GLuint buffer : buffers) {
            call<PFNGLNAMEDBUFFERSTORAGEPROC>("glNamedBufferStorage")(buffer, 4096, nullptr, 0);
        }
        call<PFNGLBINDBUFFERBASEPROC>("glBindBufferBase")(GL_SHADER_STORAGE_BUFFER, 0, buffers[0]);
        call<PFNGLBINDBUFFERRANGEPROC>("glBindBufferRange")(GL_UNIFORM_BUFFER, 0, buffers[1], 256,
                                                            512);
        call<PFNGLBINDBUFFERPROC>("glBindBuffer")(GL_PIXEL_PACK_BUFFER, buffers[2]);
        GLuint vertex_array = 0;
        call<PFNGLCREATEVERTEXARRAYSPROC>("glCreateVertexArrays")(1, &vertex_array);
        call<PFNGLBINDVERTEXARRAYPROC>("glBindVertexArray")(vertex_array);
        GLuint framebuffer = 0;
        call<PFNGLCREATEFRAMEBUFFERSPROC>("glCreateFramebuffers")(1, &framebuffer);
        call<PFNGLBINDFRAMEBUFFERPROC>("glBindFramebuffer")(GL_FRAMEBUFFER, framebuffer);
        call<PFNGLACTIVETEXTUREPROC>("glActiveTexture")(GL_TEXTURE3);
    }

    /// A good part of what OpenGL tells of its state. tests/opengl/state.cpp asks for all of it.
    [[nodiscard]] std::vector<double> state() const {
        std::vector<double> all;
        const auto get = call<PFNGLGETDOUBLEVPROC>("glGetDoublev");
        for (const int name : {GL_VIEWPORT,
                               GL_SCISSOR_BOX,
                               GL_DEPTH_RANGE,
                               GL_DEPTH_FUNC,
                               GL_DEPTH_WRITEMASK,
                               GL_BLEND_SRC_RGB,
                               GL_BLEND_DST_RGB,
                               GL_BLEND_EQUATION_RGB,
                               GL_FRONT_FACE,
                               GL_CULL_FACE_MODE,
                               GL_POLYGON_MODE,
                               GL_COLOR_WRITEMASK,
                               GL_CLIP_ORIGIN,
                               GL_CLIP_DEPTH_MODE,
                               GL_PACK_ROW_LENGTH,
                               GL_PACK_ALIGNMENT,
                               GL_UNPACK_ALIGNMENT,
                               GL_CURRENT_PROGRAM,
                               GL_VERTEX_ARRAY_BINDING,
                               GL_DRAW_FRAMEBUFFER_BINDING,
                               GL_READ_FRAMEBUFFER_BINDING,
                               GL_ACTIVE_TEXTURE,
                               GL_TEXTURE_BINDING_2D,
                               GL_PIXEL_PACK_BUFFER_BINDING,
                               GL_SHADER_STORAGE_BUFFER_BINDING,
                               GL_UNIFORM_BUFFER_BINDING,
                               GL_DRAW_INDIRECT_BUFFER_BINDING,
                               GL_TRANSFORM_FEEDBACK_BINDING,
                               GL_STENCIL_TEST,
                               GL_SCISSOR_TEST,
                               GL_BLEND,
                               GL_CULL_FACE,
                               GL_DEPTH_TEST,
                               GL_DEPTH_CLAMP,
                               GL_POLYGON_OFFSET_FILL,
                               GL_RASTERIZER_DISCARD}) {
            double values[16] = {};
            get(static_cast<GLenum>(name), values);
            all.insert(all.end(), std::begin(values), std::end(values));
        }
        const auto get_of = call<PFNGLGETINTEGERI_VPROC>("glGetIntegeri_v");
        for (GLuint i = 0; i < 12; ++i) {
            GLint buffer = 0;
            get_of(GL_SHADER_STORAGE_BUFFER_BINDING, i, &buffer);
            all.push_back(buffer);
        }
        GLint64 start = 0;
        call<PFNGLGETINTEGER64I_VPROC>("glGetInteger64i_v")(GL_UNIFORM_BUFFER_START, 0, &start);
        all.push_back(static_cast<double>(start));
        return all;
    }
};

/// Makes the branches and draws their depth; returns how many pixels they cover.
std::size_t draw_a_tree(backend& device) {
    const auto skeleton =
        value_of(trees::grow(trees::quaking_aspen(), 1).and_then([](const auto& grown) {
            return trees::build_skeleton(grown);
        }));
    const auto mesh = value_of(trees::branch_mesh<backend>::create(device, skeleton, {}));
    skybark::kernels::scene_record scene; // the branches stand in a box of 20 m
    scene.to_shadow = glm::mat4(0.1f, 0, 0, 0, 0, 0.1f, 0, 0, 0, 0, 0.05f, 0, 0, -1, 0.5f, 1);
    const auto scenes = value_of(skybark::make_buffer<backend, skybark::kernels::scene_record>(
        device, std::span(&scene, 1)));
    const auto depth = value_of(device.create_image({256, 256, skybark::image_format::depth32f}));
    skybark::draw_target<backend> target{nullptr, &depth, {}, 1.0f};
    const auto drawn = skybark::run(device, [&](auto& recorder) {
        mesh.record(recorder);
        for (const auto& part : mesh.parts()) {
            recorder.draw(skybark::kernels::cast_shadow{},
                          {skybark::view<backend>(part.vertices), skybark::view<backend>(scenes)},
                          {}, mesh.geometry(part), target, {});
            target.clear_depth.reset(); // the first clears
        }
    });
    std::vector<float> pixels(256 * 256);
    if (!drawn || !device.download(depth, std::as_writable_bytes(std::span(pixels)))) {
        stop(1, "The tree was not drawn.");
    }
    return static_cast<std::size_t>(
        std::count_if(pixels.begin(), pixels.end(), [](float z) { return z < 1; }));
}

} // namespace

int main() {
    const program own;
    own.set_unusual_state();
    const std::vector<double> before = own.state();

    skybark::opengl::description lent;
    lent.user = const_cast<program*>(&own);
    lent.get_proc_address = [](const char* name, void* user) {
        return static_cast<const program*>(user)->get_proc_address(name);
    };
    auto device = skybark::opengl::device::create(lent);
    if (!device) {
        stop(no_such_backend, device.error().message);
    }
    const std::size_t covered = draw_a_tree(*device);

    const std::vector<double> after = own.state();
    std::size_t changed = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
        changed += before[i] == after[i] ? 0 : 1;
    }
    std::printf(
        "A tree covers %zu pixels, drawn in the caller's context on %s; of %zu values of its "
        "state %zu changed\n",
        covered, device->device_name().c_str(), before.size(), changed);
    return covered != 0 && changed == 0 ? 0 : 1;
}
