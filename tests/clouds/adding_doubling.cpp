// The oracle of slabs (support/adding_doubling.hpp) against published values and exact relations.

#include "support/adding_doubling.hpp"

#include <gtest/gtest.h>

using namespace skybark;
using support::adding_doubling;

// Van de Hulst, Multiple Light Scattering (1980), as Wang, Jacques and Zheng 1995 (MCML, table 1)
// quote it: depth 2, g 0.75, albedo 0.9, straight down. All five figures.
TEST(adding_doubling, is_van_de_hulsts_table) {
    const auto slab = adding_doubling(2, 0.75, 0.9);
    EXPECT_NEAR(slab.transmission, 0.66096, 5e-6);
    EXPECT_NEAR(slab.reflection, 0.09739, 5e-6);
    EXPECT_NEAR(slab.direct, std::exp(-2.0), 1e-15);
}

// Isotropic and conservative, thick: T = 4/3 K(1) / (τ + 2 q), K(1) = √3/4 H(1), but for terms
// like e^{−τ}; H(1) = 2.90781 (Chandrasekhar 1950), Hopf's q = 0.710446.
TEST(adding_doubling, becomes_the_exact_asymptote_of_thick_clouds) {
    for (const double depth : {16.0, 24.0, 64.0}) {
        const double asymptote =
            4.0 / 3 * std::sqrt(3.0) / 4 * 2.9078105 / (depth + 2 * 0.71044609);
        EXPECT_NEAR(adding_doubling(depth, 0, 1).transmission / asymptote, 1, 1e-6) << depth;
    }
}

// A half space reflects 1 − √(1 − a) H(μ), with H of Chandrasekhar's integral equation
// 1 / H(μ) = √(1 − a) + a/2 ∫ x H(x) / (μ + x) dx, solved here by repetition.
TEST(adding_doubling, reflects_like_chandrasekhars_half_space) {
    const double albedo = 0.9;
    const support::half_range_gauss gauss(64);
    std::vector<double> h(64, 1);
    const auto next = [&](double mu) {
        double sum = std::sqrt(1 - albedo);
        for (std::size_t j = 0; j < 64; ++j) {
            sum += albedo / 2 * gauss.weight[j] * gauss.node[j] * h[j] / (mu + gauss.node[j]);
        }
        return 1 / sum;
    };
    for (int turn = 0; turn < 200; ++turn) {
        std::vector<double> better(64);
        for (std::size_t i = 0; i < 64; ++i) {
            better[i] = next(gauss.node[i]);
        }
        h = better;
    }
    for (const double mu : {0.1, 0.5, 1.0}) {
        EXPECT_NEAR(adding_doubling(64, 0, albedo, mu).reflection,
                    1 - std::sqrt(1 - albedo) * next(mu), 1e-7)
            << mu;
    }
}

TEST(adding_doubling, loses_nothing_without_absorption) {
    for (const double g : {-0.5, 0.0, 0.75, 0.85, 0.95}) {
        for (const double depth : {0.01, 1.0, 8.0, 64.0}) {
            const auto slab = adding_doubling(depth, g, 1);
            EXPECT_NEAR(slab.transmission + slab.reflection, 1, 1e-7) << g << " " << depth;
        }
    }
}

TEST(adding_doubling, more_streams_change_nothing) {
    for (const double depth : {0.5, 8.0, 64.0}) {
        const auto some = adding_doubling(depth, 0.85, 0.999);
        const auto more = adding_doubling(depth, 0.85, 0.999, 1, 48);
        EXPECT_NEAR(some.transmission, more.transmission, 1e-6) << depth;
        EXPECT_NEAR(some.reflection, more.reflection, 1e-6) << depth;
    }
}

// What is absorbed is (1 − a) times the fluence along the way, by Gauss in τ.
TEST(adding_doubling, absorbs_what_its_fluence_says) {
    const double albedo = 0.8;
    const double depth = 3;
    const support::slab_solver slab(support::henyey_greenstein_moments(0.6, 49), albedo);
    const support::half_range_gauss gauss(12);
    double absorbed = 0;
    for (std::size_t i = 0; i < 12; ++i) {
        absorbed +=
            (1 - albedo) * depth * gauss.weight[i] * slab.fluence(depth, depth * gauss.node[i]);
    }
    const auto fluxes = slab.fluxes(depth);
    // Gauss meets the kink of the fluence at the two faces (like τ ln τ) to about 1e-4.
    EXPECT_NEAR(fluxes.transmission + fluxes.reflection + absorbed, 1, 1e-4);
}
