// What scripts may say, and what is said of those that may not be.

#include <viewer/script.hpp>

#include <gtest/gtest.h>

namespace skybark::viewer {
namespace {

TEST(script, each_command_becomes_a_step) {
    const auto read = read_script("a.txt", "# a walk\n"
                                           "wait 30\r\n"
                                           "\n"
                                           "  drag left 120 -40.5\n"
                                           "drag\tmiddle 0 50\n"
                                           "scroll -3\n"
                                           "key F12\n"
                                           "set sun_elevation 20.5\n"
                                           "set bounces 3\n"
                                           "save a picture.png");
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->size(), 8u);
    EXPECT_EQ(std::get<wait_frames>((*read)[0]).count, 30u);
    EXPECT_EQ(std::get<drag_pointer>((*read)[1]).held, button::left);
    EXPECT_EQ(std::get<drag_pointer>((*read)[1]).by, glm::vec2(120, -40.5f));
    EXPECT_EQ(std::get<drag_pointer>((*read)[2]).held, button::middle);
    EXPECT_EQ(std::get<scroll_wheel>((*read)[3]).steps, -3);
    EXPECT_EQ(std::get<press_key>((*read)[4]).which, key::f12);
    EXPECT_EQ(std::get<turn_knob>((*read)[5]).which->name, "sun_elevation");
    EXPECT_EQ(std::get<turn_knob>((*read)[5]).value, 20.5);
    EXPECT_EQ(std::get<turn_knob>((*read)[6]).which->name, "bounces");
    EXPECT_EQ(std::get<save_picture>((*read)[7]).path, "a picture.png");
}

TEST(script, nothing_is_a_script_as_well) {
    for (const char* text : {"", "\n\n", "# only words", "\xEF\xBB\xBF"}) {
        const auto read = read_script("a.txt", text);
        ASSERT_TRUE(read) << read.error().message;
        EXPECT_TRUE(read->empty());
    }
}

/// A line that is wrong, and what the sentence must name.
struct wrong_line {
    const char* line;
    const char* named;
};

TEST(script, wrong_lines_are_named_with_what_is_wrong) {
    const wrong_line lines[] = {
        {"jump 3", "\"jump\" is no command"},
        {"WAIT 3", "\"WAIT\""},
        {"wait", "too few numbers"},
        {"wait x", "\"x\""},
        {"wait -1", "\"-1\""},
        {"wait 1.5", "\"1.5\""},
        {"wait nan", "\"nan\""},
        {"wait 1e99", "\"1e99\""},
        {"wait 1000001", "from 0 to 1e+06"},
        {"wait 3 4", "\"4\""},
        {"drag", "expected left or middle"},
        {"drag right 1 2", "\"right\""},
        {"drag left 1", "too few numbers"},
        {"drag left 1 inf", "\"inf\""},
        {"drag left 1 NaN", "\"NaN\""},
        {"drag left 1 2 3", "\"3\""},
        {"drag left 1e6 0", "\"1e6\""},
        {"scroll", "too few numbers"},
        {"scroll up", "\"up\""},
        {"scroll 1e4", "\"1e4\""},
        {"key", "expected Space, R, H, F12 or Escape"},
        {"key space", "\"space\""},
        {"key H H", "\"H\""},
        {"set", "expected one of sun_azimuth"},
        {"set sun 3", "\"sun\""},
        {"set sun_elevation", "too few numbers"},
        {"set sun_elevation 91", "from 0 to 90"},
        {"set sun_elevation nan", "\"nan\""},
        {"set cloud -0.1", "\"-0.1\""},
        {"set bounces 1.5", "a whole number from 0 to 16"},
        {"save", "ends in .png"},
        {"save .png", "\".png\""},
        {"save picture.jpg", "\"picture.jpg\""},
        {"w\x01\xff", "\\x01\\xff"},
    };
    for (const auto& [line, named] : lines) {
        const auto read = read_script("walk.txt", "wait 1\n# fine\n" + std::string(line) + "\n");
        ASSERT_FALSE(read) << line;
        EXPECT_EQ(read.error().code, error_code::bad_input);
        EXPECT_NE(read.error().message.find("Line 3 of \"walk.txt\""), std::string::npos)
            << read.error().message;
        EXPECT_NE(read.error().message.find(named), std::string::npos)
            << line << ": " << read.error().message;
        EXPECT_EQ(read.error().message.back(), '.');
    }
}

TEST(script, every_knob_can_be_set_over_its_range_and_no_farther) {
    for (const knob& k : knobs()) {
        for (const double end : {k.low, k.high}) {
            settings turned;
            k.set(turned, end);
            EXPECT_NEAR(k.get(turned), end, 1e-6 * (1 + std::abs(end))) << k.name;
        }
        const std::string beyond = std::to_string(k.high + 1);
        EXPECT_FALSE(read_script("a", "set " + std::string(k.name) + " " + beyond)) << k.name;
    }
}

} // namespace
} // namespace skybark::viewer
