#pragma once
// A caller's own EGL context, made without any of our code.

#include <dlfcn.h>
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include "support.hpp"

namespace skybark::opengl::tests {

/// The caller's context is current as long as this lives.
class caller_context {
  public:
    caller_context() {
        library_ = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
        if (library_ == nullptr) {
            return;
        }
        get_proc_address_ = symbol<decltype(eglGetProcAddress)>("eglGetProcAddress");
        const auto get_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
            get_proc_address_("eglGetPlatformDisplayEXT"));
        display_ = get_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
        symbol<decltype(eglInitialize)>("eglInitialize")(display_, nullptr, nullptr);
        symbol<decltype(eglBindAPI)>("eglBindAPI")(EGL_OPENGL_API);
        const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                     4,
                                     EGL_CONTEXT_MINOR_VERSION,
                                     5,
                                     EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                     EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                     EGL_NONE};
        context_ = symbol<decltype(eglCreateContext)>("eglCreateContext")(
            display_, EGLConfig(nullptr), EGL_NO_CONTEXT, attributes);
        detail::release_current_context();
        current_ =
            context_ != nullptr && symbol<decltype(eglMakeCurrent)>("eglMakeCurrent")(
                                       display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != 0;
    }
    ~caller_context() {
        if (context_ != nullptr) {
            symbol<decltype(eglMakeCurrent)>("eglMakeCurrent")(display_, nullptr, nullptr, nullptr);
            symbol<decltype(eglDestroyContext)>("eglDestroyContext")(display_, context_);
        }
    }
    caller_context(const caller_context&) = delete;
    caller_context& operator=(const caller_context&) = delete;

    [[nodiscard]] bool current() const { return current_; }
    [[nodiscard]] procedure find(const char* name) const { return get_proc_address_(name); }
    /// As an engine would describe it.
    [[nodiscard]] description describe() {
        return {[](const char* name, void* user) {
                    return static_cast<caller_context*>(user)->find(name);
                },
                this, nullptr, nullptr};
    }

  private:
    template <class Function>
    [[nodiscard]] Function* symbol(const char* name) const {
        return reinterpret_cast<Function*>(dlsym(library_, name));
    }

    void* library_ = nullptr;
    decltype(&eglGetProcAddress) get_proc_address_ = nullptr;
    EGLDisplay display_ = nullptr;
    EGLContext context_ = nullptr;
    bool current_ = false;
};

} // namespace skybark::opengl::tests
