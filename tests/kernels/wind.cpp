// The wind's formulas and kernels against the standard library and sums in double.

#include "support/random.hpp"

#include <skybark/kernels/grid_wind.hpp>
#include <skybark/kernels/wave_wind.hpp>
#include <skybark/kernels/wind_load.hpp>

#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>
#include <vector>

using namespace skybark;
using glm::dvec3;

namespace {

constexpr double two_pi = 6.283185307179586;

glm::vec3 random_vec3(support::random_source& random, double most) {
    return {random.between(-most, most), random.between(-most, most), random.between(-most, most)};
}

/// A field that is linear in place, with the same gradient in every test.
dvec3 linear_field(const dvec3& p) {
    return {3 + 0.5 * p.x - 0.25 * p.y + 0.125 * p.z, -1 + 0.75 * p.x + 2 * p.y - p.z,
            0.5 - 1.5 * p.x + 0.1 * p.y + 0.3 * p.z};
}

struct grid {
    kernels::grid_wind kernel;
    std::vector<glm::vec4> nodes;
    glm::vec3 low{0};
    glm::vec3 high{0};
};

grid linear_grid(glm::vec3 origin, glm::vec3 spacing, glm::uvec3 n) {
    grid g;
    g.kernel = {glm::vec4(origin, 0), glm::vec4(1.0f / spacing, 0), n.x, n.y, n.z};
    for (std::uint32_t k = 0; k < n.z; ++k) {
        for (std::uint32_t j = 0; j < n.y; ++j) {
            for (std::uint32_t i = 0; i < n.x; ++i) {
                const dvec3 p = dvec3(origin) + dvec3(spacing) * dvec3(i, j, k);
                g.nodes.emplace_back(glm::vec3(linear_field(p)), 0);
            }
        }
    }
    g.low = origin;
    g.high = origin + spacing * glm::vec3(n - 1u);
    return g;
}

glm::vec4 air_at(const grid& g, const glm::vec3& place) {
    const std::vector<glm::vec4> places{glm::vec4(place, 1)};
    std::vector<glm::vec4> air(1);
    g.kernel.map(0, places, g.nodes, air);
    return air[0];
}

/// The load on one segment, in double: cylinder across, leaves along (no formula of the library's).
struct load {
    dvec3 force{0};
    double drag = 0;
};
load load_of(const dvec3& axis, double wood_area, double leaf_area, const dvec3& u, double rho,
             double c_wood, double c_leaf, double vogel, double reference) {
    const double speed = glm::length(u);
    const dvec3 across = u - axis * glm::dot(axis, u);
    const double yielding = speed > reference ? std::pow(speed / reference, vogel) : 1;
    const dvec3 wood = 0.5 * rho * c_wood * wood_area * glm::length(across) * across;
    const dvec3 leaf = 0.5 * rho * c_leaf * leaf_area * speed * yielding * u;
    // Each force is C · speed^p along itself, so its derivative is p · |F| / speed.
    const double wood_rate =
        glm::length(across) > 0 ? 2 * glm::length(wood) / glm::length(across) : 0;
    const double leaf_rate =
        speed > 0 ? (speed > reference ? 2 + vogel : 2) * glm::length(leaf) / speed : 0;
    return {wood + leaf, wood_rate + leaf_rate};
}

} // namespace

TEST(wind, cosine_is_the_cosine) {
    // The polynomial is off by 7e-9 and its argument exact; 1 - 2 h² rounds h (3 ulp of a number
    // up to 1, so 4 · 1.8e-7) and itself (6e-8).
    for (int i = -400'000; i <= 400'000; ++i) {
        const float p = static_cast<float>(i) * 1.7e-5f;
        ASSERT_NEAR(shared::wave_cosine(glm::vec4(p)).x, std::cos(two_pi * double{p}), 1e-6) << p;
    }
    support::random_source random(1);
    for (int i = 0; i < 10'000; ++i) {
        const auto p = static_cast<float>(random.between(-1e5, 1e5));
        ASSERT_NEAR(shared::wave_cosine(glm::vec4(p)).y,
                    std::cos(two_pi * (double{p} - std::round(double{p}))), 1e-6)
            << p;
    }
}

TEST(wind, power_above_one_is_the_power) {
    for (const double v : {-1.0, -0.7, -0.5, -0.25, 0.0}) {
        for (double r = 1; r < 50; r *= 1.003) {
            const auto ratio = static_cast<float>(r);
            const auto exponent = static_cast<float>(v);
            const double expected = std::pow(double{ratio}, double{exponent});
            ASSERT_NEAR(shared::power_above_one(ratio, exponent) / expected, 1, 4e-6)
                << r << "^" << v;
        }
        EXPECT_EQ(shared::power_above_one(1.0f, static_cast<float>(v)), 1.0f);
    }
}

