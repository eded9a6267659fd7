#pragma once
// The viewer itself, for the screen of any backend.

#include "gui.hpp"
#include "options.hpp"
#include "panel.hpp"
#include "picture_file.hpp"
#include "session.hpp"

#include <meadow/meadow.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <imgui.h>
#include <unistd.h>

namespace skybark::viewer {

/// Of a script's frames, s.
inline constexpr double script_step = 1.0 / 30;
/// Time does not go on by more than this from one frame to the next, s.
inline constexpr double longest_step = 0.1;

/// What the options ask for, its angles as the sliders count them.
[[nodiscard]] inline settings settings_of(const options& asked) {
    settings first{asked.scene.now, asked.scene.lod, std::min(2u, asked.scene.what.bounces)};
    first.weather.sun_azimuth += first.weather.sun_azimuth < 0 ? 360 : 0;
    first.weather.wind_from += first.weather.wind_from < 0 ? 360.0f : 0.0f;
    return first;
}

template <class Screen>
class viewer {
  public:
    using device = typename Screen::device_type;
    using meadow_type = meadow::meadow<device>;

    viewer(const options& asked, Screen& screen, meadow_type& scene, gui& panel)
        : asked_(asked), screen_(screen), scene_(scene), gui_(panel),
          ground_([&scene](float x, float z) { return scene.ground(x, z); }),
          session_(settings_of(asked), orbit_of(asked.scene.from, ground_)),
          player_(asked.script ? std::span<const step>(*asked.script) : std::span<const step>()) {
        tells_.device = std::string(screen.device().name()) + ": " + screen.device().device_name();
        tells_.stages = meadow::stage_names;
        tells_.seconds = seconds_;
        if (!scripted() && screen.window() != nullptr) {
            screen.window()->listen(session_);
        }
    }
    viewer(const viewer&) = delete;
    viewer& operator=(const viewer&) = delete;

    [[nodiscard]] result<void> run() {
        auto last = clock::now();
        while (next_input()) {
            const auto now = clock::now();
            const double passed = std::chrono::duration<double>(now - last).count();
            last = now;
            if (drawn_.any) {
                session_.pass(scripted() ? script_step : std::min(passed, longest_step));
            }
            if (hidden()) {
                continue;
            }
            if (auto done = show(passed); !done) {
                return done;
            }
            if (auto done = save_pictures(); !done) {
                return done;
            }
        }
        return {};
    }

  private:
    using clock = std::chrono::steady_clock;

    /// What the picture on the device shows.
    struct drawn {
        bool any = false;
        settings now;
        orbit_camera view;
        double time = 0;
    };

    [[nodiscard]] bool scripted() const { return asked_.screen.scripted; }

    /// Takes what was done by hand, or the script's next lines. False: it is over.
    [[nodiscard]] bool next_input() {
        if (screen_.window() != nullptr) {
            // Where time stands still, only input changes what is seen.
            const bool idle = (session_.paused && up_to_date()) || hidden();
            screen_.window()->poll(!scripted() && idle ? 0.05 : 0);
            if (screen_.window()->closed()) {
                return false;
            }
        }
        if (scripted() && !player_.advance(session_, height())) {
            return false;
        }
        return !session_.quit;
    }

    /// The window is there, but without a pixel to be seen.
    [[nodiscard]] bool hidden() const {
        return screen_.window() != nullptr &&
               (screen_.window()->framebuffer().x == 0 || screen_.window()->framebuffer().y == 0);
    }
    /// Of the window, in the pointer's units.
    [[nodiscard]] glm::uvec2 size() const {
        return screen_.window() != nullptr ? screen_.window()->size()
                                           : glm::uvec2(asked_.screen.width, asked_.screen.height);
    }
    [[nodiscard]] float height() const { return static_cast<float>(std::max(size().y, 1u)); }

    [[nodiscard]] bool up_to_date() const {
        return drawn_.any && drawn_.now == session_.now && drawn_.view == session_.view &&
               drawn_.time == session_.time;
    }

    [[nodiscard]] result<void> show(double passed) {
        if (!up_to_date()) {
            if (auto done = draw_scene(passed); !done) {
                return done;
            }
        }
        // Windows of Dear ImGui's find their size in the first frames, and are not seen until then.
        for (; settling_ > 0; --settling_) {
            draw_gui();
        }
        draw_gui();
        return screen_.show(scene_.picture());
    }

