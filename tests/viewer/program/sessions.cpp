// A scripted session, with a window and without, and one by mouse and keyboard. The drivers' own
// checks are on: they must have nothing to say.

#include "support.hpp"

#include <chrono>
#include <thread>

namespace skybark::viewer {
namespace {

class viewer_sessions : public program, public testing::WithParamInterface<const char*> {
  protected:
    [[nodiscard]] words arguments(const words& more) const {
        words all{"--backend", GetParam(), "--check", "--size", "320x200"};
        all.insert(all.end(), small.begin(), small.end());
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }

    /// The session, and whether it went well.
    void play(const std::string& on, const words& more) {
        tests::write_file(folder / "session.txt", "key Space\n"
                                                  "set bounces 0\n"
                                                  "wait 2\n"
                                                  "save panel.png\n"
                                                  "save panel_again.png\n"
                                                  "key H\n"
                                                  "save first.png\n"
                                                  "key F12\n"
                                                  "drag left 60 10\n"
                                                  "save orbit.png\n"
                                                  "drag middle -30 20\n"
                                                  "save pan.png\n"
                                                  "scroll 4\n"
                                                  "save zoom.png\n"
                                                  "set sun_elevation 8\n"
                                                  "save evening.png\n"
                                                  "set bounces 1\n"
                                                  "save bounced.png\n"
                                                  "set bounces 0\n"
                                                  "key Space\n"
                                                  "save later.png\n"
                                                  "key Escape\n"
                                                  "save never.png\n");
        words all{"--bounces", "1", "--script", "session.txt"};
        all.insert(all.end(), more.begin(), more.end());
        const outcome done = view(on, arguments(all));
        SKYBARK_SKIP_UNAVAILABLE(done, GetParam());
        ASSERT_EQ(done.code, 0) << done.err;
        EXPECT_EQ(done.err, "");
        EXPECT_EQ(names(),
                  (std::set<std::string>{"bounced.png", "evening.png", "first.png", "later.png",
                                         "orbit.png", "pan.png", "panel.png", "panel_again.png",
                                         "session.txt", "skybark_0001.png", "zoom.png"}));
    }

