// The names of numbered files.

#include <tool/frame_name.hpp>

#include <gtest/gtest.h>
#include <random>
#include <string>

using skybark::tool::frame_name;

namespace {

std::string name_of(const char* pattern, std::uint32_t frame) {
    const auto name = frame_name::parse(pattern);
    EXPECT_TRUE(name) << name.error().message;
    return name ? name->of(frame) : "";
}

} // namespace

TEST(frame_name, has_one_place_for_the_number) {
    EXPECT_EQ(name_of("a_%04d.png", 7), "a_0007.png");
    EXPECT_EQ(name_of("a_%04d.png", 0), "a_0000.png");
    EXPECT_EQ(name_of("a_%04d.png", 12345), "a_12345.png");
    EXPECT_EQ(name_of("%d.obj", 12), "12.obj");
    EXPECT_EQ(name_of("%01d", 3), "3");
    EXPECT_EQ(name_of("x/%09d/y", 4294967295u), "x/4294967295/y");
    EXPECT_EQ(name_of("x/%09d/y", 1), "x/000000001/y");
    EXPECT_EQ(name_of("100%%_%d%%.png", 2), "100%_2%.png");
}

TEST(frame_name, may_have_none) {
    EXPECT_FALSE(frame_name::parse("a.png")->is_numbered());
    EXPECT_FALSE(frame_name::parse("")->is_numbered());
    EXPECT_FALSE(frame_name::parse("%%d.png")->is_numbered());
    EXPECT_EQ(name_of("%%d.png", 5), "%d.png");
}

TEST(frame_name, refuses_everything_else) {
    for (const char* pattern :
         {"%s.png",   "%n.png",      "a%",      "%4d.png",    "%-4d.png",   "%+d.png", "% d.png",
          "%00d.png", "%010d.png",   "%0d.png", "%ld.png",    "%u.png",     "%i.png",  "%x.png",
          "%04D.png", "%*d.png",     "%1$d",    "%0",         "%04",        "%.4d",    "%",
          "%d%d.png", "%04d_%d.png", "%%%",     "%d%s%n.png", "50% off.png"}) {
        const auto name = frame_name::parse(pattern);
        ASSERT_FALSE(name) << pattern;
        EXPECT_NE(name.error().message.find(std::string("\"") + pattern + '"'), std::string::npos)
            << name.error().message;
        EXPECT_NE(name.error().message.find("expected"), std::string::npos);
        EXPECT_EQ(name.error().message.back(), '.');
    }
}

// Any text is a name or an error; a name has what isn't a conversion, byte by byte.
TEST(frame_name, takes_any_text) {
    std::mt19937 random(1);
    const std::string letters = "%%%%0d049sn\\/\xff a";
    for (int i = 0; i < 20000; ++i) {
        std::string pattern;
        for (auto n = random() % 9; n > 0; --n) {
            pattern += letters[random() % letters.size()];
        }
        const auto name = frame_name::parse(pattern);
        if (!name) {
            EXPECT_FALSE(name.error().message.empty());
            continue;
        }
        EXPECT_EQ(name->is_numbered(), name->of(1) != name->of(2)) << pattern;
        EXPECT_LE(name->of(0).size(), pattern.size() + 9);
    }
}
