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
    const double zenith = (4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192;
    const double x = chromaticity(t, theta,
                                  {{0.00166, -0.00375, 0.00209, 0},
                                   {-0.02903, 0.06377, -0.03202, 0.00394},
                                   {0.11693, -0.21196, 0.06052, 0.25886}});
    const double y = chromaticity(t, theta,
                                  {{0.00275, -0.00610, 0.00317, 0},
                                   {-0.04214, 0.08970, -0.04153, 0.00516},
                                   {0.15346, -0.26756, 0.06670, 0.26688}});
    return {{{zenith,
              {0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
               -0.0670 * t + 0.3703}},
             {x,
              {-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125,
               -0.0641 * t - 0.8989, -0.0033 * t + 0.0452}},
             {y,
              {-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102,
               -0.0441 * t - 1.6537, -0.0109 * t + 0.0529}}}};
}

glm::dvec3 srgb_of(glm::dvec3 xyz) {
    return {3.2406 * xyz.x - 1.5372 * xyz.y - 0.4986 * xyz.z,
            -0.9689 * xyz.x + 1.8758 * xyz.y + 0.0415 * xyz.z,
            0.0557 * xyz.x - 0.2040 * xyz.y + 1.0570 * xyz.z};
}

/// A piece of the colour matching functions: a Gaussian with two widths, in nm.
double lobe(double nm, double middle, double below, double above) {
    const double t = (nm - middle) / (nm < middle ? below : above);
    return std::exp(-0.5 * t * t);
}

/// The CIE 1931 observer, by Wyman, Sloan and Shirley, "Simple analytic approximations to the CIE
/// XYZ color matching functions", JCGT 2 (2), 2013.
glm::dvec3 observer(double nm) {
    return {1.056 * lobe(nm, 599.8, 37.9, 31.0) + 0.362 * lobe(nm, 442.0, 16.0, 26.7) -
                0.065 * lobe(nm, 501.1, 20.4, 26.2),
            0.821 * lobe(nm, 568.8, 46.9, 40.5) + 0.286 * lobe(nm, 530.9, 16.3, 31.1),
            1.217 * lobe(nm, 437.0, 11.8, 36.0) + 0.681 * lobe(nm, 459.0, 26.0, 13.8)};
}

/// What is left of the sun's light at an altitude in m, in red, green and blue of what it has above
/// the air (Preetham et al., appendix A.1: Rayleigh scattering and Ångström's turbidity formula,
/// over the spectrum of a black body of 5,778 K). Of the air and of the haze less and less is
/// above: scale heights of 8.4 and 1.25 km.
glm::dvec3 sun_transmittance(double t, double theta, double altitude) {
    const double degrees = theta * 180 / pi;
    const double mass = 1 / (std::cos(theta) + 0.15 * std::pow(93.885 - degrees, -1.253));
    const double air = 0.008735 * std::exp(-altitude / 8400);
    const double haze = (0.04608 * t - 0.04586) * std::exp(-altitude / 1250);
    glm::dvec3 all(0);
    glm::dvec3 rest(0);
    for (double nm = 380; nm <= 780; nm += 5) {
        const double um = nm / 1000;
        const double sun = std::pow(um, -5.0) / (std::exp(14.388 / (um * 5.778)) - 1);
        const glm::dvec3 seen = observer(nm) * sun;
        const double depth = mass * (air * std::pow(um, -4.08) + haze * std::pow(um, -1.3));
        all += seen;
        rest += seen * std::exp(-depth);
    }
    return glm::max(srgb_of(rest) / srgb_of(all), glm::dvec3(0));
}

/// Calls `visit(direction, solid angle)` for the upper half of all directions, piece by piece.
template <class Visit>
void over_the_sky(Visit&& visit) {
    constexpr int rows = 32;
    constexpr int columns = 64;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const double y = (row + 0.5) / rows;
            const double phi = 2 * pi * (column + 0.5) / columns;
            const double flat = std::sqrt(1 - y * y);
            visit(glm::dvec3(flat * std::cos(phi), y, flat * std::sin(phi)),
                  2 * pi / (rows * columns));
        }
    }
}

/// y of daylight with this x (CIE 15).
double daylight_locus(double x) { return (2.87 - 3 * x) * x - 0.275; }

/// Perez' formula for a term of the sky: 0 for Y, 1 for x, 2 for y.
double sky_term(const shared::daylight_sky& sky, int term, glm::dvec3 to) {
    const double cosine = glm::dot(to, glm::dvec3(glm::vec3(sky.to_sun)));
    const double gamma = std::acos(std::clamp(cosine, -1.0, 1.0));
    return double{sky.zenith[term]} *
           double{shared::perez(sky.a[term], sky.b[term], sky.c[term], sky.d[term], sky.e[term],
                                static_cast<float>(to.y), static_cast<float>(gamma))};
}

/// How bright each part of the sky is over the others: the CIE's standard clear sky (ISO
/// 15469:2004, type 12), whose indicatrix 1 + c (e^(d chi) - e^(d pi/2)) + e cos² chi is Perez'
/// with other numbers.
void set_clear_luminance(shared::daylight_sky& sky) {
    const double one = 1 - 10 * std::exp(-3 * pi / 2);
    sky.a.x = -1;
    sky.b.x = -0.32f;
    sky.c.x = static_cast<float>(10 / one);
    sky.d.x = -3;
    sky.e.x = static_cast<float>(0.45 / one);
    sky.zenith.x = 1;
}

