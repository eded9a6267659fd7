// Mouse, keys and scripts, without a window.

#include <viewer/session.hpp>

#include <gtest/gtest.h>

namespace skybark::viewer {
namespace {

constexpr float height = 500;

class viewer_session : public testing::Test {
  protected:
    /// Plays a script to its end; true for each frame that is to be saved.
    std::vector<std::string> play(const std::string& text) {
        const auto steps = read_script("test", text);
        EXPECT_TRUE(steps) << (steps ? "" : steps.error().message);
        script_player player(*steps);
        std::vector<std::string> frames;
        while (player.advance(one, height)) {
            frames.push_back(player.save_as());
            EXPECT_LT(frames.size(), 1000u);
        }
        return frames;
    }

    const orbit_camera at_first{{1, 2, 3}, 20, 0.4f, 0.3f, 0.7f};
    session one{settings{}, at_first};
};

TEST_F(viewer_session, only_held_buttons_move_the_camera) {
    one.move_to({300, 200}, height);
    EXPECT_EQ(one.view, at_first);
    one.press(button::left, true);
    one.move_to({310, 205}, height);
    EXPECT_EQ(one.view, orbit(at_first, {10, 5}, height));
    one.press(button::left, false);
    const orbit_camera turned = one.view;
    one.move_to({0, 0}, height);
    EXPECT_EQ(one.view, turned);
    one.press(button::middle, true);
    one.move_to({3, -4}, height);
    EXPECT_EQ(one.view, pan(turned, {3, -4}, height));
    one.press(button::middle, false);
    one.scroll(2);
    EXPECT_EQ(one.view, zoom(pan(turned, {3, -4}, height), 2));
}

TEST_F(viewer_session, a_script_does_what_the_mouse_does) {
    session other{settings{}, at_first};
    other.press(button::left, true);
    other.move_to({30, -20}, height);
    other.press(button::left, false);
    other.scroll(3);
    EXPECT_TRUE(play("drag left 30 -20\nscroll 3").empty());
    EXPECT_EQ(one.view, other.view);
}

TEST_F(viewer_session, time_stands_still_after_space) {
    one.pass(0.5);
    one.press(key::space);
    one.pass(0.5);
    EXPECT_EQ(one.time, 0.5);
    one.press(key::space);
    one.pass(0.25);
    EXPECT_EQ(one.time, 0.75);
}

TEST_F(viewer_session, r_brings_camera_and_time_back_but_not_the_sliders) {
    one.pass(2);
    (void)play("drag left 30 -20\nset wind 11\nkey R");
    EXPECT_EQ(one.view, at_first);
    EXPECT_EQ(one.time, 0);
    EXPECT_EQ(one.now.weather.wind, 11);
    one.reset_settings();
    EXPECT_EQ(one.now, settings{});
}

TEST_F(viewer_session, h_and_escape) {
    one.press(key::h);
    EXPECT_FALSE(one.panel);
    one.press(key::h);
    EXPECT_TRUE(one.panel);
    EXPECT_TRUE(play("key Escape\nwait 5").empty()); // nothing comes after
    EXPECT_TRUE(one.quit);
}

TEST_F(viewer_session, frames_pass_while_a_script_waits_and_saves) {
    const std::vector<std::string> frames =
        play("wait 2\nwait 0\nsave a.png\nset cloud 0.5\nsave b.png\nkey F12");
    EXPECT_EQ(frames, (std::vector<std::string>{"", "", "a.png", "b.png", ""}));
    EXPECT_TRUE(one.save); // of the last one, under a free name
    EXPECT_EQ(one.now.weather.cloud, 0.5f);
}

} // namespace
} // namespace skybark::viewer
