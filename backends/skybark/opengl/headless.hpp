#pragma once
// OpenGL contexts without a window: EGL without a surface, or OSMesa in main memory.
//
// The libraries are loaded when they are first needed, and stay: Mesa leaves callbacks in the
// thread that crash a process which has unloaded it. EGL's display stays for the same reason, and
// because all of a process's users of EGL share it.
//
// A headless device makes its context current in the calling thread whenever it is not, and leaves
// it so. It first releases whatever EGL, OSMesa or GLFW context is current there: EGL and OSMesa
// share one notion of the current context without knowing of each other, so one made current over
// the other would get the other's calls. Who has a context of their own makes it current again.
// The context is known by its debug callback, which therefore is ours; options.debug is for yours.

#include <skybark/opengl/device.hpp>

#include <dlfcn.h>
#include <functional>

namespace skybark::opengl {

enum class headless_kind {
    any,    ///< EGL, or else OSMesa
    egl,    ///< without a surface, on a GPU where there is one
    osmesa, ///< Mesa's software renderer, without any display or device
};

enum class debug_severity { high, medium, low, notification };

/// What the driver says through KHR_debug.
struct debug_message {
    debug_severity severity = debug_severity::notification;
    std::uint32_t id = 0;
    std::string_view text;
};

struct headless_options {
    headless_kind kind = headless_kind::any;
    /// Optional: makes a debug context, and is called for each of its messages. Must not throw.
    std::function<void(const debug_message&)> debug;
    // As in description.
    skybark::hooks hooks = {};
    bool debug_labels = false;
};

namespace detail {

/// A library that stays loaded. Its names stay out of everybody else's way.
class shared_library {
  public:
    [[nodiscard]] static result<shared_library> open(const char* name) {
        shared_library library;
        library.handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
        if (library.handle_ == nullptr) {
            const char* why = dlerror();
            return fail(error_code::unavailable,
                        std::string("The library ") + name +
                            " cannot be loaded: " + (why != nullptr ? why : "unknown") + ".");
        }
        return library;
    }
    /// The library if the process has loaded it already.
    [[nodiscard]] static shared_library loaded(const char* name) {
        shared_library library;
        library.handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL | RTLD_NOLOAD);
        return library;
    }

    /// A function of the library, or null. `Function` is a function type.
    template <class Function>
    [[nodiscard]] Function* find(const char* name) const {
        void* symbol = handle_ != nullptr ? dlsym(handle_, name) : nullptr;
        Function* function = nullptr;
        static_assert(sizeof(function) == sizeof(symbol)); // as POSIX promises
        std::memcpy(&function, &symbol, sizeof(symbol));
        return function;
    }

  private:
    void* handle_ = nullptr;
};

namespace egl {
using display = void*;
using context = void*;
using get_proc_address_type = procedure(const char*);
using get_platform_display_type = display(unsigned platform, void* native, const int* attributes);
using query_devices_type = unsigned(int most, void** devices, int* count);
using get_display_type = display(void* native);
using initialize_type = unsigned(display, int* major, int* minor);
using bind_api_type = unsigned(unsigned api);
using choose_config_type = unsigned(display, const int* attributes, void** configs, int most,
                                    int* count);
using create_context_type = context(display, void* config, context share, const int* attributes);
using destroy_context_type = unsigned(display, context);
using make_current_type = unsigned(display, void* draw, void* read, context);
using get_current_context_type = context();
using get_current_display_type = display();
} // namespace egl

namespace osmesa {
using context = void*;
using create_context_type = context(const int* attributes, context share);
using destroy_context_type = void(context);
using make_current_type = unsigned char(context, void* buffer, unsigned type, int width,
                                        int height);
using get_current_context_type = context();
using get_proc_address_type = procedure(const char*);
} // namespace osmesa

/// Releases what is current in this thread, whichever library it came from.
inline void release_current_context() {
    if (const auto glfw = shared_library::loaded("libglfw.so.3");
        auto* current = glfw.find<void*()>("glfwGetCurrentContext")) {
        auto* make = glfw.find<void(void*)>("glfwMakeContextCurrent");
        if (make != nullptr && current() != nullptr) {
            make(nullptr);
        }
    }
    if (const auto library = shared_library::loaded("libOSMesa.so.8");
        auto* current = library.find<osmesa::get_current_context_type>("OSMesaGetCurrentContext")) {
        auto* make = library.find<osmesa::make_current_type>("OSMesaMakeCurrent");
        if (make != nullptr && current() != nullptr) {
            make(nullptr, nullptr, 0, 0, 0);
        }
    }
    if (const auto library = shared_library::loaded("libEGL.so.1");
        auto* current = library.find<egl::get_current_context_type>("eglGetCurrentContext")) {
        auto* display = library.find<egl::get_current_display_type>("eglGetCurrentDisplay");
        auto* make = library.find<egl::make_current_type>("eglMakeCurrent");
        if (display != nullptr && make != nullptr && current() != nullptr) {
            make(display(), nullptr, nullptr, nullptr);
        }
    }
}

/// A context and how to make it current. What differs between the libraries is in derived classes.
class headless_context {
  public:
    headless_context() = default;
    headless_context(const headless_context&) = delete;
    headless_context& operator=(const headless_context&) = delete;
    virtual ~headless_context() = default;

