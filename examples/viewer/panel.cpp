#include "panel.hpp"

#include <algorithm>
#include <cstdio>
#include <imgui.h>
#include <unistd.h>

namespace skybark::viewer {

namespace {

void draw_sliders(session& on, std::uint32_t most_bounces) {
    for (const knob& k : knobs()) {
        const bool bounces = k.name == "bounces";
        const double high = bounces ? static_cast<double>(most_bounces) : k.high;
        if (k.kind == knob_kind::whole) {
            int value = static_cast<int>(k.get(on.now));
            if (ImGui::SliderInt(k.label, &value, static_cast<int>(k.low), static_cast<int>(high),
                                 "%d", ImGuiSliderFlags_AlwaysClamp)) {
                k.set(on.now, value);
            }
        } else {
            auto value = static_cast<float>(k.get(on.now));
            if (ImGui::SliderFloat(
                    k.label, &value, static_cast<float>(k.low), static_cast<float>(high), k.format,
                    ImGuiSliderFlags_AlwaysClamp |
                        (k.kind == knob_kind::logarithmic ? ImGuiSliderFlags_Logarithmic : 0))) {
                k.set(on.now, static_cast<double>(value));
            }
        }
    }
}

void row(const char* name, const char* format, double value) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(name);
    ImGui::TableNextColumn();
    char text[48];
    std::snprintf(text, sizeof text, format, value);
    const float right = ImGui::GetCursorPosX() + ImGui::GetColumnWidth();
    ImGui::SetCursorPosX(right - ImGui::CalcTextSize(text).x);
    ImGui::TextUnformatted(text);
}

void draw_times(const report& tells) {
    if (!ImGui::BeginTable("times", 2, ImGuiTableFlags_BordersInnerH)) {
        return;
    }
    double total = 0;
    for (std::size_t i = 0; i < tells.stages.size() && i < tells.seconds.size(); ++i) {
        row(std::string(tells.stages[i]).c_str(), "%.2f ms", 1e3 * tells.seconds[i]);
        total += tells.seconds[i];
    }
    row("total", "%.2f ms", 1e3 * total);
    row("frame", "%.1f ms", 1e3 * tells.wall);
    row("triangles", "%.0f", static_cast<double>(tells.triangles));
    row("sent", "%.0f bytes", static_cast<double>(tells.sent));
    row("scene", "%.0f MiB", static_cast<double>(tells.scene) / (1024.0 * 1024.0));
    row("process", "%.0f MiB", static_cast<double>(tells.memory) / (1024.0 * 1024.0));
    ImGui::EndTable();
}

} // namespace

void draw_panel(session& on, const report& tells, std::uint32_t most_bounces) {
    ImGui::SetNextWindowPos({8, 8}, ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowSize({280, 0}, ImGuiCond_FirstUseEver);
    if (ImGui::Begin("Skybark")) {
        ImGui::PushItemWidth(-90);
        draw_sliders(on, most_bounces);
        if (ImGui::Button(on.paused ? "Go on" : "Pause")) {
            on.press(key::space);
        }
        ImGui::SameLine();
        if (ImGui::Button("Sliders back")) {
            on.reset_settings();
        }
        ImGui::TextWrapped("%s", tells.device.c_str());
        draw_times(tells);
        ImGui::TextDisabled("Space pauses, R resets,\nH hides, F12 saves, Esc quits.");
        ImGui::PopItemWidth();
    }
    ImGui::End();
}

std::uint64_t resident_bytes() {
    std::FILE* file = std::fopen("/proc/self/statm", "r");
    if (file == nullptr) {
        return 0;
    }
    unsigned long long pages = 0, resident = 0;
    const bool read = std::fscanf(file, "%llu %llu", &pages, &resident) == 2;
    std::fclose(file);
    const long page = ::sysconf(_SC_PAGESIZE);
    return read && page > 0 ? resident * static_cast<unsigned long long>(page) : 0;
}

} // namespace skybark::viewer
