// EXR files; where OpenEXR isn't there, a sentence.

#include "support/temporary_name.hpp"

#include <io/exr.hpp>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <vector>

using namespace skybark;

namespace {

std::string temporary(const std::string& name) { return support::temporary_name(name).string(); }

std::string bytes_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

} // namespace

// The header as the format's document has it ("OpenEXR File Layout"): magic number, version, then
// attributes; the data window says the size.
TEST(write_exr, writes_a_header) {
    if (!io::has_exr()) {
        GTEST_SKIP() << "built without OpenEXR";
    }
    const std::string path = temporary("header.exr");
    const std::vector<glm::vec4> pixels(3 * 2, glm::vec4(1, 2, 3, 4));
    const auto done = io::write_exr(path, pixels, 3, 2);
    ASSERT_TRUE(done) << done.error().message;
    const std::string bytes = bytes_of(path);
    std::filesystem::remove(path);
    ASSERT_GT(bytes.size(), 100u);
    EXPECT_EQ(bytes.substr(0, 4), "\x76\x2f\x31\x01");
    EXPECT_EQ(bytes[4], 2);
    const std::size_t channels = bytes.find(std::string("channels\0chlist\0", 16));
    ASSERT_NE(channels, std::string::npos);
    // Names, then the type of their numbers: 2 is a float of 32 bits.
    for (const char* name : {"A", "B", "G", "R"}) {
        EXPECT_NE(bytes.find(std::string(name) + std::string("\0\2\0\0\0", 5), channels),
                  std::string::npos)
            << name;
    }
    const std::size_t window = bytes.find(std::string("dataWindow\0box2i\0", 17));
    ASSERT_NE(window, std::string::npos);
    std::array<std::int32_t, 4> box{};
    std::memcpy(box.data(), bytes.data() + window + 17 + 4, sizeof box);
    EXPECT_EQ(box, (std::array<std::int32_t, 4>{0, 0, 2, 1}));
}

TEST(write_exr, names_what_cannot_be_written) {
    const std::vector<glm::vec4> pixels(6);
    const auto expect = [&](const std::string& path, std::uint32_t width, std::uint32_t height,
                            const std::string& part) {
        const auto done = io::write_exr(path, pixels, width, height);
        ASSERT_FALSE(done);
        EXPECT_EQ(done.error().message.back(), '.');
        EXPECT_NE(done.error().message.find(io::has_exr() ? part : "without OpenEXR"),
                  std::string::npos)
            << done.error().message;
    };
    expect(temporary("a.exr"), 0, 2, "0 x 2");
    expect(temporary("a.exr"), 2, 2, "2 x 2");
    expect(temporary("a.exr"), 100000, 1, "100000");
    expect("/nowhere/a.exr", 3, 2, "/nowhere");
    EXPECT_FALSE(std::filesystem::exists(temporary("a.exr")));
}
