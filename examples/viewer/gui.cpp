#include "gui.hpp"

#include <imgui.h>

namespace skybark::viewer {

gui::gui() {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::StyleColorsDark();
    ImGui::GetStyle().WindowRounding = 4;
    ImGui::GetStyle().Colors[ImGuiCol_WindowBg].w = 0.8f;
    ImGui::GetIO().IniFilename = nullptr; // nothing is left behind
}

gui::~gui() { ImGui::DestroyContext(); }

void gui::without_input(glm::uvec2 size, double seconds) {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {static_cast<float>(size.x), static_cast<float>(size.y)};
    io.DisplayFramebufferScale = {1, 1};
    io.DeltaTime = static_cast<float>(seconds);
}

} // namespace skybark::viewer