TEST(wind, waves_add_up) {
    support::random_source random(7);
    constexpr std::uint32_t groups = 9;
    std::vector<shared::wind_waves> waves(groups);
    std::vector<glm::vec4> phases(groups);
    double amplitudes = 0;
    for (std::uint32_t g = 0; g < groups; ++g) {
        for (int lane = 0; lane < 4; ++lane) {
            const glm::vec3 k = random_vec3(random, 2);
            const glm::vec3 a = random_vec3(random, 1);
            waves[g].kx[lane] = k.x;
            waves[g].ky[lane] = k.y;
            waves[g].kz[lane] = k.z;
            waves[g].ax[lane] = a.x;
            waves[g].ay[lane] = a.y;
            waves[g].az[lane] = a.z;
            phases[g][lane] = static_cast<float>(random.between(0, 1));
            amplitudes += double{glm::length(a)};
        }
    }
    const kernels::wave_wind kernel{glm::vec4(5, -1, 2, 0), groups};
    std::vector<glm::vec4> places(500), air(500);
    for (glm::vec4& place : places) {
        place = glm::vec4(random_vec3(random, 20), static_cast<float>(random.between(0, 2)));
    }
    for (std::uint32_t i = 0; i < places.size(); ++i) {
        kernel.map(i, places, waves, phases, air);
        dvec3 expected = dvec3(5, -1, 2) * double{places[i].w};
        for (std::uint32_t g = 0; g < groups; ++g) {
            for (int lane = 0; lane < 4; ++lane) {
                const dvec3 k(waves[g].kx[lane], waves[g].ky[lane], waves[g].kz[lane]);
                const dvec3 a(waves[g].ax[lane], waves[g].ay[lane], waves[g].az[lane]);
                const double cycles = double{phases[g][lane]} - glm::dot(k, dvec3(places[i]));
                expected += a * std::cos(two_pi * cycles);
            }
        }
        // |k · x| ≤ 120 cycles, of which each of six operations rounds 2^-24: 4.3e-5, times 2π; and
        // 1e-6 of the cosine.
        const double tolerance = amplitudes * (two_pi * 4.3e-5 + 1e-6) + 1e-5;
        ASSERT_LE(glm::length(dvec3(air[i]) - expected), tolerance) << i;
        ASSERT_NEAR(air[i].w, glm::length(expected), tolerance) << i;
    }
}

TEST(wind, grids_are_exact_for_linear_fields) {
    support::random_source random(3);
    for (const glm::uvec3 n : {glm::uvec3(5, 4, 3), glm::uvec3(2, 2, 2), glm::uvec3(17, 2, 9)}) {
        const grid g = linear_grid({-3, 1, 2}, {0.5f, 1.25f, 2}, n);
        for (int i = 0; i < 2000; ++i) {
            const glm::vec3 t(random.between(0, 1), random.between(0, 1), random.between(0, 1));
            const glm::vec3 place = g.low + (g.high - g.low) * t;
            const glm::vec4 air = air_at(g, place);
            const dvec3 expected = linear_field(dvec3(place));
            // Velocities up to 60 m/s rounded at the nodes and in three steps, 4 · 2^-24 each, and
            // the place in its cell by 2^-24 of 16 cells, worth up to 4 m/s each.
            ASSERT_LE(glm::length(dvec3(air) - expected), 60 * 16 * 6e-8 + 16 * 4 * 6e-8);
            ASSERT_NEAR(air.w, glm::length(expected), 1e-4);
        }
    }
}

TEST(wind, grids_hold_their_last_values_outside) {
    const grid g = linear_grid({-3, 1, 2}, {0.5f, 1.25f, 2}, {5, 4, 3});
    support::random_source random(4);
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 place = random_vec3(random, 50);
        const glm::vec3 inside = glm::clamp(place, g.low, g.high);
        ASSERT_LE(glm::length(dvec3(air_at(g, place)) - linear_field(dvec3(inside))), 1e-4);
    }
    const grid far = linear_grid({0, 0, 0}, {1, 1, 1}, {3, 3, 3});
    for (const float x : {-1e30f, 1e30f}) {
        const glm::vec4 air = air_at(far, glm::vec3(x));
        const dvec3 corner = x < 0 ? dvec3(0) : dvec3(2);
        EXPECT_LE(glm::length(dvec3(air) - linear_field(corner)), 1e-6);
    }
}

