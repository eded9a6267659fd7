#include "glfw_window.hpp"

#include <backends/imgui_impl_glfw.h>
#include <GLFW/glfw3.h>
#include <imgui.h>

namespace skybark::viewer {

namespace {

session* listener_of(GLFWwindow* window) {
    return static_cast<session*>(glfwGetWindowUserPointer(window));
}

// The panel learns of everything, the session of what the panel does not take.

void on_button(GLFWwindow* window, int which, int action, int modifiers) {
    ImGui_ImplGlfw_MouseButtonCallback(window, which, action, modifiers);
    const bool down = action == GLFW_PRESS;
    if (down && ImGui::GetIO().WantCaptureMouse) {
        return;
    }
    if (which == GLFW_MOUSE_BUTTON_LEFT) {
        listener_of(window)->press(button::left, down);
    } else if (which == GLFW_MOUSE_BUTTON_MIDDLE) {
        listener_of(window)->press(button::middle, down);
    }
}

void on_pointer(GLFWwindow* window, double x, double y) {
    int width = 0, height = 1;
    glfwGetWindowSize(window, &width, &height);
    listener_of(window)->move_to({static_cast<float>(x), static_cast<float>(y)},
                                 static_cast<float>(height > 0 ? height : 1));
}

void on_scroll(GLFWwindow* window, double x, double y) {
    ImGui_ImplGlfw_ScrollCallback(window, x, y);
    if (!ImGui::GetIO().WantCaptureMouse) {
        listener_of(window)->scroll(static_cast<float>(y));
    }
}

void on_key(GLFWwindow* window, int which, int code, int action, int modifiers) {
    ImGui_ImplGlfw_KeyCallback(window, which, code, action, modifiers);
    if (action != GLFW_PRESS || ImGui::GetIO().WantTextInput) {
        return;
    }
    switch (which) {
    case GLFW_KEY_SPACE:
        return listener_of(window)->press(key::space);
    case GLFW_KEY_R:
        return listener_of(window)->press(key::r);
    case GLFW_KEY_H:
        return listener_of(window)->press(key::h);
    case GLFW_KEY_F12:
        return listener_of(window)->press(key::f12);
    case GLFW_KEY_ESCAPE:
        return listener_of(window)->press(key::escape);
    default:
        return;
    }
}

failure no_window(const char* what) {
    const char* why = nullptr;
    glfwGetError(&why);
    return fail(error_code::unavailable, std::string(what) + ": " +
                                             (why != nullptr ? why : "GLFW does not say why.") +
                                             " With --headless no window is needed.");
}

} // namespace

result<std::unique_ptr<glfw_window>> glfw_window::create(window_kind kind, std::uint32_t width,
                                                         std::uint32_t height) {
    if (glfwInit() == GLFW_FALSE) {
        return no_window("There is no display for a window");
    }
    glfwDefaultWindowHints();
    if (kind == window_kind::vulkan) {
        glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    } else {
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
        glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT,
                       kind == window_kind::opengl_debug ? GLFW_TRUE : GLFW_FALSE);
    }
    GLFWwindow* window = glfwCreateWindow(static_cast<int>(width), static_cast<int>(height),
                                          "Skybark", nullptr, nullptr);
    if (window == nullptr) {
        failure why =
            no_window(kind == window_kind::vulkan ? "GLFW makes no window"
                                                  : "GLFW makes no window with OpenGL 4.5 core");
        glfwTerminate();
        return why;
    }
    return std::unique_ptr<glfw_window>(new glfw_window(window));
}

glfw_window::~glfw_window() {
    glfwDestroyWindow(window_);
    glfwTerminate();
}

void glfw_window::listen(session& to) {
    glfwSetWindowUserPointer(window_, &to);
    glfwSetMouseButtonCallback(window_, on_button);
    glfwSetCursorPosCallback(window_, on_pointer);
    glfwSetScrollCallback(window_, on_scroll);
    glfwSetKeyCallback(window_, on_key);
    glfwSetCharCallback(window_, ImGui_ImplGlfw_CharCallback);
    glfwSetCursorEnterCallback(window_, ImGui_ImplGlfw_CursorEnterCallback);
    glfwSetWindowFocusCallback(window_, ImGui_ImplGlfw_WindowFocusCallback);
}

void glfw_window::poll(double seconds) {
    if (seconds > 0) {
        glfwWaitEventsTimeout(seconds);
    } else {
        glfwPollEvents();
    }
}

bool glfw_window::closed() const { return glfwWindowShouldClose(window_) == GLFW_TRUE; }

glm::uvec2 glfw_window::size() const {
    int width = 0, height = 0;
    glfwGetWindowSize(window_, &width, &height);
    return {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}

glm::uvec2 glfw_window::framebuffer() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    return {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}

} // namespace skybark::viewer