    void draw_gui() {
        screen_.begin_panel();
        if (scripted()) {
            gui_.without_input(size(), script_step);
        }
        ImGui::NewFrame();
        if (session_.panel) {
            draw_panel(session_, tells_, asked_.scene.what.bounces);
        }
        ImGui::Render();
    }

    /// The stages of a frame, and what they took.
    [[nodiscard]] result<void> draw_scene(double passed) {
        if (!drawn_.any || !(drawn_.now.weather == session_.now.weather)) {
            if (auto done = scene_.change(session_.now.weather); !done) {
                return done;
            }
        }
        scene_.look(camera_of(session_.view, ground_), session_.now.detail);
        scene_.bounce(std::min(session_.now.bounces, asked_.scene.what.bounces));
        const std::uint64_t sent = screen_.device().traffic().up;
        if (auto done = record_scene(); !done) {
            return done;
        }
        tells_.sent = screen_.device().traffic().up - sent;
        drawn_ = {true, session_.now, session_.view, session_.time};
        const meadow::contents held = scene_.holds();
        tells_.scene = held.stand_bytes + held.cloud_bytes + held.light_bytes + held.picture_bytes;
        tells_.memory = resident_bytes();
        tells_.wall = passed;
        const auto triangles = scene_.triangles();
        if (!triangles) {
            return failure(triangles.error());
        }
        tells_.triangles = *triangles;
        return {};
    }

    /// Again, where triangles did not fit: there is more room for them then.
    [[nodiscard]] result<void> record_scene() {
        constexpr int most_turns = 4;
        for (int turn = 0; turn < most_turns; ++turn) {
            scene_.begin_frame(session_.time);
            auto done = screen_.run(
                meadow::stages.size(),
                [this](auto& recorder, std::size_t i) {
                    scene_.record(recorder, meadow::stages[i]);
                },
                seconds_);
            if (!done) {
                return done;
            }
            const auto more = scene_.update();
            if (!more) {
                return failure(more.error());
            }
            if (!*more) {
                break;
            }
        }
        return {};
    }

    [[nodiscard]] result<void> save_pictures() {
        if (!player_.save_as().empty()) {
            if (auto done = save_as(player_.save_as()); !done) {
                return done;
            }
        }
        if (!session_.save) {
            return {};
        }
        session_.save = false;
        auto name = next_free_name(".");
        auto done = name ? save_as(*name) : result<void>(failure(name.error()));
        if (!done && !scripted()) {
            complain(done.error().message); // and go on: there may be room by the next time
            return {};
        }
        return done;
    }

    [[nodiscard]] result<void> save_as(const std::string& path) {
        auto picture = screen_.read();
        if (!picture) {
            return failure(picture.error());
        }
        return save(path, std::move(*picture));
    }

    const options& asked_;
    Screen& screen_;
    meadow_type& scene_;
    gui& gui_;
    land_height ground_;
    session session_;
    script_player player_;
    drawn drawn_;
    std::array<double, meadow::stages.size()> seconds_{};
    report tells_;
    int settling_ = 2;
};

/// Opens a screen, grows the meadow and shows it until somebody has seen enough.
template <class Screen>
[[nodiscard]] result<void> show_meadow(const options& asked, const screen_options& to) {
    gui panel;
    auto screen = Screen::create(to);
    if (!screen) {
        return failure(screen.error());
    }
    if (::isatty(STDERR_FILENO) == 1) { // it takes seconds
        std::fprintf(stderr, "Growing a meadow of %u trees.\n", asked.scene.what.trees);
    }
    auto scene = meadow::meadow<typename Screen::device_type>::create(
        (*screen)->device(), asked.scene.what, asked.scene.now, asked.scene.from);
    if (!scene) {
        return failure(scene.error());
    }
    return viewer<Screen>(asked, **screen, *scene, panel).run();
}

/// The same. An error as well: what the driver's checks have to say, to the last object's end.
template <class Screen>
[[nodiscard]] result<void> view_meadow(const options& asked) {
    std::vector<std::string> messages;
    screen_options to = asked.screen;
    to.messages = asked.checked ? &messages : nullptr;
    auto done = show_meadow<Screen>(asked, to);
    if (done && !messages.empty()) {
        return fail(error_code::bad_input, std::string("The driver's own checks gave ") +
                                               std::to_string(messages.size()) +
                                               " messages; the first: " + messages.front());
    }
    return done;
}

/// One for each backend, compiled apart.
[[nodiscard]] result<void> view_opengl(const options& asked);
[[nodiscard]] result<void> view_vulkan(const options& asked);

} // namespace skybark::viewer
