// Rotation-minimising frames against a helix, where they are known in closed form.

#include <skybark/shared/frames.hpp>

#include "support/random.hpp"

#include <cmath>
#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;
using glm::vec3;

namespace {

constexpr double pi = 3.14159265358979323846;

/// (r cos a, r sin a, c a), with its Frenet frame and the frame that does not turn about the
/// tangent: it lags behind Frenet's by the torsion times the length.
struct helix {
    double r, c;

    [[nodiscard]] double speed() const { return std::sqrt(r * r + c * c); }
    [[nodiscard]] dvec3 point(double a) const { return {r * std::cos(a), r * std::sin(a), c * a}; }
    [[nodiscard]] dvec3 tangent(double a) const {
        return dvec3(-r * std::sin(a), r * std::cos(a), c) / speed();
    }
    [[nodiscard]] dvec3 untwisted(double a) const {
        const dvec3 normal(-std::cos(a), -std::sin(a), 0);
        const dvec3 binormal = glm::cross(tangent(a), normal);
        const double torsion = c / (speed() * speed());
        const double angle = -torsion * speed() * a;
        return std::cos(angle) * normal + std::sin(angle) * binormal;
    }
};

/// How far the carried axis has turned about the tangent after `turns` in `steps`, rad.
double twist_error(const helix& h, double turns, int steps) {
    vec3 x(h.untwisted(0));
    for (int i = 0; i < steps; ++i) {
        const double a = turns * 2 * pi * i / steps;
        const double b = turns * 2 * pi * (i + 1) / steps;
        x = shared::double_reflection(vec3(h.point(a)), vec3(h.tangent(a)), x, vec3(h.point(b)),
                                      vec3(h.tangent(b)));
    }
    const double end = turns * 2 * pi;
    const dvec3 exact = h.untwisted(end);
    return std::atan2(glm::dot(glm::cross(exact, dvec3(x)), h.tangent(end)),
                      glm::dot(exact, dvec3(x)));
}

} // namespace

// Steps of 22.5 degrees: 3e-5 rad at a rise of half the radius a radian, by an independent
// computation.
TEST(frames, helix_of_two_turns_in_32_steps) {
    for (const double c : {0.1, 0.3, 0.5, -0.5, 5.0}) {
        EXPECT_LT(std::abs(twist_error({1, c}, 2, 32)), 5e-5) << c;
    }
}

// Fourth order: half the step, a sixteenth of the error, until 32 rad · 2⁻²⁴ of rounding.
TEST(frames, error_falls_with_the_fourth_power_of_the_step) {
    const helix h{1, 0.5};
    const double coarse = twist_error(h, 2, 16);
    const double middle = twist_error(h, 2, 32);
    const double fine = twist_error(h, 2, 64);
    EXPECT_GT(coarse / middle, 12);
    EXPECT_LT(coarse / middle, 20);
    EXPECT_GT(middle / fine, 12);
    EXPECT_LT(middle / fine, 20);
}

// In a plane nothing turns: the axis across it stays, to the last bits.
TEST(frames, plane_curve_does_not_twist) {
    vec3 x(0, 0, 1);
    for (int i = 0; i < 100; ++i) {
        const double a = 0.1 * i;
        const double b = 0.1 * (i + 1);
        const auto p = [](double s) { return vec3(std::cos(s), std::sin(2 * s), 0); };
        const auto t = [](double s) {
            return vec3(glm::normalize(dvec3(-std::sin(s), 2 * std::cos(2 * s), 0)));
        };
        x = shared::double_reflection(p(a), t(a), x, p(b), t(b));
    }
    EXPECT_LE(glm::length(x - vec3(0, 0, 1)), 1e-6f);
}

TEST(frames, step_keeps_lengths_and_angles) {
    support::random_source random(1);
    for (int i = 0; i < 20'000; ++i) {
        const dvec3 t1 = random.direction();
        const dvec3 t2 = random.direction();
        const dvec3 r = glm::normalize(glm::cross(t1, random.direction()));
        const dvec3 p = random.direction();
        const vec3 carried =
            shared::double_reflection(vec3(0), vec3(t1), vec3(r), vec3(p), vec3(t2));
        // A reflection scales a rounding by 2 / c · v v: 1 for each of the two, and c2 ≥ 1e-3 here.
        const dvec3 mirrored = t1 - 2.0 * glm::dot(p, t1) * p;
        if (glm::length(t2 - mirrored) < 0.03) {
            continue;
        }
        ASSERT_NEAR(glm::length(dvec3(carried)), 1, 2e-6);
        ASSERT_NEAR(glm::dot(dvec3(carried), t2), 0, 4e-5);
    }
}

TEST(frames, equal_positions_turn_by_the_tangents_alone) {
    const vec3 p(1, 2, 3);
    const vec3 r = shared::double_reflection(p, vec3(0, 1, 0), vec3(1, 0, 0), p, vec3(1, 0, 0));
    EXPECT_NEAR(glm::dot(r, vec3(1, 0, 0)), 0, 1e-6f);
    EXPECT_NEAR(glm::length(r), 1, 1e-6f);
    // The same tangent as well: nothing moves.
    const vec3 same = shared::double_reflection(p, vec3(0, 1, 0), vec3(1, 0, 0), p, vec3(0, 1, 0));
    EXPECT_EQ(same, vec3(1, 0, 0));
}

TEST(frames, straight_line_keeps_the_axis) {
    const vec3 r = shared::double_reflection(vec3(0), vec3(0, 1, 0), vec3(1, 0, 0), vec3(0, 2, 0),
                                             vec3(0, 1, 0));
    EXPECT_EQ(r, vec3(1, 0, 0));
}

TEST(frames, unit_or_takes_the_other_where_there_is_no_direction) {
    EXPECT_EQ(shared::unit_or(vec3(0), vec3(1, 2, 3)), vec3(1, 2, 3));
    EXPECT_EQ(shared::unit_or(vec3(0, -4, 0), vec3(1, 2, 3)), vec3(0, -1, 0));
}
