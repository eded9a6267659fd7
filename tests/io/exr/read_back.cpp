// What is written as EXR, read back by OpenEXR itself.

#include "support/temporary_name.hpp"

#include <io/exr.hpp>

#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <limits>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <vector>

using namespace skybark;

TEST(write_exr, is_read_back_bit_for_bit) {
    constexpr std::uint32_t width = 37;
    constexpr std::uint32_t height = 21;
    std::vector<glm::vec4> pixels(width * height);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const auto x = static_cast<float>(i);
        pixels[i] = {x, -x * 1e-20f, 1e30f / (1 + x), std::sqrt(x)};
    }
    pixels[5].x = std::numeric_limits<float>::infinity();
    const std::string path = support::temporary_name("back.exr").string();
    const auto done = io::write_exr(path, pixels, width, height);
    ASSERT_TRUE(done) << done.error().message;
    std::vector<glm::vec4> back(pixels.size());
    {
        Imf::InputFile file(path.c_str());
        Imf::FrameBuffer frame;
        const char* const names[] = {"R", "G", "B", "A"};
        for (std::size_t c = 0; c < 4; ++c) {
            ASSERT_NE(file.header().channels().findChannel(names[c]), nullptr);
            frame.insert(names[c],
                         Imf::Slice(Imf::FLOAT,
                                    reinterpret_cast<char*>(back.data()) + c * sizeof(float),
                                    sizeof(glm::vec4), sizeof(glm::vec4) * width));
        }
        file.setFrameBuffer(frame);
        file.readPixels(0, static_cast<int>(height) - 1);
    }
    std::filesystem::remove(path);
    EXPECT_EQ(back, pixels);
}
