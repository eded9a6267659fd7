#include "screen_opengl.hpp"

#include <algorithm>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <cstring>
#include <GL/glcorearb.h>
#include <GLFW/glfw3.h>
#include <imgui.h>

namespace skybark::viewer {

/// What this file calls itself, as any program with a renderer has its own table.
struct screen_opengl::functions {
    PFNGLBINDFRAMEBUFFERPROC bind_framebuffer = nullptr;
    PFNGLBLITNAMEDFRAMEBUFFERPROC blit = nullptr;
    PFNGLCLEARNAMEDFRAMEBUFFERFVPROC clear = nullptr;
    PFNGLCREATEFRAMEBUFFERSPROC create_framebuffers = nullptr;
    PFNGLCREATEQUERIESPROC create_queries = nullptr;
    PFNGLCREATETEXTURESPROC create_textures = nullptr;
    PFNGLDEBUGMESSAGECALLBACKPROC debug_message_callback = nullptr;
    PFNGLDELETEFRAMEBUFFERSPROC delete_framebuffers = nullptr;
    PFNGLDELETEQUERIESPROC delete_queries = nullptr;
    PFNGLDELETETEXTURESPROC delete_textures = nullptr;
    PFNGLENABLEPROC enable = nullptr;
    PFNGLFINISHPROC finish = nullptr;
    PFNGLGETQUERYOBJECTUI64VPROC get_query = nullptr;
    PFNGLGETTEXTUREIMAGEPROC get_texture_image = nullptr;
    PFNGLNAMEDFRAMEBUFFERTEXTUREPROC framebuffer_texture = nullptr;
    PFNGLQUERYCOUNTERPROC query_counter = nullptr;
    PFNGLTEXTURESTORAGE2DPROC texture_storage = nullptr;

