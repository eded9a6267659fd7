#include "support/temporary_name.hpp"

#include <io/write_png.hpp>

#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <vector>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#include <stb/stb_image.h>

using namespace skybark;

namespace {

struct picture {
    std::uint32_t width;
    std::uint32_t height;
    std::vector<std::uint8_t> pixels;
};

/// Every pixel another colour, transparent ones too.
picture test_picture(std::uint32_t width, std::uint32_t height) {
    picture p{width, height, {}};
    for (std::uint32_t i = 0; i < width * height; ++i) {
        for (const std::uint32_t value : {i, i * 7 + 3, i / width, i * 31}) {
            p.pixels.push_back(static_cast<std::uint8_t>(value));
        }
    }
    return p;
}

std::string temporary(const char* name) {
    return support::temporary_name(std::string(name)).string();
}

} // namespace

TEST(write_png, is_read_back_as_it_was) {
    for (const auto& [width, height] : {std::pair{1u, 1u}, {7u, 5u}, {300u, 2u}, {64u, 257u}}) {
        const picture p = test_picture(width, height);
        const std::string path = temporary("round.png");
        const auto done = io::write_png(path, p.pixels, width, height);
        ASSERT_TRUE(done) << done.error().message;
        int w = 0;
        int h = 0;
        int channels = 0;
        stbi_uc* read = stbi_load(path.c_str(), &w, &h, &channels, 0);
        ASSERT_NE(read, nullptr);
        EXPECT_EQ(w, static_cast<int>(width));
        EXPECT_EQ(h, static_cast<int>(height));
        ASSERT_EQ(channels, 4);
        EXPECT_EQ(std::vector<std::uint8_t>(read, read + p.pixels.size()), p.pixels);
        stbi_image_free(read);
        std::filesystem::remove(path);
    }
}

TEST(write_png, refuses_sizes_that_do_not_fit) {
    const std::vector<std::uint8_t> pixels(16);
    for (const auto& [width, height] : {std::pair{0u, 4u},
                                        {4u, 0u},
                                        {2u, 3u},
                                        {16385u, 1u},
                                        {65536u, 65536u},
                                        {0x40000001u, 4u}}) {
        const auto done = io::write_png(temporary("none.png"), pixels, width, height);
        ASSERT_FALSE(done);
        EXPECT_NE(done.error().message.find(std::to_string(width)), std::string::npos);
        EXPECT_FALSE(std::filesystem::exists(temporary("none.png")));
    }
}
