#include "session.hpp"

namespace skybark::viewer {

void session::press(button which, bool down) { held_[static_cast<std::size_t>(which)] = down; }

void session::move_to(glm::vec2 place, float height) {
    const glm::vec2 by = place - pointer_;
    pointer_ = place;
    if (held_[static_cast<std::size_t>(button::left)]) {
        view = orbit(view, by, height);
    } else if (held_[static_cast<std::size_t>(button::middle)]) {
        view = pan(view, by, height);
    }
}

void session::scroll(float steps) { view = zoom(view, steps); }

void session::press(key which) {
    switch (which) {
    case key::space:
        paused = !paused;
        break;
    case key::r:
        view = first_view_;
        time = 0;
        break;
    case key::h:
        panel = !panel;
        break;
    case key::f12:
        save = true;
        break;
    case key::escape:
        quit = true;
        break;
    }
}

bool script_player::advance(session& on, float height) {
    save_as_.clear();
    if (waiting_ > 0) {
        --waiting_;
        return true;
    }
    while (next_ < steps_.size()) {
        if (play(steps_[next_++], on, height)) {
            return true;
        }
        if (on.quit) {
            return false;
        }
    }
    return false;
}

bool script_player::play(const step& what, session& on, float height) {
    if (const auto* wait = std::get_if<wait_frames>(&what)) {
        waiting_ = wait->count > 0 ? wait->count - 1 : 0;
        return wait->count > 0;
    }
    if (const auto* drag = std::get_if<drag_pointer>(&what)) {
        on.move_to({0, 0}, height);
        on.press(drag->held, true);
        on.move_to(drag->by, height);
        on.press(drag->held, false);
    } else if (const auto* wheel = std::get_if<scroll_wheel>(&what)) {
        on.scroll(wheel->steps);
    } else if (const auto* pressed = std::get_if<press_key>(&what)) {
        on.press(pressed->which);
        return on.save;
    } else if (const auto* turn = std::get_if<turn_knob>(&what)) {
        turn->which->set(on.now, turn->value);
    } else if (const auto* save = std::get_if<save_picture>(&what)) {
        save_as_ = save->path;
        return true;
    }
    return false;
}

} // namespace skybark::viewer
