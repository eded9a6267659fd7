// The light of the clouds' pictures against published figures.

#include <picture/daylight.hpp>

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

using namespace skybark;
using glm::dvec3;
using glm::vec3;

namespace {

constexpr double pi = std::numbers::pi;

double luminance(dvec3 rgb) { return 0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z; }

/// The mean of f(direction) · weight over the upper half of all directions, by solid angle.
template <class F>
dvec3 over_the_sky(F&& f) {
    dvec3 sum(0);
    for (int row = 0; row < 200; ++row) {
        for (int column = 0; column < 400; ++column) {
            const double y = (row + 0.5) / 200;
            const double phi = 2 * pi * (column + 0.5) / 400;
            const double flat = std::sqrt(1 - y * y);
            sum += f(dvec3(flat * std::cos(phi), y, flat * std::sin(phi))) / 80000.0;
        }
    }
    return sum;
}

dvec3 level_light(const shared::daylight_sky& sky) { // over pi
    return over_the_sky(
        [&](dvec3 to) { return dvec3(shared::sky_radiance(sky, vec3(to))) * (2 * to.y); });
}

/// Direct sunlight over that above the air. Green at 42° (1.5 air masses), at sea level: Rayleigh's
/// depth 0.097 at 550 nm (Bodhaine et al. 1999) and 0.14 of a turbidity of 2.4 make e^-0.36 = 0.70.
/// At 4° (12 air masses) from 1,300 m, above two thirds of the haze: published figures are about
/// 0.45, 0.25 and 0.07 in the clearest air, of which haze leaves less.
TEST(clear_day, sunlight_is_yellow_by_day_and_orange_at_sunset) {
    const auto sun = [](double elevation, double altitude) {
        return dvec3(vec3(picture::daylight(picture::direction_to_sun(0, elevation), 2.4, altitude)
                              .sunlight)) *
               (pi / 128);
    };
    const dvec3 day = sun(42, 0);
    EXPECT_NEAR(day.y, 0.70, 0.03);
    EXPECT_GT(day.x, day.y);
    EXPECT_GT(day.y, day.z);
    const dvec3 low = sun(4, 0);
    const dvec3 high = sun(4, 1300);
    EXPECT_LT(low.y, 0.1);
    EXPECT_NEAR(high.y, 0.2, 0.06);
    EXPECT_NEAR(high.x / high.y, 1.9, 0.3);
    EXPECT_GT(high.y / high.z, 4);
    EXPECT_GT(low.x / low.y, high.x / high.y);
    // Above nearly all air it is white.
    const dvec3 space = sun(4, 1e5);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(space[c], 1, 1e-3);
    }
}

TEST(clear_day, a_level_surface_gets_what_is_measured) {
    for (const double elevation : {4.0, 20.0, 50.0, 85.0}) {
        auto sky = picture::daylight(picture::direction_to_sun(130, elevation), 2.4);
        picture::set_clear_day(sky);
        const double klx = 0.8 + 15.5 * std::sqrt(std::sin(elevation * pi / 180));
        // What is out of sRGB's gamut is cut off, which adds light.
        EXPECT_NEAR(luminance(level_light(sky)) * pi, klx, 0.02 * klx) << elevation;
    }
}

/// The standard clear sky's table value, ISO 15469 type 12: the horizon opposite a sun at 45° over
/// the zenith, (1 - e^-0.32·∞ → 1) f(135°) / ((1 - e^-0.32) f(45°)).
TEST(clear_day, the_sky_is_as_bright_as_the_standard_says) {
    auto sky = picture::daylight(picture::direction_to_sun(0, 45), 2.4);
    picture::set_clear_day(sky);
    const auto indicatrix = [](double chi) {
        return 1 + 10 * (std::exp(-3 * chi) - std::exp(-1.5 * pi)) +
               0.45 * std::cos(chi) * std::cos(chi);
    };
    const auto seen = [&](dvec3 to) {
        return luminance(dvec3(shared::sky_radiance(sky, vec3(to))));
    };
    const double up = 0.05;
    const dvec3 opposite(0, up, std::sqrt(1 - up * up)); // the sun is north
    const double away = std::acos((up - opposite.z) / std::sqrt(2.0));
    const double expected = (1 - std::exp(-0.32 / up)) * indicatrix(away) /
                            ((1 - std::exp(-0.32)) * indicatrix(pi / 4));
    EXPECT_NEAR(seen(opposite) / seen({0, 1, 0}), expected, 0.01 * expected);
}

/// Chromaticities on the daylight locus within 0.01, at the horizon by day near 8,500 K.
TEST(clear_day, its_colours_are_those_of_daylight) {
    for (const double elevation : {6.0, 30.0, 60.0}) {
        auto sky = picture::daylight(picture::direction_to_sun(180, elevation), 2.4);
        picture::set_clear_day(sky);
        for (const dvec3& to : {dvec3(0, 1, 0), dvec3(0, 0.1, -0.995), dvec3(0.995, 0.1, 0),
                                dvec3(0.6, 0.8, 0), dvec3(0, 0.5, -0.866)}) {
            const dvec3 c(shared::sky_radiance(sky, vec3(to)));
            // Linear sRGB to XYZ, IEC 61966-2-1.
            const double X = 0.4124 * c.x + 0.3576 * c.y + 0.1805 * c.z;
            const double Y = 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
            const double Z = 0.0193 * c.x + 0.1192 * c.y + 0.9505 * c.z;
            const double x = X / (X + Y + Z);
            const double y = Y / (X + Y + Z);
            EXPECT_NEAR(y, (2.87 - 3 * x) * x - 0.275, 0.01) << elevation << ": " << x;
            if (elevation > 20 && to.y < 0.2) {
                EXPECT_NEAR(x, 0.291, 0.02); // 6° up it is bluer already
            }
        }
    }
}

TEST(clear_day, level_surfaces_get_their_light_exactly) {
    kernels::scene_record scene{};
    scene.sky = picture::daylight(picture::direction_to_sun(90, 5), 2.4);
    picture::set_clear_day(scene.sky);
    const dvec3 sky = level_light(scene.sky);
    const dvec3 mean =
        over_the_sky([&](dvec3 to) { return dvec3(shared::sky_radiance(scene.sky, vec3(to))); });
    const vec3 albedo(0.1f, 0.2f, 0.3f);
    picture::set_level_ambient(scene, {albedo, 0.5f, 0.25f});
    const vec3 above = kernels::ambient_of(scene, {0, 1, 0});
    const vec3 below = kernels::ambient_of(scene, {0, -1, 0});
    for (int c = 0; c < 3; ++c) {
        const double sun = double{scene.sky.sunlight[c]} * std::sin(5 * pi / 180);
        const double land = 0.75 * double{albedo[c]} * (sky[c] + 0.5 * sun) + 0.25 * mean[c];
        // The one integral has 2,048 pieces, the other 80,000.
        EXPECT_NEAR(double{above[c]}, sky[c], 0.01 * sky[c]);
        EXPECT_NEAR(double{below[c]}, land, 0.01 * land);
    }
}

} // namespace
