#pragma once
// A GLFW window, and its input as a session takes it.

#include "session.hpp"

#include <skybark/core/result.hpp>

#include <glm/vec2.hpp>
#include <memory>
#include <string>

struct GLFWwindow;

namespace skybark::viewer {

/// What draws in the window.
enum class window_kind { opengl, opengl_debug, vulkan };

class glfw_window {
  public:
    /// `unavailable` where there is no display, or it has no such window.
    [[nodiscard]] static result<std::unique_ptr<glfw_window>>
    create(window_kind kind, std::uint32_t width, std::uint32_t height);
    glfw_window(const glfw_window&) = delete;
    glfw_window& operator=(const glfw_window&) = delete;
    ~glfw_window();

    /// From now on the session gets what mouse and keys do, unless the panel takes it. Dear ImGui's
    /// part for GLFW must have been started, without callbacks of its own.
    void listen(session& to);
    /// Waits up to `seconds` for input and handles it.
    void poll(double seconds);
    [[nodiscard]] bool closed() const;

    [[nodiscard]] glm::uvec2 size() const;        ///< in the units of the pointer
    [[nodiscard]] glm::uvec2 framebuffer() const; ///< pixels; 0 while it is minimised
    [[nodiscard]] GLFWwindow* handle() const { return window_; }

  private:
    explicit glfw_window(GLFWwindow* window) : window_(window) {}

    GLFWwindow* window_;
};

} // namespace skybark::viewer
