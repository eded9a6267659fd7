// Phase functions against quadrature over the sphere, published figures and their limits; what a
// kernel evaluates in float against what the host evaluates in double.

#include <skybark/clouds/phase.hpp>
#include <skybark/shared/phase.hpp>

#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

using namespace skybark;
using clouds::phase_function;

namespace {

constexpr double pi = 3.141592653589793;

/// 2π ∫ f(u) du over −1…1, in intervals that halve towards both ends, where lobes are: Boole's rule
/// on 16 parts of each. Down to 1e-13 of the ends, where the sharpest lobe (1 − g = 2e-3) has long
/// levelled off.
template <class F>
double over_sphere(F&& f) {
    const auto boole = [&](double a, double b) {
        constexpr int parts = 16;
        const double h = (b - a) / (4 * parts);
        double sum = 0;
        for (int i = 0; i < parts; ++i) {
            const double x = a + 4 * h * i;
            sum += 7 * (f(x) + f(x + 4 * h)) + 32 * (f(x + h) + f(x + 3 * h)) + 12 * f(x + 2 * h);
        }
        return sum * 2 * h / 45;
    };
    double sum = 0;
    double width = 1;
    for (int k = 0; k < 43; ++k, width /= 2) {
        sum += boole(1 - width, 1 - width / 2) + boole(-1 + width / 2, -1 + width);
    }
    return 2 * pi * (sum + boole(1 - width, 1) + boole(-1, -1 + width));
}

struct named {
    std::string name;
    phase_function of;
};

std::vector<named> all() {
    std::vector<named> out{
        {"isotropic", phase_function::isotropic()},
        {"Rayleigh", phase_function::draine(0, 1)},
        {"mixture", phase_function::mixture(-0.3, 0.7, 2, 0.4)},
    };
    for (const double g : {-0.9, -0.5, 0.1, 0.5, 0.75, 0.85, 0.95, 0.99}) {
        out.push_back(
            {std::string("HG ") + std::to_string(g), phase_function::henyey_greenstein(g)});
        out.push_back(
            {std::string("Draine ") + std::to_string(g), phase_function::draine(g, 10 * (1 - g))});
    }
    for (const double d : {5.0, 7.0, 10.0, 20.0, 35.0, 50.0}) {
        out.push_back({std::string("Mie ") + std::to_string(d), *phase_function::mie(d)});
    }
    return out;
}

} // namespace

TEST(phase, integrates_to_one_over_the_sphere) {
    for (const named& one : all()) {
        const phase_function& phase = one.of;
        EXPECT_NEAR(over_sphere([&](double u) { return phase(u); }), 1, 1e-9) << one.name;
    }
}

TEST(phase, mean_cosine_and_second_moment_are_those_of_its_values) {
    for (const named& one : all()) {
        const phase_function& phase = one.of;
        EXPECT_NEAR(over_sphere([&](double u) { return u * phase(u); }), phase.mean_cosine(), 1e-9)
            << one.name;
        EXPECT_NEAR(over_sphere([&](double u) { return (1.5 * u * u - 0.5) * phase(u); }),
                    phase.second_moment(), 1e-9)
            << one.name;
    }
}

TEST(phase, isotropic_is_one_over_four_pi) {
    const auto phase = phase_function::isotropic();
    for (const double u : {-1.0, -0.3, 0.0, 0.8, 1.0}) {
        EXPECT_NEAR(phase(u), 1 / (4 * pi), 1e-16);
    }
    EXPECT_EQ(phase.mean_cosine(), 0);
    EXPECT_EQ(phase.forward_energy(), 0);
}

// P(0) of a sharp lobe exceeds 1, which is why the energy of the lobe, g², stands in its place.
TEST(phase, henyey_greenstein_has_its_published_moments_and_forward_value) {
    const auto phase = phase_function::henyey_greenstein(0.85);
    EXPECT_DOUBLE_EQ(phase.mean_cosine(), 0.85);
    EXPECT_DOUBLE_EQ(phase.forward_energy(), 0.85 * 0.85);
    EXPECT_NEAR(phase.forward_value(), (1 + 0.85) / (4 * pi * 0.15 * 0.15), 1e-12);
    EXPECT_NEAR(phase.forward_value(), 6.543, 5e-4);
}

