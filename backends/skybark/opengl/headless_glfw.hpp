#pragma once
// An OpenGL context in a hidden GLFW window, for where only a window system gives one.
//
// GLFW is loaded when it is needed and stays. It is initialised here, which does nothing where the
// caller has done so, and never terminated: both are the process's own. Its window hints are left
// at their defaults. As GLFW asks, call this in the main thread.

#include <skybark/opengl/headless.hpp>

namespace skybark::opengl {

namespace detail {

namespace glfw {
using get_proc_address_type = procedure(const char*);
using init_type = int();
using default_hints_type = void();
using hint_type = void(int hint, int value);
using create_window_type = void*(int width, int height, const char* title, void* monitor,
                                 void* share);
using destroy_window_type = void(void* window);
using make_current_type = void(void* window);
using get_current_type = void*();
using get_error_type = int(const char** text);

inline constexpr int visible = 0x20004, client_api = 0x22001, opengl_api = 0x30001,
                     version_major = 0x22002, version_minor = 0x22003, debug_context = 0x22007,
                     profile = 0x22008, core_profile = 0x32001;
} // namespace glfw

class glfw_context final : public headless_context {
  public:
    [[nodiscard]] static result<std::shared_ptr<headless_context>> create(bool debug) {
        auto library = shared_library::open("libglfw.so.3");
        if (!library) {
            return failure(library.error());
        }
        auto made = std::make_shared<glfw_context>();
        auto* init = library->find<glfw::init_type>("glfwInit");
        if (!made->load(*library) || init == nullptr) {
            return fail(error_code::unavailable, "This GLFW is older than version 3.3.");
        }
        if (init() == 0) {
            return fail(error_code::unavailable, "GLFW does not start: " + made->last_error());
        }
        made->open_window(*library, debug);
        if (made->window_ == nullptr) {
            return fail(error_code::unavailable,
                        "GLFW makes no window with OpenGL 4.5 core: " + made->last_error());
        }
        return std::shared_ptr<headless_context>(std::move(made));
    }
    ~glfw_context() override {
        if (window_ != nullptr) {
            release();
            destroy_window_(window_);
        }
    }

    [[nodiscard]] procedure find(const char* name) const override {
        return get_proc_address_(name);
    }

  protected:
    [[nodiscard]] bool bind() override {
        make_current_(window_);
        return get_current_() == window_;
    }

  private:
    [[nodiscard]] bool load(const shared_library& library) {
        get_proc_address_ = library.find<glfw::get_proc_address_type>("glfwGetProcAddress");
        destroy_window_ = library.find<glfw::destroy_window_type>("glfwDestroyWindow");
        make_current_ = library.find<glfw::make_current_type>("glfwMakeContextCurrent");
        get_current_ = library.find<glfw::get_current_type>("glfwGetCurrentContext");
        get_error_ = library.find<glfw::get_error_type>("glfwGetError");
        return get_proc_address_ != nullptr && destroy_window_ != nullptr &&
               make_current_ != nullptr && get_current_ != nullptr && get_error_ != nullptr;
    }
    void open_window(const shared_library& library, bool debug) {
        auto* defaults = library.find<glfw::default_hints_type>("glfwDefaultWindowHints");
        auto* hint = library.find<glfw::hint_type>("glfwWindowHint");
        auto* create_window = library.find<glfw::create_window_type>("glfwCreateWindow");
        if (defaults == nullptr || hint == nullptr || create_window == nullptr) {
            return;
        }
        defaults();
        hint(glfw::visible, 0);
        hint(glfw::client_api, glfw::opengl_api);
        hint(glfw::version_major, 4);
        hint(glfw::version_minor, 5);
        hint(glfw::profile, glfw::core_profile);
        hint(glfw::debug_context, debug ? 1 : 0);
        window_ = create_window(16, 16, "skybark", nullptr, nullptr);
        defaults();
    }
    [[nodiscard]] std::string last_error() const {
        const char* text = nullptr;
        get_error_(&text);
        return text != nullptr ? text : "it does not say why.";
    }

    void* window_ = nullptr;
    glfw::get_proc_address_type* get_proc_address_ = nullptr;
    glfw::destroy_window_type* destroy_window_ = nullptr;
    glfw::make_current_type* make_current_ = nullptr;
    glfw::get_current_type* get_current_ = nullptr;
    glfw::get_error_type* get_error_ = nullptr;
};

} // namespace detail

/// A context of a hidden window; `kind` of the options is not looked at.
[[nodiscard]] inline result<headless> create_headless_glfw(headless_options options = {}) {
    const bool debug = static_cast<bool>(options.debug);
    return headless::adopt(detail::glfw_context::create(debug), std::move(options));
}

} // namespace skybark::opengl
