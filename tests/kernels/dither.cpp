// What develop rounds to 8 bits: no contours, nothing added on average, and the same everywhere.

#include "support/devices.hpp"

#include <skybark/kernels/develop.hpp>
#include <skybark/shared/dither.hpp>

#include <cmath>
#include <gtest/gtest.h>
#include <set>

using namespace skybark;

namespace {

TEST(dither, each_square_of_8_has_every_shift_once) {
    for (const auto& [left, top] : {std::pair{0, 0}, std::pair{8, 0}, std::pair{800, 1208}}) {
        std::set<double> shifts;
        for (int y = 0; y < 8; ++y) {
            for (int x = 0; x < 8; ++x) {
                shifts.insert(double{shared::ordered_dither(left + x, top + y)});
            }
        }
        double expected = -0.5 + 1.0 / 128;
        ASSERT_EQ(shifts.size(), 64u);
        for (const double shift : shifts) {
            EXPECT_EQ(shift, expected); // eighths of sixteenths: exact in floats
            expected += 1.0 / 64;
        }
    }
    // Neighbours are far apart: in each square of 2, a quarter of a step and more.
    for (int y = 0; y < 8; y += 2) {
        for (int x = 0; x < 8; x += 2) {
            const float a = shared::ordered_dither(x, y);
            EXPECT_GE(std::abs(a - shared::ordered_dither(x + 1, y)), 0.25f);
            EXPECT_GE(std::abs(a - shared::ordered_dither(x, y + 1)), 0.25f);
            EXPECT_GE(std::abs(a - shared::ordered_dither(x + 1, y + 1)), 0.25f);
        }
    }
}

/// What a display shows for a radiance, in double: Narkowicz' curve, then sRGB.
double shown(double x) {
    const double c = std::clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
    return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

class dither : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(backends, dither, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& one) { return std::string(one.param); });

TEST_P(dither, a_picture_has_the_mean_of_what_it_shows_and_black_and_white_stay) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const std::uint32_t width = 64;
        const std::uint32_t height = 16;
        auto from = *device.create_image({width, height, image_format::rgba32f});
        auto to = *device.create_image({width, height, image_format::rgba8});
        // Squares of 8 × 8, each of one radiance: less than a step between them.
        const auto radiance = [](std::uint32_t square) {
            return square == 0 ? 0.0f : (square == 15 ? 1000.0f : 0.2f + 0.0005f * float(square));
        };
        std::vector<glm::vec4> pixels;
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x) {
                pixels.emplace_back(glm::vec3(radiance(x / 8 + 8 * (y / 8))), 1.0f);
            }
        }
        ASSERT_TRUE(device.upload(from, std::as_bytes(std::span(pixels))));
        const auto done = run(device, [&](typename B::recorder& r) {
            draw_geometry<B> screen;
            screen.count = 3;
            r.draw(kernels::develop{1, 1.0f}, {},
                   {sampled_image<B>{&from, filter_mode::nearest, wrap_mode::clamp}}, screen,
                   draw_target<B>{&to, nullptr, {}, {}}, draw_state{false, false});
        });
        ASSERT_TRUE(done) << done.error().message;
        std::vector<std::uint8_t> shown_pixels(std::size_t{4} * width * height);
        ASSERT_TRUE(device.download(to, std::as_writable_bytes(std::span(shown_pixels))));
        for (std::uint32_t square = 0; square < 16; ++square) {
            double sum = 0;
            std::set<int> values;
            for (std::uint32_t i = 0; i < 64; ++i) {
                const std::uint32_t x = 8 * (square % 8) + i % 8;
                const std::uint32_t y = 8 * (square / 8) + i / 8;
                const int value = shown_pixels[std::size_t{4} * (x + width * y)];
                sum += value;
                values.insert(value);
            }
            // 64 shifts 1/64 apart: the mean is right within half of one, and of the display's
            // curve a hundredth of a step may be lost to `pow`.
            EXPECT_NEAR(sum / 64, 255 * shown(double{radiance(square)}), 1.0 / 128 + 0.02)
                << square;
            EXPECT_LE(values.size(), square == 0 || square == 15 ? 1u : 2u) << square;
        }
    });
}

} // namespace