// Rayleigh's phase function: 3/16π (1 + u²).
TEST(phase, draine_without_g_is_rayleigh) {
    const auto phase = phase_function::draine(0, 1);
    for (const double u : {-1.0, -0.3, 0.0, 0.8, 1.0}) {
        EXPECT_NEAR(phase(u), 3 / (16 * pi) * (1 + u * u), 1e-16);
    }
}

// Jendersie and d'Eon: the mean cosine of droplets of 10 µm is 0.864 (to the last figure given).
TEST(phase, droplets_of_ten_micrometres_have_the_published_mean_cosine) {
    EXPECT_NEAR(phase_function::mie(10)->mean_cosine(), 0.864, 5e-4);
}

// Equations 4 to 7 of the same, worked out for diameters all over the fit.
TEST(phase, droplets_have_the_published_fits_parameters) {
    const double published[][5] = {{5, 0.9706780, 0.5083416, 17.0680985, 0.4478295},
                                   {7, 0.9815816, 0.5319526, 19.3550927, 0.4676163},
                                   {20, 0.9946100, 0.5937906, 27.1136937, 0.4981595},
                                   {50, 0.9979524, 0.6250845, 32.3154278, 0.5076183}};
    for (const auto& row : published) {
        const auto phase = phase_function::mie(row[0]);
        ASSERT_TRUE(phase);
        EXPECT_NEAR(phase->g_henyey_greenstein(), row[1], 1e-7) << row[0];
        EXPECT_NEAR(phase->g_draine(), row[2], 1e-7) << row[0];
        EXPECT_NEAR(phase->alpha(), row[3], 1e-7) << row[0];
        EXPECT_NEAR(phase->weight(), row[4], 1e-7) << row[0];
    }
}

TEST(phase, forward_energy_leaves_nothing_that_scatters_backwards) {
    for (const auto& [name, phase] : all()) {
        const double f = phase.forward_energy();
        EXPECT_GE(f, 0) << name;
        EXPECT_LT(f, 1) << name;
        EXPECT_LE(f, std::max(phase.mean_cosine(), 0.0)) << name;
        if (phase.mean_cosine() > 0.5) { // a lobe: no limit but the second moment
            EXPECT_EQ(f, phase.second_moment()) << name;
        }
    }
    EXPECT_EQ(phase_function::henyey_greenstein(-0.85).forward_energy(), 0);
    EXPECT_EQ(phase_function::draine(0, 1).forward_energy(), 0);
}

TEST(phase, droplets_outside_of_the_fit_are_refused) {
    for (const double d : {4.99, 50.01, 0.0, -10.0, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity()}) {
        const auto phase = phase_function::mie(d);
        ASSERT_FALSE(phase) << d;
        EXPECT_EQ(phase.error().code, error_code::bad_input);
        EXPECT_NE(phase.error().message.find("5 to 50"), std::string::npos);
    }
}

// In float against double at the same cosine and the same parameters, once rounded. 1 − g and 1 − u
// are exact from ½ up and s is a sum of positives there (g > 0), so what is left is about ten
// roundings (6e-8 each), the 3/2 power of s's counting more; for g < 0 s is a difference whose
// terms are at most (1 + |g|)² / (1 − |g|)² ≤ 361 times itself.
TEST(phase, a_kernel_evaluates_the_same_values) {
    for (const auto& [name, phase] : all()) {
        const glm::vec4 p = phase.parameters();
        const auto rounded =
            phase_function::mixture(double{p.x}, double{p.y}, double{p.z}, double{p.w});
        const double tolerance = p.x < 0 || p.y < 0 ? 1e-6 * 361 / 4 : 1e-6;
        for (int i = -256; i <= 256; ++i) {
            const float near_one = static_cast<float>(1 - std::exp2(-std::abs(i) / 11.0));
            const float u = i < 0 ? -near_one : near_one;
            const double expected = rounded(double{u});
            EXPECT_NEAR(shared::phase_value(p, u) / expected, 1, tolerance) << name << " at " << u;
        }
    }
}

TEST(phase, widening_takes_both_lobes_towards_isotropic) {
    const auto phase = *phase_function::mie(20);
    const glm::vec4 half = shared::phase_widened(phase.parameters(), 0.5f);
    EXPECT_FLOAT_EQ(half.x, static_cast<float>(phase.g_henyey_greenstein() / 2));
    EXPECT_FLOAT_EQ(half.y, static_cast<float>(phase.g_draine() / 2));
    EXPECT_EQ(shared::phase_widened(phase.parameters(), 1), phase.parameters());
}
