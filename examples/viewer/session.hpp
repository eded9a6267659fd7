#pragma once
// session: what is looked at, and how input changes it. Knows neither windows nor devices.

#include "camera_control.hpp"
#include "script.hpp"
#include "settings.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace skybark::viewer {

class session {
  public:
    /// What it begins with, and goes back to at a reset.
    session(const settings& at_first, const orbit_camera& from)
        : now(at_first), view(from), first_(at_first), first_view_(from) {}

    // ---- input: pixels of a window `height` pixels high ---------------------------------------

    void press(button which, bool down);
    /// The pointer is at `place` now (y down).
    void move_to(glm::vec2 place, float height);
    void scroll(float steps);
    void press(key which);

    // ---- what follows from it ------------------------------------------------------------------

    /// Time goes on, unless it stands still.
    void pass(double seconds) { time += paused ? 0 : seconds; }
    /// The sliders as they were at first.
    void reset_settings() { now = first_; }

    settings now;
    orbit_camera view;
    double time = 0; ///< s
    bool paused = false;
    bool panel = true;
    bool quit = false;
    bool save = false; ///< the next frame, under the next free name

  private:
    settings first_;
    orbit_camera first_view_;
    bool held_[2] = {false, false};
    glm::vec2 pointer_{0};
};

/// Goes through a script, frame after frame.
class script_player {
  public:
    explicit script_player(std::span<const step> steps) : steps_(steps) {}

    /// Does what comes before the next frame. False: the script has ended, and no frame is needed.
    [[nodiscard]] bool advance(session& on, float height);
    /// The name under which the frame that now follows is to be saved; empty: it is not.
    [[nodiscard]] const std::string& save_as() const { return save_as_; }

  private:
    /// Whether the step needs a frame.
    bool play(const step& what, session& on, float height);

    std::span<const step> steps_;
    std::size_t next_ = 0;
    std::uint32_t waiting_ = 0;
    std::string save_as_;
};

} // namespace skybark::viewer
