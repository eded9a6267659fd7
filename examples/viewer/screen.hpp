#pragma once
// What screens of all backends share. A screen shows a picture of its device, with the panel over
// it, in a window or, without one, in an image of its own:
//
//     static result<std::unique_ptr<SCREEN>> create(const screen_options&);
//     SCREEN::device& device();
//     glfw_window* window();                      // null: headless
//     // Runs `count` stages; record(recorder, i) appends the i-th.
//     result<void> run(std::size_t count, Record&& record, std::span<double> seconds);
//     void begin_panel();                         // before ImGui::NewFrame
//     result<void> show(const image& picture);    // after ImGui::Render; the window has pixels
//     result<shown> read();                       // what was shown last
//
// The picture keeps its shape: bars fill what it leaves of the window.

#include <skybark/core/backend.hpp>

#include <cstdint>
#include <glm/vec2.hpp>
#include <string>
#include <vector>

namespace skybark::viewer {

struct screen_options {
    std::uint32_t width = 1280; ///< of the window at first, or of the image
    std::uint32_t height = 720;
    bool headless = false;
    bool scripted = false; ///< mouse and keyboard stay without effect
    /// Turns on the driver's own checks: what they say is added here.
    std::vector<std::string>* messages = nullptr;
};

/// RGBA8 rows from the top.
struct shown {
    std::vector<std::uint8_t> pixels;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
};

/// Where a picture of `picture` pixels goes in a window of `window`: as large as fits, in the
/// middle.
struct placed {
    glm::uvec2 low;
    glm::uvec2 high;
};
[[nodiscard]] placed place(glm::uvec2 picture, glm::uvec2 window);

} // namespace skybark::viewer
