#include <skybark/kernels/unit_polygon.hpp>

#include <gtest/gtest.h>

using namespace skybark;

TEST(unit_polygon, corners_go_once_around) {
    for (const std::uint32_t sides : {3u, 4u, 8u, 17u, 1024u}) {
        const auto corners = kernels::unit_polygon(sides);
        ASSERT_EQ(corners.size(), sides + 1);
        double area = 0;
        for (std::uint32_t i = 0; i < sides; ++i) {
            const glm::dvec4 a(corners[i]);
            const glm::dvec4 b(corners[i + 1]);
            EXPECT_NEAR(std::hypot(a.x, a.y), 1, 1e-7);
            EXPECT_EQ(corners[i].z, static_cast<float>(i) / static_cast<float>(sides));
            EXPECT_EQ(corners[i].w, 0);
            area += (a.x * b.y - a.y * b.x) / 2;
        }
        // Counter-clockwise, even: the largest polygon in the circle.
        EXPECT_NEAR(area, sides / 2.0 * std::sin(2 * 3.14159265358979323846 / sides), 1e-6);
        // The seam: one place, u 0 and 1.
        EXPECT_EQ(corners[sides].x, corners[0].x);
        EXPECT_EQ(corners[sides].y, corners[0].y);
        EXPECT_EQ(corners[0].z, 0);
        EXPECT_EQ(corners[sides].z, 1);
    }
}

TEST(unit_polygon, square_is_exact_to_a_rounding) {
    const auto square = kernels::unit_polygon(4);
    const float expected[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(square[i].x, expected[i][0], 1e-7f);
        EXPECT_NEAR(square[i].y, expected[i][1], 1e-7f);
    }
}