    [[nodiscard]] virtual procedure find(const char* name) const = 0;

    /// OpenGL itself is asked: the libraries' own answers do not know of each other.
    [[nodiscard]] bool is_current() const {
        void* user = nullptr;
        if (functions_.get_pointer != nullptr) {
            functions_.get_pointer(gl::debug_callback_user_param, &user);
        }
        return user == this;
    }
    [[nodiscard]] bool make_current() {
        if (is_current()) {
            return true;
        }
        release_current_context();
        return bind();
    }
    /// Leaves the thread without a context, if this one is current.
    void release() {
        if (is_current()) {
            release_current_context();
        }
    }

    /// Called once, after which `is_current` is right.
    [[nodiscard]] result<void> start(std::function<void(const debug_message&)> sink) {
        release_current_context();
        if (!bind()) {
            return fail(error_code::unavailable, "A new OpenGL context cannot be made current.");
        }
        sink_ = std::move(sink);
        const auto get = [](const char* name, void* user) {
            return static_cast<headless_context*>(user)->find(name);
        };
        if (const char* missing = gl::load(functions_, get, this); missing != nullptr) {
            return fail(error_code::unavailable,
                        std::string("The OpenGL library has no function ") + missing + ".");
        }
        functions_.debug_message_callback(&receive, this);
        if (sink_) {
            functions_.enable(gl::debug_output);
            functions_.enable(gl::debug_output_synchronous);
        }
        return {};
    }

  protected:
    /// Makes the context current where none is.
    [[nodiscard]] virtual bool bind() = 0;

  private:
    static void receive(gl::token, gl::token, gl::handle id, gl::token severity, int length,
                        const char* text, const void* user) {
        const auto* self = static_cast<const headless_context*>(user);
        if (!self->sink_) {
            return;
        }
        debug_message message;
        message.severity = severity == gl::debug_severity_high     ? debug_severity::high
                           : severity == gl::debug_severity_medium ? debug_severity::medium
                           : severity == gl::debug_severity_low    ? debug_severity::low
                                                                   : debug_severity::notification;
        message.id = id;
        message.text = length < 0 ? std::string_view(text)
                                  : std::string_view(text, static_cast<std::size_t>(length));
        self->sink_(message);
    }

    gl::functions functions_;
    std::function<void(const debug_message&)> sink_;
};

class egl_context final : public headless_context {
  public:
    [[nodiscard]] static result<std::shared_ptr<headless_context>> create(bool debug) {
        auto library = shared_library::open("libEGL.so.1");
        if (!library) {
            return failure(library.error());
        }
        auto made = std::make_shared<egl_context>();
        if (!made->load(*library) || !made->choose_display()) {
            return fail(error_code::unavailable, "EGL has no display without a surface.");
        }
        // Debug, major and minor version, core profile.
        const int attributes[] = {0x3098, 4, 0x30FB, 5, 0x30FD, 1, 0x31B0, debug ? 1 : 0, 0x3038};
        const unsigned opengl = 0x30A2;
        if (made->bind_api_(opengl) != 0) {
            made->context_ = made->create_context_(made->display_, nullptr, nullptr, attributes);
        }
        if (made->context_ == nullptr) {
            return fail(error_code::unavailable, "EGL makes no context of OpenGL 4.5 core.");
        }
        return std::shared_ptr<headless_context>(std::move(made));
    }
    ~egl_context() override {
        if (context_ != nullptr) {
            release();
            destroy_context_(display_, context_);
        }
    }

