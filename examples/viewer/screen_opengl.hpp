#pragma once
// A screen by OpenGL: in the context of a GLFW window, or in one of EGL's without a surface.

#include "glfw_window.hpp"
#include "screen.hpp"

#include <skybark/opengl/headless.hpp>
#include <skybark/opengl/opengl.hpp>

#include <chrono>
#include <memory>
#include <optional>
#include <span>

namespace skybark::viewer {

class screen_opengl {
  public:
    using device_type = opengl::device;

    [[nodiscard]] static result<std::unique_ptr<screen_opengl>>
    create(const screen_options& options);
    screen_opengl(const screen_opengl&) = delete;
    screen_opengl& operator=(const screen_opengl&) = delete;
    ~screen_opengl();

    [[nodiscard]] opengl::device& device();
    [[nodiscard]] glfw_window* window() { return window_.get(); }

    template <class Record>
    [[nodiscard]] result<void> run(std::size_t count, Record&& record, std::span<double> seconds) {
        auto recorder = device().begin();
        if (!recorder) {
            return failure(recorder.error());
        }
        mark(0);
        for (std::size_t i = 0; i < count; ++i) {
            record(*recorder, i);
            mark(i + 1);
        }
        auto done = device().submit(*recorder);
        if (done) {
            read_marks(seconds);
        }
        return done;
    }

    void begin_panel();
    [[nodiscard]] result<void> show(const opengl::image& picture);
    [[nodiscard]] result<shown> read();

  private:
    struct functions;

    explicit screen_opengl(const screen_options& options);
    [[nodiscard]] result<void> open_window();
    [[nodiscard]] result<void> open_headless();
    [[nodiscard]] result<void> load();
    [[nodiscard]] result<void> start_panel();
    /// The end of a stage, and the beginning of the first.
    void mark(std::size_t number);
    void read_marks(std::span<double> seconds);
    /// The image that all is drawn into, in the window's size.
    void make_image(glm::uvec2 size);

    screen_options options_;
    std::unique_ptr<glfw_window> window_;
    std::optional<opengl::headless> headless_;
    std::optional<opengl::device> device_; ///< on the window's context
    std::unique_ptr<functions> gl_;
    bool panel_ = false;
    bool software_ = false; ///< whose timers count something else
    std::vector<unsigned> queries_;
    std::vector<std::chrono::steady_clock::time_point> marks_;
    unsigned image_ = 0;      ///< a texture, its first row at the bottom
    unsigned frame_ = 0;      ///< its framebuffer
    unsigned from_frame_ = 0; ///< the picture's
    glm::uvec2 size_{0};
};

} // namespace skybark::viewer
