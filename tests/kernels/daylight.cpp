// The sky against the published model in double precision, and the helpers that shade it.

#include <skybark/shared/daylight.hpp>
#include <skybark/shared/shading.hpp>

#include "support/random.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;
using glm::vec3;
using glm::vec4;

namespace {

/// Preetham, Shirley and Smits 1999, appendix A.2: Perez' coefficients at turbidity T.
struct coefficients {
    double a, b, c, d, e;

    [[nodiscard]] double operator()(double cos_zenith, double gamma) const {
        return (1 + a * std::exp(b / cos_zenith)) *
               (1 + c * std::exp(d * gamma) + e * std::cos(gamma) * std::cos(gamma));
    }
};
coefficients luminance_at(double t) {
    return {0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
            -0.0670 * t + 0.3703};
}
coefficients x_at(double t) {
    return {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
            -0.0033 * t + 0.0452};
}
coefficients y_at(double t) {
    return {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
            -0.0109 * t + 0.0529};
}

struct model {
    coefficients luminance, x, y;
    dvec3 zenith; ///< over Perez' function there
    dvec3 to_sun;

    /// Colour of the sky at `to`, xyY.
    [[nodiscard]] dvec3 at(const dvec3& to) const {
        const double gamma = std::acos(std::clamp(glm::dot(to, to_sun), -1.0, 1.0));
        return {zenith.y * x(to.y, gamma), zenith.z * y(to.y, gamma),
                zenith.x * luminance(to.y, gamma)};
    }
};

model clear_day(double turbidity, double sun_zenith) {
    model m{luminance_at(turbidity), x_at(turbidity), y_at(turbidity), {}, {}};
    m.to_sun = {std::sin(sun_zenith), std::cos(sun_zenith), 0};
    m.zenith = {10 / m.luminance(1, sun_zenith), 0.25 / m.x(1, sun_zenith),
                0.26 / m.y(1, sun_zenith)};
    return m;
}

shared::daylight_sky as_record(const model& m) {
    shared::daylight_sky sky{};
    const auto put = [](double luminance, double x, double y) {
        return vec4(glm::dvec4(luminance, x, y, 0));
    };
    sky.a = put(m.luminance.a, m.x.a, m.y.a);
    sky.b = put(m.luminance.b, m.x.b, m.y.b);
    sky.c = put(m.luminance.c, m.x.c, m.y.c);
    sky.d = put(m.luminance.d, m.x.d, m.y.d);
    sky.e = put(m.luminance.e, m.x.e, m.y.e);
    sky.zenith = vec4(glm::dvec4(m.zenith, 0));
    sky.to_sun = vec4(glm::dvec4(m.to_sun, 0));
    return sky;
}

/// IEC 61966-2-1, primaries and D65 white.
dvec3 srgb(const dvec3& xyY) {
    const double X = xyY.z * xyY.x / xyY.y;
    const double Z = xyY.z * (1 - xyY.x - xyY.y) / xyY.y;
    return {3.2406 * X - 1.5372 * xyY.z - 0.4986 * Z, -0.9689 * X + 1.8758 * xyY.z + 0.0415 * Z,
            0.0557 * X - 0.2040 * xyY.z + 1.0570 * Z};
}

} // namespace

TEST(daylight, exponential) {
    for (int i = -30'000; i <= 10'000; ++i) {
        const auto x = static_cast<float>(i / 1000.0);
        const double exact = std::exp(double{x});
        // The series' next term and a rounding or two, 64-fold by squaring.
        const double series = std::pow(x / 64.0, 6) / 720 / std::exp(x / 64.0);
        ASSERT_NEAR(double{shared::exp_shared(x)}, exact, exact * 64 * (series + 2 * 5.97e-8)) << x;
    }
}

TEST(daylight, arc_cosine) {
    for (int i = -100'000; i <= 100'000; ++i) {
        const auto x = static_cast<float>(i / 1e5);
        ASSERT_NEAR(double{shared::arccos_shared(x)}, std::acos(double{x}), 5e-7) << x;
    }
    EXPECT_EQ(shared::arccos_shared(1.0000001f), 0);
    EXPECT_NEAR(shared::arccos_shared(-1.0000001f), 3.14159265f, 1e-6f);
}

