#pragma once
// script: what would be done by hand, as a text file.
//
//     # comments, and empty lines, are left out
//     wait 30                  30 frames pass
//     drag left 120 -40        the pointer goes so many pixels (x to the right, y down)
//     drag middle 0 50
//     scroll 3                 steps of the wheel; away is nearer
//     key Space                or R, H, F12, Escape
//     set sun_elevation 20     a slider: see settings.hpp
//     save shot.png            a frame is drawn and saved

#include "settings.hpp"

#include <skybark/core/result.hpp>

#include <glm/vec2.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace skybark::viewer {

enum class button { left, middle };
enum class key { space, r, h, f12, escape };

struct wait_frames {
    std::uint32_t count = 0;
};
struct drag_pointer {
    button held = button::left;
    glm::vec2 by{0}; ///< pixels, y down
};
struct scroll_wheel {
    float steps = 0;
};
struct press_key {
    key which = key::space;
};
struct turn_knob {
    const knob* which = nullptr;
    double value = 0;
};
struct save_picture {
    std::string path;
};
using step =
    std::variant<wait_frames, drag_pointer, scroll_wheel, press_key, turn_knob, save_picture>;

/// The script's steps. Errors name the line of `name`: words that are unknown, missing or too
/// many, numbers that are none or out of range.
[[nodiscard]] result<std::vector<step>> read_script(std::string_view name, std::string_view text);

} // namespace skybark::viewer
