#include "script.hpp"

#include <cmath>
#include <cstdio>
#include <io/word_lines.hpp>
#include <optional>

namespace skybark::viewer {

namespace {

constexpr double most_frames = 1e6;
constexpr double most_pixels = 1e5;
constexpr double most_steps = 1e3;

/// "a number from 1 to 90".
std::string range_text(const char* what, double low, double high) {
    char text[96];
    std::snprintf(text, sizeof text, "%s from %.6g to %.6g", what, low, high);
    return text;
}

/// One line: its words are taken off `rest`.
class line_reader {
  public:
    line_reader(const io::word_lines& lines, std::string_view rest) : lines_(lines), rest_(rest) {}

    result<step> read() {
        const std::string_view command = io::next_word(rest_);
        auto made = dispatch(command);
        if (made && !io::trimmed(rest_).empty()) {
            return lines_.fail_here(std::string(command) + " is followed by " +
                                    io::in_quotes(io::trimmed(rest_)) + ", which is too much.");
        }
        return made;
    }

  private:
    result<step> dispatch(std::string_view command) {
        if (command == "wait") {
            return read_wait();
        }
        if (command == "drag") {
            return read_drag();
        }
        if (command == "scroll") {
            return read_scroll();
        }
        if (command == "key") {
            return read_key();
        }
        if (command == "set") {
            return read_set();
        }
        if (command == "save") {
            return read_save();
        }
        return lines_.fail_here(io::in_quotes(command) +
                                " is no command; expected wait, drag, scroll, key, set or save.");
    }

    result<double> number(std::string_view command, double low, double high, bool whole) {
        const std::string expected = range_text(whole ? "a whole number" : "a number", low, high);
        std::string_view word = rest_;
        word = io::next_word(word);
        const auto value = lines_.number(command, rest_, low, high, expected);
        if (value && whole && *value != std::floor(*value)) {
            return lines_.fail_here(std::string(command) + " has " + io::in_quotes(word) +
                                    "; expected " + expected + ".");
        }
        return value;
    }

    result<step> read_wait() {
        const auto count = number("wait", 0, most_frames, true);
        if (!count) {
            return failure(count.error());
        }
        return wait_frames{static_cast<std::uint32_t>(*count)};
    }

    result<step> read_drag() {
        const std::string_view held = io::next_word(rest_);
        if (held != "left" && held != "middle") {
            return lines_.fail_here("drag has the button " + io::in_quotes(held) +
                                    "; expected left or middle.");
        }
        drag_pointer drag;
        drag.held = held == "left" ? button::left : button::middle;
        for (int axis = 0; axis < 2; ++axis) {
            const auto pixels = number("drag", -most_pixels, most_pixels, false);
            if (!pixels) {
                return failure(pixels.error());
            }
            drag.by[axis] = static_cast<float>(*pixels);
        }
        return drag;
    }

    result<step> read_scroll() {
        const auto steps = number("scroll", -most_steps, most_steps, false);
        if (!steps) {
            return failure(steps.error());
        }
        return scroll_wheel{static_cast<float>(*steps)};
    }

    result<step> read_key() {
        constexpr std::pair<std::string_view, key> known[] = {{"Space", key::space},
                                                              {"R", key::r},
                                                              {"H", key::h},
                                                              {"F12", key::f12},
                                                              {"Escape", key::escape}};
        const std::string_view word = io::next_word(rest_);
        for (const auto& [name, which] : known) {
            if (name == word) {
                return press_key{which};
            }
        }
        return lines_.fail_here("key has " + io::in_quotes(word) +
                                "; expected Space, R, H, F12 or Escape.");
    }

    result<step> read_set() {
        const std::string_view name = io::next_word(rest_);
        const knob* which = find_knob(name);
        if (which == nullptr) {
            std::string known;
            for (const knob& k : knobs()) {
                known.append(known.empty() ? "" : ", ").append(k.name);
            }
            return lines_.fail_here("set has " + io::in_quotes(name) + "; expected one of " +
                                    known + ".");
        }
        const auto value = number(name, which->low, which->high, which->kind == knob_kind::whole);
        if (!value) {
            return failure(value.error());
        }
        return turn_knob{which, *value};
    }

    result<step> read_save() {
        const std::string_view path = io::trimmed(rest_);
        rest_ = {};
        if (path.size() <= 4 || path.substr(path.size() - 4) != ".png") {
            return lines_.fail_here("save has " + io::in_quotes(path) +
                                    "; expected a file name that ends in .png.");
        }
        return save_picture{std::string(path)};
    }

    const io::word_lines& lines_;
    std::string_view rest_;
};

} // namespace

result<std::vector<step>> read_script(std::string_view name, std::string_view text) {
    std::vector<step> steps;
    io::word_lines lines(name, text);
    std::string_view line;
    while (lines.next(line)) {
        auto made = line_reader(lines, line).read();
        if (!made) {
            return failure(made.error());
        }
        steps.push_back(std::move(*made));
    }
    return steps;
}

} // namespace skybark::viewer
