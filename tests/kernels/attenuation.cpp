// The formulas of attenuation on the host: functions against the standard library's in double, to
// what their comments say; grids there and back; keys in the order of their numbers.

#include <skybark/shared/attenuation.hpp>
#include <skybark/shared/cloud_lighting.hpp>
#include <skybark/shared/order.hpp>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

using namespace skybark;

namespace {

cloud_particle particle(float radius, float depth, float albedo) {
    cloud_particle p;
    p.position = glm::vec3(1, 2, 3);
    p.radius = radius;
    p.optical_depth = depth;
    p.albedo = albedo;
    return p;
}

} // namespace

// 2e-7 of itself, and a rounding of the argument's halvings on top: 87 · 2^-24 · ½ at most.
TEST(attenuation_formulas, exponential_is_right_to_some_last_places) {
    for (int i = 0; i < 200'000; ++i) {
        const float x = static_cast<float>(i) * 0.000434f;
        const double exact = std::exp(-double{x});
        ASSERT_NEAR(double{shared::exp_minus(x)} / exact, 1, 3e-7) << x;
    }
    EXPECT_EQ(shared::exp_minus(0), 1);
    EXPECT_EQ(shared::exp_minus(87), 0);
    EXPECT_EQ(shared::exp_minus(1e30f), 0);
}

TEST(attenuation_formulas, one_less_an_exponential_is_exact_where_it_is_small) {
    for (float x = 1e-30f; x < 100; x *= 1.003f) {
        const double exact = -std::expm1(-double{x});
        ASSERT_NEAR(double{shared::one_minus_exp(x)} / exact, 1, 3e-7) << x;
    }
    EXPECT_EQ(shared::one_minus_exp(0), 0);
}

// Given twice: as it is, and less 1.
TEST(attenuation_formulas, logarithm_is_exact_where_the_sum_is_near_one) {
    for (double x = 1e-30; x < 1e30; x *= 1.01) {
        const double exact = std::log(x);
        ASSERT_NEAR(double{shared::log_of_sum(static_cast<float>(x), static_cast<float>(x - 1))},
                    exact, 3e-7 * std::max(std::abs(exact), 1.0))
            << x;
    }
    for (double less = 1e-12; less < 0.4; less *= 1.01) {
        for (const double sign : {-1.0, 1.0}) {
            const auto given = static_cast<float>(sign * less);
            const double exact = std::log1p(double{given});
            ASSERT_NEAR(double{shared::log_of_sum(1 + given, given)} / exact, 1, 1e-6) << given;
        }
    }
}

// Abramowitz and Stegun's 7.1.26 is good to 1.5e-7 for the error function, of which this is half;
// its five terms of up to 1.45 cancel, and their rounding makes it 3e-7 where u is just below 0.
TEST(attenuation_formulas, gaussians_tail_is_to_its_papers_error) {
    for (float u = -10; u < 10; u += 0.0007f) {
        ASSERT_NEAR(double{shared::gaussian_above(u)},
                    0.5 * std::erfc(double{u} / std::numbers::sqrt2), 3.5e-7)
            << u;
    }
}

TEST(attenuation_formulas, particles_take_out_what_each_kind_of_light_says) {
    for (const float tau : {1e-5f, 0.3f, 4.0f, 60.0f}) {
        for (const float albedo : {0.0f, 0.6f, 1.0f}) {
            for (const float forward : {0.0f, 0.25f, 6.5f}) {
                const cloud_particle p = particle(3, tau, albedo);
                const double here = double{tau} * std::exp(-2.0 * 4 / 9); // 2 sigmas in a radius
                const double on = double{albedo} * double{forward};
                const auto found = [&](std::uint32_t light) {
                    return double{shared::particle_attenuation(p, 4, 2, light, forward)};
                };
                EXPECT_NEAR(found(0) / here, 1, 1e-6);
                EXPECT_NEAR(found(1), here * (1 - on), 1e-6 * here * (1 + on));
                // -ln(e^-t + on t), in a form that keeps its digits where t is small.
                const double product = -std::log1p(std::expm1(-here) + on * here);
                EXPECT_NEAR(found(2), product, 2e-6 * (here + on * here))
                    << tau << ' ' << albedo << ' ' << forward;
                EXPECT_EQ(shared::particle_attenuation(p, 9, 2, 0, 0), 0); // at the radius
            }
        }
    }
}

