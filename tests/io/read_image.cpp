// Bark textures from picture files, whole and broken.

#include <io/read_image.hpp>
#include <io/write_png.hpp>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

using namespace skybark;

namespace {

/// A file of these bytes that is gone after the test.
class temporary_file {
  public:
    explicit temporary_file(const std::string& bytes)
        : path_((std::filesystem::temp_directory_path() /
                 ("skybark_read_image_" +
                  std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) +
                  ".png"))
                    .string()) {
        std::ofstream(path_, std::ios::binary) << bytes;
    }
    ~temporary_file() { std::remove(path_.c_str()); }
    temporary_file(const temporary_file&) = delete;
    temporary_file& operator=(const temporary_file&) = delete;

    [[nodiscard]] const std::string& path() const { return path_; }
    [[nodiscard]] std::string bytes() const {
        std::ifstream in(path_, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }

  private:
    std::string path_;
};

/// 3 x 2 pixels: black, grey, white; red, green, blue.
void write_small_picture(const std::string& path) {
    const std::vector<std::uint8_t> pixels{0,   0, 0, 255, 102, 102, 102, 255, 255, 255, 255, 255,
                                           255, 0, 0, 255, 0,   255, 0,   255, 0,   0,   255, 255};
    ASSERT_TRUE(io::write_png(path, pixels, 3, 2));
}

} // namespace

TEST(read_image, grey_values_and_lumas_are_heights) {
    const temporary_file file("");
    write_small_picture(file.path());
    const auto texture = io::read_image(file.path());
    ASSERT_TRUE(texture) << texture.error().message;
    ASSERT_EQ(texture->width, 3u);
    ASSERT_EQ(texture->height, 2u);
    // Rec. 601 luma in whole 1/256, then a step of a byte.
    const float expected[] = {0, 0.4f, 1, 0.299f, 0.587f, 0.114f};
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_NEAR(texture->heights[i], expected[i], 0.006) << i;
    }
}

TEST(read_image, what_is_missing_or_no_picture_is_said) {
    const auto missing = io::read_image("/nonexistent/bark.png");
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, error_code::unavailable);
    EXPECT_NE(missing.error().message.find("/nonexistent/bark.png"), std::string::npos);
    for (const char* bytes : {"", "no picture", "\x89PNG\r\n\x1a\n"}) {
        const temporary_file file(bytes);
        const auto texture = io::read_image(file.path());
        ASSERT_FALSE(texture);
        EXPECT_EQ(texture.error().code, error_code::bad_input);
        EXPECT_EQ(texture.error().message.back(), '.');
    }
}

TEST(read_image, a_picture_that_ends_early_is_refused) {
    const temporary_file whole("");
    write_small_picture(whole.path());
    const std::string bytes = whole.bytes();
    for (std::size_t length = 0; length + 13 < bytes.size(); ++length) {
        std::ofstream(whole.path(), std::ios::binary | std::ios::trunc) << bytes.substr(0, length);
        ASSERT_FALSE(io::read_image(whole.path())) << length;
    }
}

TEST(read_image, sizes_of_nothing_and_beyond_measure_are_refused) {
    const temporary_file file("");
    write_small_picture(file.path());
    const std::string bytes = file.bytes();
    for (const std::string& side : {std::string("\0\0\0\0", 4), std::string("\0\1\0\0", 4),
                                    std::string("\x7f\xff\xff\xff", 4)}) {
        for (const std::size_t at : {16u, 20u}) { // width and height in the IHDR chunk
            std::string broken = bytes;
            broken.replace(at, 4, side);
            std::ofstream(file.path(), std::ios::binary | std::ios::trunc) << broken;
            const auto texture = io::read_image(file.path());
            ASSERT_FALSE(texture);
            EXPECT_EQ(texture.error().code, error_code::bad_input);
        }
    }
}