/// The higher the sun, the nearer x at the horizon, away from it, to that of 8,500 K. At the zenith
/// it stays.
void set_blue_horizon(shared::daylight_sky& sky) {
    constexpr double clear = 0.291;
    const double aside = 1 + double{sky.c.y} * std::exp(double{sky.d.y} * pi / 2);
    const double bow = std::exp(double{sky.b.y});
    const double horizon = double{sky.zenith.y} * aside;
    const double zenith = horizon * (1 + double{sky.a.y} * bow);
    const double wanted =
        glm::mix(horizon, clear, std::clamp(3.0 * double{sky.to_sun.y}, 0.0, 1.0));
    sky.a.y = static_cast<float>((zenith / wanted - 1) / bow);
    sky.zenith.y = static_cast<float>(wanted / aside);
}

} // namespace

glm::vec3 direction_to_sun(double azimuth, double elevation) {
    const double a = azimuth * pi / 180;
    const double e = elevation * pi / 180;
    return {std::sin(a) * std::cos(e), std::sin(e), -std::cos(a) * std::cos(e)};
}

shared::daylight_sky daylight(glm::vec3 to_sun, double turbidity, double altitude) {
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
    const glm::dvec3 sun = sun_transmittance(turbidity, theta, altitude) * (128.0 / pi);
    sky.sunlight = glm::vec4(glm::vec3(sun), 0);
    return sky;
}

void set_clear_day(shared::daylight_sky& sky) {
    set_clear_luminance(sky);
    set_blue_horizon(sky);
    double level = 0; // kcd/m² of a white level surface
    double least = 1;
    double most = 0;
    over_the_sky([&](glm::dvec3 to, double solid_angle) {
        level += sky_term(sky, 0, to) * to.y * solid_angle / pi;
        const double x = sky_term(sky, 1, to);
        least = std::min(least, x);
        most = std::max(most, x);
    });
    const double klx = 0.8 + 15.5 * std::sqrt(std::max(0.0, double{sky.to_sun.y}));
    sky.zenith.x *= static_cast<float>(klx / pi / std::max(level, 1e-6));

    // y is very nearly a power of x between the least and the most; so is each factor of Perez'
    // product, which is set to that power where it is farthest from 1.
    const double power =
        std::log(daylight_locus(most) / daylight_locus(least)) / std::log(most / least);
    const auto part = [power](double greatest) {
        return static_cast<float>((std::pow(1 + greatest, power) - 1) / greatest);
    };
    const float with_height = part(double{sky.a.y} * std::exp(double{sky.b.y}));
    const float with_angle = part(double{sky.c.y} + double{sky.e.y});
    sky.a.z = with_height * sky.a.y;
    sky.b.z = sky.b.y;
    sky.c.z = with_angle * sky.c.y;
    sky.d.z = sky.d.y;
    sky.e.z = with_angle * sky.e.y;
    sky.zenith.z = 1;
    double ratio = 0;
    over_the_sky([&](glm::dvec3 to, double solid_angle) {
        ratio +=
            daylight_locus(sky_term(sky, 1, to)) / sky_term(sky, 2, to) * solid_angle / (2 * pi);
    });
    sky.zenith.z = static_cast<float>(ratio);
}

void set_ambient(kernels::scene_record& scene, glm::vec3 ground_albedo) {
    glm::dvec3 mean(0);
    glm::dmat3 first(0); // column i: the integral of radiance times coordinate i
    glm::dvec3 on_ground(0);
    over_the_sky([&](glm::dvec3 to, double solid_angle) {
        const glm::dvec3 radiance(shared::sky_radiance(scene.sky, glm::vec3(to)));
        mean += radiance * solid_angle;
        for (int i = 0; i < 3; ++i) {
            first[i] += radiance * (to[i] * solid_angle);
        }
        on_ground += radiance * (to.y * solid_angle / pi);
    });
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

void set_level_ambient(kernels::scene_record& scene, const land_below& land) {
    glm::dvec3 above(0);
    glm::dvec3 mean(0);
    over_the_sky([&](glm::dvec3 to, double solid_angle) {
        const glm::dvec3 radiance(shared::sky_radiance(scene.sky, glm::vec3(to)));
        above += radiance * (to.y * solid_angle / pi);
        mean += radiance * (solid_angle / (2 * pi));
    });
    const double sun_up = std::max(0.0f, scene.sky.to_sun.y) * land.sunlit;
    const glm::dvec3 sun(glm::vec3(scene.sky.sunlight));
    const glm::dvec3 below =
        glm::mix(glm::dvec3(land.albedo) * (above + sun * sun_up), mean, double{land.veil});
    scene.ambient[0] = glm::vec4(glm::vec3(0.5 * (above + below)), 0);
    scene.ambient[1] = glm::vec4(0);
    scene.ambient[2] = glm::vec4(glm::vec3(0.5 * (above - below)), 0);
    scene.ambient[3] = glm::vec4(0);
}

} // namespace skybark::picture