    [[nodiscard]] procedure find(const char* name) const override {
        return get_proc_address_(name);
    }

  protected:
    [[nodiscard]] bool bind() override {
        return bind_api_(0x30A2) != 0 && make_current_(display_, nullptr, nullptr, context_) != 0;
    }

  private:
    [[nodiscard]] bool load(const shared_library& library) {
        library_ = library;
        get_proc_address_ = library.find<egl::get_proc_address_type>("eglGetProcAddress");
        get_display_ = library.find<egl::get_display_type>("eglGetDisplay");
        initialize_ = library.find<egl::initialize_type>("eglInitialize");
        bind_api_ = library.find<egl::bind_api_type>("eglBindAPI");
        create_context_ = library.find<egl::create_context_type>("eglCreateContext");
        destroy_context_ = library.find<egl::destroy_context_type>("eglDestroyContext");
        make_current_ = library.find<egl::make_current_type>("eglMakeCurrent");
        return get_proc_address_ != nullptr && get_display_ != nullptr && initialize_ != nullptr &&
               bind_api_ != nullptr && create_context_ != nullptr && destroy_context_ != nullptr &&
               make_current_ != nullptr;
    }
    [[nodiscard]] bool start_display(egl::display display) {
        int major = 0;
        int minor = 0;
        if (display == nullptr || initialize_(display, &major, &minor) == 0) {
            return false;
        }
        display_ = display;
        return true;
    }
    /// Mesa's display without a surface, or else the first device, or else the default display.
    [[nodiscard]] bool choose_display() {
        const auto by_platform = reinterpret_cast<egl::get_platform_display_type*>(
            get_proc_address_("eglGetPlatformDisplayEXT"));
        if (by_platform == nullptr) {
            return start_display(get_display_(nullptr));
        }
        const unsigned surfaceless = 0x31DD;
        if (start_display(by_platform(surfaceless, nullptr, nullptr))) {
            return true;
        }
        const auto query_devices =
            reinterpret_cast<egl::query_devices_type*>(get_proc_address_("eglQueryDevicesEXT"));
        void* device = nullptr;
        int count = 0;
        const unsigned by_device = 0x313F;
        if (query_devices != nullptr && query_devices(1, &device, &count) != 0 && count == 1 &&
            start_display(by_platform(by_device, device, nullptr))) {
            return true;
        }
        return start_display(get_display_(nullptr));
    }

    shared_library library_;
    egl::display display_ = nullptr;
    egl::context context_ = nullptr;
    egl::get_proc_address_type* get_proc_address_ = nullptr;
    egl::get_display_type* get_display_ = nullptr;
    egl::initialize_type* initialize_ = nullptr;
    egl::bind_api_type* bind_api_ = nullptr;
    egl::create_context_type* create_context_ = nullptr;
    egl::destroy_context_type* destroy_context_ = nullptr;
    egl::make_current_type* make_current_ = nullptr;
};

class osmesa_context final : public headless_context {
  public:
    [[nodiscard]] static result<std::shared_ptr<headless_context>> create() {
        auto library = shared_library::open("libOSMesa.so.8");
        if (!library) {
            return failure(library.error());
        }
        auto made = std::make_shared<osmesa_context>();
        made->destroy_context_ =
            library->find<osmesa::destroy_context_type>("OSMesaDestroyContext");
        made->make_current_ = library->find<osmesa::make_current_type>("OSMesaMakeCurrent");
        made->get_proc_address_ =
            library->find<osmesa::get_proc_address_type>("OSMesaGetProcAddress");
        auto* create = library->find<osmesa::create_context_type>("OSMesaCreateContextAttribs");
        if (create == nullptr || made->destroy_context_ == nullptr ||
            made->make_current_ == nullptr || made->get_proc_address_ == nullptr) {
            return fail(error_code::unavailable, "This OSMesa is too old for OpenGL 4.5 core.");
        }
        // Format RGBA, core profile, major and minor version.
        const int attributes[] = {0x22, 0x1908, 0x33, 0x34, 0x36, 4, 0x37, 5, 0};
        made->context_ = create(attributes, nullptr);
        if (made->context_ == nullptr) {
            return fail(error_code::unavailable, "OSMesa makes no context of OpenGL 4.5 core.");
        }
        return std::shared_ptr<headless_context>(std::move(made));
    }
    ~osmesa_context() override {
        if (context_ != nullptr) {
            release();
            destroy_context_(context_);
        }
    }