// The coefficients of turbidity 2 and 6 and several suns, over the whole dome.
TEST(daylight, sky_is_the_published_model) {
    support::random_source random(1);
    for (const double turbidity : {2.0, 2.5, 6.0}) {
        for (const double sun_zenith : {0.0, 0.5, 1.0, 1.4}) {
            const model m = clear_day(turbidity, sun_zenith);
            const shared::daylight_sky sky = as_record(m);
            for (int i = 0; i < 500; ++i) {
                dvec3 to = random.direction();
                to.y = std::abs(to.y);
                if (to.y < 0.02) {
                    continue; // held at the horizon
                }
                const dvec3 expected = glm::max(srgb(m.at(to)), 0.0);
                const dvec3 actual(shared::sky_radiance(sky, vec3(to)));
                // Three exponentials of 1.5e-5 each, times the matrix, which triples it.
                const double brightest = std::max({expected.x, expected.y, expected.z});
                ASSERT_LE(glm::length(actual - expected), 2e-4 * brightest)
                    << turbidity << ' ' << sun_zenith << ' ' << to.y;
            }
        }
    }
}

TEST(daylight, below_the_horizon_is_the_horizon) {
    const shared::daylight_sky sky = as_record(clear_day(2.2, 0.9));
    const vec3 level(shared::sky_radiance(sky, {0.6f, 0.0f, 0.8f}));
    const vec3 below(shared::sky_radiance(sky, {0.06f, -0.99498744f, 0.08f}));
    EXPECT_LE(glm::length(below - level), 1e-4f * glm::length(level));
    for (const vec3& to : {vec3(0, 1, 0), vec3(0, -1, 0)}) {
        const vec3 seen = shared::sky_radiance(sky, to);
        EXPECT_TRUE(std::isfinite(seen.x) && std::isfinite(seen.y) && std::isfinite(seen.z));
    }
}

TEST(daylight, white_is_white) {
    // D65 in xyY; the matrix has four digits.
    const vec3 white = shared::srgb_from_xyY(1, 0.3127f, 0.3290f);
    EXPECT_NEAR(white.x, 1, 2e-3f);
    EXPECT_NEAR(white.y, 1, 2e-3f);
    EXPECT_NEAR(white.z, 1, 2e-3f);
}

// Published pairs of the sRGB curve, and its ends.
TEST(shading, srgb_encoding) {
    EXPECT_EQ(shared::srgb_encode(0), 0);
    EXPECT_NEAR(shared::srgb_encode(1), 1, 1e-6f);
    EXPECT_NEAR(shared::srgb_encode(0.0031308f), 0.04045f, 1e-5f);
    EXPECT_NEAR(shared::srgb_encode(0.5f), 0.735357f, 1e-5f);
    EXPECT_NEAR(shared::srgb_encode(0.18f), 0.461356f, 1e-5f);
    EXPECT_NEAR(shared::srgb_encode(2), 1, 1e-6f);
    EXPECT_EQ(shared::srgb_encode(-1), 0);
}

TEST(shading, display_rises_from_black_to_white) {
    EXPECT_EQ(shared::display(0), 0);
    float before = 0;
    for (int i = 1; i <= 1000; ++i) {
        const float here = shared::display(static_cast<float>(i) / 100);
        ASSERT_GE(here, before);
        ASSERT_LE(here, 1);
        before = here;
    }
    EXPECT_GT(before, 0.99f);
    // Narkowicz' curve at 1: (2.51 + 0.03) / (2.43 + 0.59 + 0.14) = 0.8038, encoded.
    EXPECT_NEAR(shared::display(1), 1.055 * std::pow(2.54 / 3.16, 1 / 2.4) - 0.055, 1e-5);
}

TEST(shading, haze_hides_what_is_far) {
    EXPECT_EQ(shared::haze(0), 0);
    EXPECT_NEAR(shared::haze(2500), 1 - std::exp(-1.0), 1e-5);
    EXPECT_NEAR(shared::haze(1e9f), 1, 1e-5);
}

TEST(shading, bark_goes_round_without_a_seam) {
    support::random_source random(2);
    for (int i = 0; i < 2000; ++i) {
        const auto v = static_cast<float>(random.between(0, 30));
        const float h = shared::bark_height(static_cast<float>(random.between(0, 1)), v, 12);
        ASSERT_GE(h, 0);
        ASSERT_LE(h, 1);
        ASSERT_NEAR(shared::bark_height(0, v, 12), shared::bark_height(1, v, 12), 1e-4f);
    }
}
