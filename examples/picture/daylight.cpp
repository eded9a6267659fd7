#include <picture/daylight.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace skybark::picture {
namespace {

constexpr double pi = std::numbers::pi;

/// Preetham, Shirley and Smits 1999, appendix A.2: a quantity at the zenith, times what divides out
/// Perez' function there.
struct perez_term {
    double zenith;
    std::array<double, 5> c;

    /// zenith / F(0, theta_sun)
    [[nodiscard]] double scale(double theta) const {
        const double at_zenith =
            (1 + c[0] * std::exp(c[1])) *
            (1 + c[2] * std::exp(c[3] * theta) + c[4] * std::cos(theta) * std::cos(theta));
        return zenith / at_zenith;
    }
};

double chromaticity(double t, double theta, const double (&m)[3][4]) {
    const double powers[4] = {theta * theta * theta, theta * theta, theta, 1};
    const double turbidity[3] = {t * t, t, 1};
    double sum = 0;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) {
            sum += turbidity[row] * m[row][column] * powers[column];
        }
    }
    return sum;
}

std::array<perez_term, 3> perez_terms(double t, double theta) {
    const double chi = (4.0 / 9.0 - t / 120) * (pi - 2 * theta);
    const double luminance = (4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192;
    const double x = chromaticity(t, theta,
                                  {{0.00166, -0.00375, 0.00209, 0},
                                   {-0.02903, 0.06377, -0.03202, 0.00394},
                                   {0.11693, -0.21196, 0.06052, 0.25886}});
    const double y = chromaticity(t, theta,
                                  {{0.00275, -0.00610, 0.00317, 0},
                                   {-0.04214, 0.08970, -0.04153, 0.00516},
                                   {0.15346, -0.26756, 0.06670, 0.26688}});
    return {{{luminance,
              {0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
               -0.0670 * t + 0.3703}},
             {x,
              {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125,
               -0.0641 * t - 0.8989, -0.0033 * t + 0.0452}},
             {y,
              {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102,
               -0.0441 * t - 1.6537, -0.0109 * t + 0.0529}}}};
}

/// What is left of the sun's light at red, green and blue wavelengths (Preetham et al., appendix
/// A.1: Rayleigh scattering and Ångström's turbidity formula).
glm::dvec3 sun_transmittance(double t, double theta) {
    const double degrees = theta * 180 / pi;
    const double mass = 1 / (std::cos(theta) + 0.15 * std::pow(93.885 - degrees, -1.253));
    const double beta = 0.04608 * t - 0.04586;
    glm::dvec3 rest;
    const double micrometres[3] = {0.61, 0.55, 0.465};
    for (int i = 0; i < 3; ++i) {
        const double rayleigh = 0.008735 * std::pow(micrometres[i], -4.08);
        const double aerosol = beta * std::pow(micrometres[i], -1.3);
        rest[i] = std::exp(-(rayleigh + aerosol) * mass);
    }
    return rest;
}

} // namespace

glm::vec3 direction_to_sun(double azimuth, double elevation) {
    const double a = azimuth * pi / 180;
    const double e = elevation * pi / 180;
    return {std::sin(a) * std::cos(e), std::sin(e), -std::cos(a) * std::cos(e)};
}

shared::daylight_sky daylight(glm::vec3 to_sun, double turbidity) {
    const double theta = std::min(std::acos(std::clamp<double>(to_sun.y, -1, 1)), pi / 2 - 0.0175);
    const auto terms = perez_terms(turbidity, theta);
    shared::daylight_sky sky{};
    glm::vec4* coefficients[5] = {&sky.a, &sky.b, &sky.c, &sky.d, &sky.e};
    for (int term = 0; term < 3; ++term) {
        const auto& from = terms[static_cast<std::size_t>(term)];
        for (std::size_t i = 0; i < 5; ++i) {
            (*coefficients[i])[term] = static_cast<float>(from.c[i]);
        }
        sky.zenith[term] = static_cast<float>(from.scale(theta));
    }
    sky.to_sun = glm::vec4(to_sun, 0);
    // The solar illuminance constant, 128 klx, over pi.
    const glm::dvec3 sun = sun_transmittance(turbidity, theta) * (128.0 / pi);
    sky.sunlight = glm::vec4(glm::vec3(sun), 0);
    return sky;
}

void set_ambient(kernels::scene_record& scene, glm::vec3 ground_albedo) {
    glm::dvec3 mean(0);
    glm::dmat3 first(0); // column i: the integral of radiance times coordinate i
    glm::dvec3 on_ground(0);
    constexpr int rows = 32;
    constexpr int columns = 64;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const double y = (row + 0.5) / rows;
            const double phi = 2 * pi * (column + 0.5) / columns;
            const double flat = std::sqrt(1 - y * y);
            const glm::dvec3 to(flat * std::cos(phi), y, flat * std::sin(phi));
            const glm::dvec3 radiance(shared::sky_radiance(scene.sky, glm::vec3(to)));
            const double solid_angle = 2 * pi / (rows * columns);
            mean += radiance * solid_angle;
            for (int i = 0; i < 3; ++i) {
                first[i] += radiance * (to[i] * solid_angle);
            }
            on_ground += radiance * (y * solid_angle / pi);
        }
    }
    const double sun_up = std::max(0.0f, scene.sky.to_sun.y);
    const glm::dvec3 ground = glm::dvec3(ground_albedo) *
                              (on_ground + glm::dvec3(glm::vec3(scene.sky.sunlight)) * sun_up);
    mean += ground * (2 * pi);
    first[1] -= ground * pi;
    // The cosine's convolution: pi for l = 0 and 2 pi / 3 for l = 1 (Ramamoorthi and Hanrahan
    // 2001).
    scene.ambient[0] = glm::vec4(glm::vec3(mean / (4 * pi)), 0);
    for (int i = 0; i < 3; ++i) {
        scene.ambient[i + 1] = glm::vec4(glm::vec3(first[i] / (2 * pi)), 0);
    }
}

} // namespace skybark::picture