TEST(wind, grid_of_one_node_is_the_same_everywhere) {
    const grid g = linear_grid({1, 2, 3}, {1, 1, 1}, {1, 1, 1});
    for (const glm::vec3 place : {glm::vec3(0), glm::vec3(1, 2, 3), glm::vec3(100)}) {
        EXPECT_LE(glm::length(dvec3(air_at(g, place)) - linear_field({1, 2, 3})), 1e-6);
    }
}

TEST(wind, loads_are_those_of_cylinders_and_leaves) {
    support::random_source random(11);
    for (int i = 0; i < 3000; ++i) {
        const dvec3 axis = random.direction();
        const glm::vec4 turn(random.rotation(3.1));
        const glm::quat q(turn.w, turn.x, turn.y, turn.z);
        const double wood_area = random.between(0, 2);
        const double leaf_area = i % 3 == 0 ? 0 : random.between(0, 5);
        const dvec3 u = random.direction() * random.between(0, 40);
        const double vogel = -random.between(0, 1);
        const double reference = random.between(1, 8);
        const std::vector<shared::wind_segment> segments{
            {glm::vec4(glm::vec3(axis), static_cast<float>(1.1 * wood_area)),
             glm::vec4(static_cast<float>(0.4 * leaf_area), 0, 0, 0)}};
        std::vector<segment_pose> poses(1);
        poses[0].rotation = turn;
        const std::vector<glm::vec4> air{glm::vec4(glm::vec3(u), glm::length(glm::vec3(u)))};
        std::vector<segment_load> loads(1);
        const kernels::wind_load kernel{0.5f * 1.2f, static_cast<float>(vogel),
                                        static_cast<float>(reference)};
        kernel.map(0, segments, poses, air, loads);
        const dvec3 now = glm::dquat(q) * axis;
        const load expected =
            load_of(now, wood_area, leaf_area, u, 1.2, 1.1, 0.4, vogel, reference);
        // Across is u less its part along the axis, each rounded by some 4 · 2^-24 of the speed.
        const double speed = glm::length(u);
        const double scale =
            0.66 * wood_area * speed * speed + 0.24 * leaf_area * speed * speed + 1e-6;
        ASSERT_LE(glm::length(dvec3(loads[0].force) - expected.force), 4e-6 * scale) << i;
        ASSERT_GE(loads[0].drag, 0);
        ASSERT_NEAR(loads[0].drag, expected.drag, 8e-6 * scale / std::max(speed, 1e-3)) << i;
    }
}

TEST(wind, damping_is_how_the_force_falls) {
    // A central difference of the kernel's own force: how it falls when the segment moves with the
    // wind at ±h. Rounding of forces of 300 N: 300 · 2^-22 / 2h = 1.8e-3; the third derivative adds
    // h² · 0.3.
    const std::vector<shared::wind_segment> segments{
        {glm::vec4(0, 1, 0, 0.77f), glm::vec4(0.8f, 0, 0, 0)}};
    const std::vector<segment_pose> poses(1);
    const kernels::wind_load kernel{0.6f, -0.7f, 4};
    const auto load_at = [&](float speed) {
        const std::vector<glm::vec4> air{glm::vec4(speed, 0, 0, speed)};
        std::vector<segment_load> loads(1);
        kernel.map(0, segments, poses, air, loads);
        return loads[0];
    };
    constexpr float h = 0.02f;
    for (const float speed : {1.0f, 3.0f, 5.0f, 12.0f, 25.0f}) {
        const double fall =
            (double{load_at(speed + h).force.x} - double{load_at(speed - h).force.x}) /
            (2 * double{h});
        EXPECT_NEAR(load_at(speed).drag, fall, 3e-3) << speed;
    }
}

TEST(wind, calm_air_does_nothing) {
    const std::vector<shared::wind_segment> segments{
        {glm::vec4(0, 1, 0, 0.7f), glm::vec4(2, 0, 0, 0)}};
    const std::vector<segment_pose> poses(1);
    const std::vector<glm::vec4> air{glm::vec4(0)};
    std::vector<segment_load> loads{{glm::vec3(9), 9}};
    kernels::wind_load{0.6f, -0.7f, 4}.map(0, segments, poses, air, loads);
    EXPECT_EQ(loads[0].force, glm::vec3(0));
    EXPECT_EQ(loads[0].drag, 0);
}