    [[nodiscard]] procedure find(const char* name) const override {
        return get_proc_address_(name);
    }

  protected:
    [[nodiscard]] bool bind() override {
        const unsigned unsigned_byte = 0x1401;
        return make_current_(context_, pixel_.data(), unsigned_byte, 1, 1) != 0;
    }

  private:
    osmesa::context context_ = nullptr;
    osmesa::destroy_context_type* destroy_context_ = nullptr;
    osmesa::make_current_type* make_current_ = nullptr;
    osmesa::get_proc_address_type* get_proc_address_ = nullptr;
    std::array<unsigned char, 4> pixel_{}; // OSMesa wants a real buffer, if only of one pixel
};

} // namespace detail

/// A context of our own and the device on it.
class headless {
  public:
    /// error_code::unavailable where there is no such library, display or version.
    [[nodiscard]] static result<headless> create(headless_options options = {});

    /// Makes the context current in this thread, after releasing any other.
    [[nodiscard]] bool make_current() { return context_->make_current(); }
    /// Leaves this thread without a context, if this one is current.
    void release() { context_->release(); }

    /// A function of the context's own library, for the caller's own OpenGL calls.
    [[nodiscard]] procedure find(const char* name) const { return context_->find(name); }

    [[nodiscard]] opengl::device& device() & noexcept { return device_; }
    /// The device alone: it keeps the context.
    [[nodiscard]] opengl::device device() && noexcept { return std::move(device_); }

    /// For headers that make contexts in other ways.
    [[nodiscard]] static result<headless>
    adopt(result<std::shared_ptr<detail::headless_context>> context, headless_options options);

  private:
    headless(std::shared_ptr<detail::headless_context> context, opengl::device device)
        : context_(std::move(context)), device_(std::move(device)) {}

    std::shared_ptr<detail::headless_context> context_;
    opengl::device device_;
};

inline result<headless> headless::adopt(result<std::shared_ptr<detail::headless_context>> context,
                                        headless_options options) {
    if (!context) {
        return failure(context.error());
    }
    if (auto started = (*context)->start(std::move(options.debug)); !started) {
        return failure(started.error());
    }
    description given;
    given.hooks = options.hooks;
    given.debug_labels = options.debug_labels;
    given.user = context->get();
    given.owner = *context;
    given.get_proc_address = [](const char* name, void* user) {
        return static_cast<detail::headless_context*>(user)->find(name);
    };
    given.make_current = [](void* user) {
        return static_cast<detail::headless_context*>(user)->make_current();
    };
    auto made = device::create(std::move(given));
    if (!made) {
        return failure(made.error());
    }
    return headless(std::move(*context), std::move(*made));
}

inline result<headless> headless::create(headless_options options) {
    const bool debug = static_cast<bool>(options.debug);
    if (options.kind == headless_kind::osmesa) {
        return adopt(detail::osmesa_context::create(), std::move(options));
    }
    auto made = adopt(detail::egl_context::create(debug), options);
    if (made || options.kind == headless_kind::egl) {
        return made;
    }
    auto instead = adopt(detail::osmesa_context::create(), std::move(options));
    if (!instead) {
        return fail(error_code::unavailable, made.error().message + " " + instead.error().message);
    }
    return instead;
}

} // namespace skybark::opengl
