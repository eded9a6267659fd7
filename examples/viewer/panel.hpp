#pragma once
// panel: the sliders, and what the device took for each stage, drawn by Dear ImGui.

#include "session.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace skybark::viewer {

/// What the panel tells.
struct report {
    std::string device;                       ///< its name, after that of the backend
    std::span<const std::string_view> stages; ///< their names,
    std::span<const double> seconds;          ///< and how long each took on the device
    std::uint64_t triangles = 0;
    std::uint64_t sent = 0;   ///< bytes, to the device for this frame
    std::uint64_t scene = 0;  ///< bytes that the scene has of the device's memory
    std::uint64_t memory = 0; ///< bytes that this process has of the machine's
    double wall = 0;          ///< s from a frame to the next
};

/// Between ImGui::NewFrame and ImGui::Render. `most_bounces` ends that slider.
void draw_panel(session& on, const report& tells, std::uint32_t most_bounces);

/// The memory that this process has of the machine's, bytes; 0 where the system does not say.
[[nodiscard]] std::uint64_t resident_bytes();

} // namespace skybark::viewer