    /// What must be alike, and what must not.
    void expect_what_was_done() const {
        EXPECT_EQ(different("panel.png", "panel_again.png"), 0); // time stands still
        EXPECT_GT(different("panel.png", "first.png"), 0.3);     // what the panel covers
        EXPECT_EQ(different("first.png", "skybark_0001.png"), 0);
        EXPECT_GT(different("first.png", "orbit.png"), 0.2);
        EXPECT_GT(different("orbit.png", "pan.png"), 0.2);
        EXPECT_GT(different("pan.png", "zoom.png"), 0.2);
        EXPECT_GT(different("zoom.png", "evening.png"), 0.5);
        EXPECT_GT(different("evening.png", "bounced.png"), 0.005); // more light
        EXPECT_GT(different("evening.png", "later.png"), 0.01);    // it sways again
    }
};

TEST_P(viewer_sessions, without_a_window_and_in_one_show_the_same) {
    play("", {"--headless"});
    if (IsSkipped() || HasFatalFailure()) {
        return;
    }
    expect_what_was_done();
    std::vector<std::vector<unsigned char>> before;
    const words bare{"first.png",   "orbit.png",   "pan.png",  "zoom.png",
                     "evening.png", "bounced.png", "later.png"};
    for (const std::string& name : bare) {
        before.push_back(pixels(name));
    }
    for (const std::string& name : names()) {
        std::filesystem::remove(folder / name);
    }
    const display screen(beside());
    if (screen.name().empty()) {
        if (windows_are_required()) {
            FAIL() << "Xvfb does not start.";
        }
        GTEST_SKIP() << "Xvfb does not start.";
    }
    play(screen.name(), {});
    expect_what_was_done();
    for (std::size_t i = 0; i < bare.size(); ++i) {
        EXPECT_TRUE(pixels(bare[i]) == before[i]) << bare[i]; // bytes enough for no log
    }
}

/// Mouse and keyboard by the X server's own test extension.
class viewer_input : public viewer_sessions {
  protected:
    /// What xdotool was asked to do was done.
    [[nodiscard]] bool act(const std::string& on, const std::string& what) const {
        const std::string line = "DISPLAY=" + on + " timeout 120 xdotool " + what + " >/dev/null";
        return std::system(line.c_str()) == 0;
    }
    /// Presses F12 and waits for the picture.
    void save(const std::string& on, const std::string& name) const {
        ASSERT_TRUE(act(on, "key F12"));
        for (int tenths = 0; tenths < 1200; ++tenths) {
            if (std::filesystem::exists(folder / name)) {
                return;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        }
        FAIL() << name << " does not come.";
    }
    /// What the window shows is what was saved of it.
    void expect_on(const display& screen, const std::string& name, std::size_t width,
                   std::size_t height) const {
        const auto saved = pixels(name);
        for (int tenths = 0; tenths < 100; ++tenths) { // the X server takes its time
            if (screen.corner(width, height) == saved) {
                return;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        }
        FAIL() << name << " is not what the window shows.";
    }
};

TEST_P(viewer_input, reaches_the_camera_and_the_panel) {
    const display screen(beside());
    if (screen.name().empty() || std::system("command -v xdotool >/dev/null") != 0) {
        if (windows_are_required()) {
            FAIL() << "Xvfb or xdotool does not start.";
        }
        GTEST_SKIP() << "Xvfb or xdotool does not start.";
    }
    const std::string on = screen.name();
    const pid_t viewer = start(command(on, arguments({"--bounces", "0"})));
    ASSERT_TRUE(act(on, "search --sync --onlyvisible --name '^Skybark$'"));
    // Outside the panel, so that the window has the keys and the camera the mouse.
    ASSERT_TRUE(act(on, "mousemove 305 100 sleep 0.2 key space"));
    save(on, "skybark_0001.png");
    ASSERT_TRUE(act(on, "key h"));
    save(on, "skybark_0002.png");
    expect_on(screen, "skybark_0002.png", 320, 200);
    ASSERT_TRUE(act(on, "mousedown 1 sleep 0.1 mousemove 250 120 sleep 0.1 mouseup 1"));
    save(on, "skybark_0003.png");
    ASSERT_TRUE(act(on, "mousedown 2 sleep 0.1 mousemove 280 90 sleep 0.1 mouseup 2"));
    save(on, "skybark_0004.png");
    ASSERT_TRUE(act(on, "click 4 click 4 click 4"));
    save(on, "skybark_0005.png");
    // The slider of the sun's elevation is the second in the panel; a click on its left end lets
    // the sun set. A frame must show the panel before it can be clicked, and the pointer over it.
    ASSERT_TRUE(act(on, "key h"));
    save(on, "skybark_0006.png");
    ASSERT_TRUE(act(on, "mousemove 20 67"));
    save(on, "skybark_0007.png");
    ASSERT_TRUE(act(on, "click 1"));
    save(on, "skybark_0008.png");
    ASSERT_TRUE(act(on, "click 5 click 5 click 5")); // the wheel, over the panel
    save(on, "skybark_0009.png");
    ASSERT_TRUE(act(on, "key h"));
    save(on, "skybark_0010.png");
    // Another size: the picture keeps its shape, between bars.
    ASSERT_TRUE(act(on, "search --name '^Skybark$' windowsize --sync %@ 400 300"));
    save(on, "skybark_0011.png");
    expect_on(screen, "skybark_0011.png", 400, 300);
    ASSERT_TRUE(act(on, "key Escape"));
    const outcome done = finish(viewer);
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(done.err, "");
    EXPECT_GT(different("skybark_0001.png", "skybark_0002.png"), 0.3); // what the panel covers
    EXPECT_GT(different("skybark_0002.png", "skybark_0003.png"), 0.2); // the camera has turned,
    EXPECT_GT(different("skybark_0003.png", "skybark_0004.png"), 0.2); // moved aside,
    EXPECT_GT(different("skybark_0004.png", "skybark_0005.png"), 0.2); // and come nearer
    EXPECT_GT(different("skybark_0005.png", "skybark_0010.png"), 0.5); // the sun has set
    // The wheel scrolls the panel, and leaves the camera, right of it, where it is.
    EXPECT_GT(different("skybark_0008.png", "skybark_0009.png"), 0.02);
    const auto clicked = pixels("skybark_0008.png"), scrolled = pixels("skybark_0009.png");
    for (std::size_t y = 0; y < 200; ++y) {
        const std::size_t beside = 4 * (320 * y + 296);
        EXPECT_EQ(std::memcmp(&clicked[beside], &scrolled[beside], 4 * 24), 0) << y;
    }
    const auto wide = pixels("skybark_0011.png");
    ASSERT_EQ(wide.size(), 4u * 400 * 300);
    int seen = 0;
    for (std::size_t y = 0; y < 300; ++y) {
        const unsigned char* middle = &wide[4 * (400 * y + 200)];
        const bool black = middle[0] + middle[1] + middle[2] == 0;
        EXPECT_TRUE(black || (y >= 25 && y < 275)) << y;
        seen += black ? 0 : 1;
    }
    EXPECT_GT(seen, 200); // of 250 rows; evenings have dark corners
}

std::string name_of(const testing::TestParamInfo<const char*>& info) { return info.param; }
INSTANTIATE_TEST_SUITE_P(, viewer_sessions, testing::Values("opengl", "vulkan"), name_of);
INSTANTIATE_TEST_SUITE_P(, viewer_input, testing::Values("opengl", "vulkan"), name_of);

} // namespace
} // namespace skybark::viewer