    /// The first name that is missing, or null.
    template <class Find>
    [[nodiscard]] const char* load(const Find& find) {
        const char* missing = nullptr;
        const auto get = [&](auto& function, const char* name) {
            function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(find(name));
            missing = function == nullptr && missing == nullptr ? name : missing;
        };
        get(bind_framebuffer, "glBindFramebuffer");
        get(blit, "glBlitNamedFramebuffer");
        get(clear, "glClearNamedFramebufferfv");
        get(create_framebuffers, "glCreateFramebuffers");
        get(create_queries, "glCreateQueries");
        get(create_textures, "glCreateTextures");
        get(debug_message_callback, "glDebugMessageCallback");
        get(delete_framebuffers, "glDeleteFramebuffers");
        get(delete_queries, "glDeleteQueries");
        get(delete_textures, "glDeleteTextures");
        get(enable, "glEnable");
        get(finish, "glFinish");
        get(get_query, "glGetQueryObjectui64v");
        get(get_texture_image, "glGetTextureImage");
        get(framebuffer_texture, "glNamedFramebufferTexture");
        get(query_counter, "glQueryCounter");
        get(texture_storage, "glTextureStorage2D");
        return missing;
    }
};

namespace {

void APIENTRY on_message(GLenum, GLenum, GLuint, GLenum severity, GLsizei, const GLchar* text,
                         const void* user) {
    if (severity != GL_DEBUG_SEVERITY_NOTIFICATION) {
        // The callback's user pointer is const, what it points to is not.
        static_cast<std::vector<std::string>*>(const_cast<void*>(user))->emplace_back(text);
    }
}

} // namespace

screen_opengl::screen_opengl(const screen_options& options)
    : options_(options), gl_(std::make_unique<functions>()) {}

result<std::unique_ptr<screen_opengl>> screen_opengl::create(const screen_options& options) {
    std::unique_ptr<screen_opengl> made(new screen_opengl(options));
    auto done = options.headless ? made->open_headless() : made->open_window();
    if (done) {
        done = made->load();
    }
    if (done) {
        done = made->start_panel();
    }
    if (!done) {
        return failure(done.error());
    }
    return made;
}

result<void> screen_opengl::open_window() {
    auto window = glfw_window::create(options_.messages != nullptr ? window_kind::opengl_debug
                                                                   : window_kind::opengl,
                                      options_.width, options_.height);
    if (!window) {
        return failure(window.error());
    }
    window_ = std::move(*window);
    glfwMakeContextCurrent(window_->handle());
    glfwSwapInterval(options_.scripted ? 0 : 1);
    opengl::description description;
    description.get_proc_address = [](const char* name, void*) { return glfwGetProcAddress(name); };
    auto device = opengl::device::create(description);
    if (!device) {
        return failure(device.error());
    }
    device_ = std::move(*device);
    return {};
}

result<void> screen_opengl::open_headless() {
    opengl::headless_options wanted;
    wanted.kind = opengl::headless_kind::egl; // which Dear ImGui finds its functions in
    if (options_.messages != nullptr) {
        wanted.debug = [to = options_.messages](const opengl::debug_message& message) {
            if (message.severity != opengl::debug_severity::notification) {
                to->emplace_back(message.text);
            }
        };
    }
    auto made = opengl::headless::create(std::move(wanted));
    if (!made) {
        return failure(made.error());
    }
    headless_ = std::move(*made);
    return {};
}

result<void> screen_opengl::load() {
    const char* missing = gl_->load([&](const char* name) {
        return headless_ ? headless_->find(name) : glfwGetProcAddress(name);
    });
    if (missing != nullptr) {
        return fail(error_code::unavailable,
                    std::string("The OpenGL library has no function ") + missing + ".");
    }
    if (options_.messages != nullptr && window_) {
        gl_->debug_message_callback(on_message, options_.messages);
        gl_->enable(GL_DEBUG_OUTPUT);
        gl_->enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    }
    const std::string name = device().device_name();
    software_ =
        name.find("llvmpipe") != std::string::npos || name.find("softpipe") != std::string::npos;
    gl_->create_framebuffers(1, &frame_);
    gl_->create_framebuffers(1, &from_frame_);
    return {};
}

result<void> screen_opengl::start_panel() {
    if (window_ && !options_.scripted) {
        ImGui_ImplGlfw_InitForOpenGL(window_->handle(), false);
    }
    panel_ = true;
    if (!ImGui_ImplOpenGL3_Init("#version 450 core")) {
        return fail(error_code::unavailable, "Dear ImGui does not start in this OpenGL context.");
    }
    return {};
}

screen_opengl::~screen_opengl() {
    if (panel_) {
        ImGui_ImplOpenGL3_Shutdown();
        if (window_ && !options_.scripted) {
            ImGui_ImplGlfw_Shutdown();
        }
    }
    if (frame_ != 0) {
        gl_->delete_framebuffers(1, &frame_);
        gl_->delete_framebuffers(1, &from_frame_);
        gl_->delete_textures(1, &image_);
        gl_->delete_queries(static_cast<GLsizei>(queries_.size()), queries_.data());
    }
}

opengl::device& screen_opengl::device() { return headless_ ? headless_->device() : *device_; }

void screen_opengl::mark(std::size_t number) {
    if (software_) {
        gl_->finish();
        marks_.resize(std::max(marks_.size(), number + 1));
        marks_[number] = std::chrono::steady_clock::now();
        return;
    }
    if (number >= queries_.size()) {
        queries_.push_back(0);
        gl_->create_queries(GL_TIMESTAMP, 1, &queries_.back());
    }
    gl_->query_counter(queries_[number], GL_TIMESTAMP);
}

void screen_opengl::read_marks(std::span<double> seconds) {
    if (software_) {
        for (std::size_t i = 0; i < seconds.size(); ++i) {
            seconds[i] = std::chrono::duration<double>(marks_[i + 1] - marks_[i]).count();
        }
        return;
    }
    GLuint64 before = 0;
    gl_->get_query(queries_[0], GL_QUERY_RESULT, &before);
    for (std::size_t i = 0; i < seconds.size(); ++i) {
        GLuint64 now = 0;
        gl_->get_query(queries_[i + 1], GL_QUERY_RESULT, &now);
        seconds[i] = 1e-9 * static_cast<double>(now - before);
        before = now;
    }
}

void screen_opengl::make_image(glm::uvec2 size) {
    if (size == size_) {
        return;
    }
    gl_->delete_textures(1, &image_);
    gl_->create_textures(GL_TEXTURE_2D, 1, &image_);
    gl_->texture_storage(image_, 1, GL_RGBA8, static_cast<GLsizei>(size.x),
                         static_cast<GLsizei>(size.y));
    gl_->framebuffer_texture(frame_, GL_COLOR_ATTACHMENT0, image_, 0);
    size_ = size;
}

void screen_opengl::begin_panel() {
    ImGui_ImplOpenGL3_NewFrame();
    if (window_ && !options_.scripted) {
        ImGui_ImplGlfw_NewFrame();
    }
}

result<void> screen_opengl::show(const opengl::image& picture) {
    const glm::uvec2 size =
        window_ ? window_->framebuffer() : glm::uvec2(options_.width, options_.height);
    make_image(size);
    const auto width = static_cast<GLint>(size.x);
    const auto height = static_cast<GLint>(size.y);
    const image_description what = picture.description();
    const auto [low, high] = place({what.width, what.height}, size);
    const GLfloat black[] = {0, 0, 0, 1};
    gl_->framebuffer_texture(from_frame_, GL_COLOR_ATTACHMENT0, picture.name(), 0);
    gl_->clear(frame_, GL_COLOR, 0, black);
    // The picture's first row is its top, the window's its bottom.
    gl_->blit(from_frame_, frame_, 0, 0, static_cast<GLint>(what.width),
              static_cast<GLint>(what.height), static_cast<GLint>(low.x),
              height - static_cast<GLint>(low.y), static_cast<GLint>(high.x),
              height - static_cast<GLint>(high.y), GL_COLOR_BUFFER_BIT, GL_LINEAR);
    gl_->bind_framebuffer(GL_FRAMEBUFFER, frame_);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    gl_->bind_framebuffer(GL_FRAMEBUFFER, 0);
    if (window_) {
        gl_->blit(frame_, 0, 0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT,
                  GL_NEAREST);
        glfwSwapBuffers(window_->handle());
    } else {
        gl_->finish();
    }
    return {};
}

result<shown> screen_opengl::read() {
    shown all{{}, size_.x, size_.y};
    const std::size_t row = std::size_t{4} * size_.x;
    std::vector<std::uint8_t> rows(row * size_.y);
    gl_->get_texture_image(image_, 0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(rows.size()),
                           rows.data());
    all.pixels.resize(rows.size());
    for (std::size_t y = 0; y < size_.y; ++y) {
        std::memcpy(all.pixels.data() + y * row, rows.data() + (size_.y - 1 - y) * row, row);
    }
    return all;
}

} // namespace skybark::viewer
