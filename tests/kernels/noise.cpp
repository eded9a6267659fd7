// Noise: range, evenness, period and smoothness.

#include <skybark/shared/noise.hpp>

#include "support/random.hpp"

#include <array>
#include <cmath>
#include <gtest/gtest.h>

using namespace skybark;

TEST(noise, hash_is_even_over_0_to_1) {
    std::array<int, 16> bins{};
    double sum = 0;
    constexpr int side = 64;
    for (std::uint32_t x = 0; x < side; ++x) {
        for (std::uint32_t y = 0; y < side; ++y) {
            for (std::uint32_t z = 0; z < side; ++z) {
                const float h = shared::hash_unit(x, y, z);
                ASSERT_GE(h, 0);
                ASSERT_LT(h, 1);
                ++bins[static_cast<std::size_t>(h * 16)];
                sum += double{h};
            }
        }
    }
    constexpr double n = side * side * side;
    // Six standard deviations of a fair draw: √(n p (1 − p)), and 1/√(12 n) of the mean.
    for (const int bin : bins) {
        EXPECT_NEAR(bin, n / 16, 6 * std::sqrt(n / 16 * 15 / 16));
    }
    EXPECT_NEAR(sum / n, 0.5, 6 / std::sqrt(12 * n));
}

TEST(noise, hash_depends_on_every_coordinate) {
    int same = 0;
    for (std::uint32_t i = 0; i < 1000; ++i) {
        const float h = shared::hash_unit(i, 7, 9);
        same += h == shared::hash_unit(i + 1, 7, 9) ? 1 : 0;
        same += h == shared::hash_unit(i, 8, 9) ? 1 : 0;
        same += h == shared::hash_unit(i, 7, 10) ? 1 : 0;
    }
    EXPECT_LE(same, 2); // of 3000 pairs in 2^24 values
}

TEST(noise, repeats_after_its_period_and_not_before) {
    support::random_source random(1);
    for (const std::uint32_t period : {1u, 2u, 7u, 12u, 36u}) {
        int different = 0;
        for (int i = 0; i < 2000; ++i) {
            // Multiples of 1/64, so that x + period is the same place exactly.
            const auto x = static_cast<float>(random.below(64 * period)) / 64;
            const auto y = static_cast<float>(random.between(-50, 50));
            const auto z = static_cast<float>(random.between(-50, 50));
            const float here = shared::value_noise(x, y, z, period);
            ASSERT_GE(here, 0);
            ASSERT_LE(here, 1);
            ASSERT_EQ(shared::value_noise(x + static_cast<float>(period), y, z, period), here);
            different += shared::value_noise(x + 1, y, z, period) != here ? 1 : 0;
        }
        EXPECT_EQ(different > 1900, period > 1) << period;
    }
}

TEST(noise, lattice_points_have_the_hash) {
    for (std::uint32_t x = 0; x < 5; ++x) {
        const auto fx = static_cast<float>(x);
        EXPECT_EQ(shared::value_noise(fx, 2, 3, 1u << 20),
                  shared::hash_unit(x, 1048576 + 2, 1048576 + 3));
    }
}

// 3t² − 2t³ is level at the lattice and rises by at most 3/2 a cell, of values at most 1 apart.
TEST(noise, is_smooth) {
    support::random_source random(2);
    constexpr float step = 1.0f / 256;
    for (int i = 0; i < 20'000; ++i) {
        const auto x = static_cast<float>(random.between(0, 12));
        const auto y = static_cast<float>(random.between(-9, 9));
        const auto z = static_cast<float>(random.between(-9, 9));
        const float here = shared::value_noise(x, y, z, 12);
        for (int axis = 0; axis < 3; ++axis) {
            const float there =
                shared::value_noise(x + (axis == 0 ? step : 0), y + (axis == 1 ? step : 0),
                                    z + (axis == 2 ? step : 0), 12);
            ASSERT_LE(std::abs(there - here), 1.5f * step + 1e-6f);
        }
    }
}