// Rows by their definition, one after another; a millionth of a row around edges is left out.
TEST(attenuation_formulas, rows_are_those_whose_middles_lie_within) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> place(5, 25);
    std::uniform_real_distribution<float> size(0.1f, 6);
    for (int i = 0; i < 2000; ++i) {
        const float y = place(random);
        const float r = size(random);
        const int top = shared::top_row(y, r);
        const int bottom = shared::bottom_row(y, r);
        EXPECT_LT(float(top) + 0.5f, y + r + 1e-5f);
        EXPECT_GT(float(top + 1) + 0.5f, y + r - 1e-5f);
        EXPECT_LT(float(bottom) + 0.5f, y - r + 1e-5f);
        EXPECT_GT(float(bottom + 1) + 0.5f, y - r - 1e-5f);
        EXPECT_EQ(shared::part_above(0, top + 1, y, r, 3), 0);
        EXPECT_EQ(shared::part_above(0, top, y, r, 3), 1);
        EXPECT_EQ(shared::part_above(1, top + 1, y, r, 3), 0);
        EXPECT_EQ(shared::part_above(1, bottom, y, r, 3), 1);
        for (int row = bottom + 1; row <= top; ++row) {
            const double u = (row + 0.5 - double{y}) / double{r} * 3;
            EXPECT_NEAR(double{shared::part_above(1, row, y, r, 3)},
                        0.5 * std::erfc(u / std::numbers::sqrt2), 1e-5);
        }
    }
}

TEST(attenuation_formulas, quanta_are_the_nearest_whole_numbers) {
    EXPECT_EQ(shared::quanta(0.49f), 0);
    EXPECT_EQ(shared::quanta(0.51f), 1);
    EXPECT_EQ(shared::quanta(-0.49f), 0);
    EXPECT_EQ(shared::quanta(-0.51f), -1);
    EXPECT_EQ(shared::quanta(-7.2f), -7);
    EXPECT_EQ(shared::quanta(1e6f), 1'000'000);
}

TEST(attenuation_formulas, places_and_cells_are_each_others_inverse) {
    const glm::dvec3 y = glm::normalize(glm::dvec3(0.3, 0.8, -0.5));
    const glm::dvec3 x = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), y));
    const glm::dvec3 z = glm::cross(x, y);
    light_grid grid;
    grid.anchor = glm::vec4(100, 200, -300, 0);
    grid.row_x = glm::vec4(glm::vec3(x / 2.0), 3.5f);
    grid.row_y = glm::vec4(glm::vec3(y / 3.0), 2.5f);
    grid.row_z = glm::vec4(glm::vec3(z / 0.5), 3);
    grid.voxel = glm::vec4(2, 3, 0.5f, 0);
    // By their meaning: 3.5 voxels of 2 m along x from the anchor is where cells.x is 0.
    const glm::dvec3 low =
        glm::dvec3(100, 200, -300) - x * (3.5 * 2) - y * (2.5 * 3) - z * (3 * 0.5);
    std::mt19937 random(4);
    std::uniform_real_distribution<float> some(-5, 12);
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 cells(some(random), some(random), some(random));
        const glm::dvec3 place = low + x * (2.0 * double{cells.x}) + y * (3.0 * double{cells.y}) +
                                 z * (0.5 * double{cells.z});
        const glm::vec3 back = shared::cells_of(grid, glm::vec3(place));
        const glm::vec3 there = shared::place_of(grid, cells);
        for (int a = 0; a < 3; ++a) {
            // Floats of 300 m are 3e-5 apart, of which a cell of 0.5 m sees twice as much.
            EXPECT_NEAR(back[a], cells[a], 2e-4f);
            EXPECT_NEAR(double{there[a]}, place[a], 1e-4);
        }
    }
}

TEST(attenuation_formulas, keys_have_the_order_of_their_numbers) {
    std::vector<float> numbers{
        -std::numeric_limits<float>::infinity(), -1e30f, -1, -1e-40f, 0, 1e-40f, 0.5f, 1, 3e38f,
        std::numeric_limits<float>::infinity()};
    std::mt19937 random(5);
    std::normal_distribution<float> some;
    for (int i = 0; i < 500; ++i) {
        numbers.push_back(some(random));
    }
    std::sort(numbers.begin(), numbers.end());
    for (std::size_t i = 1; i < numbers.size(); ++i) {
        if (numbers[i - 1] == numbers[i]) {
            continue;
        }
        EXPECT_LT(shared::growing_key(numbers[i - 1]), shared::growing_key(numbers[i]));
        EXPECT_GT(shared::falling_key(numbers[i - 1]), shared::falling_key(numbers[i]));
        if (numbers[i - 1] >= 0) {
            EXPECT_GT(shared::farther_first(numbers[i - 1]), shared::farther_first(numbers[i]));
        }
    }
}
