// What the viewer refuses, with what words and what exit code.

#include "support.hpp"

namespace skybark::viewer {
namespace {

class viewer_usage : public program {};

TEST_F(viewer_usage, is_explained) {
    const outcome help = view("", {"--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_TRUE(
        tests::has(help.out, {"--backend", "--script", "--headless", "--sun", "Esc quits"}));
    const outcome version = view("", {"--version"});
    EXPECT_EQ(version.code, 0);
    EXPECT_TRUE(tests::has(version.out, {"."}));
}

TEST_F(viewer_usage, is_kept_to) {
    const std::pair<words, std::string> wrong[] = {
        {{"--backend", "cpu"}, "opengl or vulkan"},
        {{"--backend", "metal"}, "\"metal\""},
        {{"--size", "0x3"}, "\"0x3\""},
        {{"--headless"}, "--script"},
        {{"--trees", "nan"}, "\"nan\""},
        {{"--sun", "1"}, "AZIMUTH,ELEVATION"},
        {{"--fly"}, "--fly"},
        {{"scene.glb"}, "scene.glb"},
    };
    for (const auto& [arguments, named] : wrong) {
        const outcome done = view("", arguments);
        EXPECT_EQ(done.code, 2) << named;
        EXPECT_TRUE(tests::has(done.err, {"skybark_viewer: ", named, "--help"}));
    }
}

TEST_F(viewer_usage, scripts_are_read_before_anything_is_opened) {
    const outcome absent = view("", {"--headless", "--script", "none.txt"});
    EXPECT_EQ(absent.code, 1);
    EXPECT_TRUE(is_complaint(absent.err));
    EXPECT_TRUE(tests::has(absent.err, {"none.txt"}));
    tests::write_file(folder / "bad.txt", "wait 1\nset sun_elevation high\n");
    const outcome bad = view("", {"--headless", "--script", "bad.txt"});
    EXPECT_EQ(bad.code, 1);
    EXPECT_TRUE(is_complaint(bad.err));
    EXPECT_TRUE(tests::has(bad.err, {"Line 2 of \"bad.txt\"", "\"high\""}));
}

TEST_F(viewer_usage, a_window_needs_a_display) {
    for (const char* backend : {"opengl", "vulkan"}) {
        const outcome done = view("", {"--backend", backend});
        EXPECT_EQ(done.code, 3) << done.err;
        EXPECT_TRUE(is_complaint(done.err));
        EXPECT_TRUE(tests::has(done.err, {"--headless"}));
    }
}

} // namespace
} // namespace skybark::viewer
