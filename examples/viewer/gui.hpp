#pragma once
// gui: Dear ImGui's context, and what it must know where no window tells it.

#include <glm/vec2.hpp>

namespace skybark::viewer {

class gui {
  public:
    gui();
    gui(const gui&) = delete;
    gui& operator=(const gui&) = delete;
    ~gui();

    /// Between a screen's begin_panel and ImGui::NewFrame, where mouse and keyboard stay without
    /// effect: an image of `size` pixels, `seconds` after the last one.
    void without_input(glm::uvec2 size, double seconds);
};

} // namespace skybark::viewer
