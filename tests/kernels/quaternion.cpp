// Unit quaternions against double precision with the library's sin and acos.

#include <skybark/shared/quaternion.hpp>

#include "support/random.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>

using namespace skybark;
using glm::dvec3;
using glm::dvec4;
using glm::vec4;

namespace {

constexpr double half_pi = 1.57079632679489661923;

/// sin((1 − t) θ) / sin θ · a + sin(t θ) / sin θ · b, b on a's side. θ by atan2 of what is across
/// and along, since acos near 1 has lost half of even a double's digits.
dvec4 exact_slerp(dvec4 a, dvec4 b, double t) {
    a /= glm::length(a);
    b /= glm::length(b);
    double cosine = glm::dot(a, b);
    if (cosine < 0) {
        b = -b;
        cosine = -cosine;
    }
    const double angle = std::atan2(glm::length(b - a * cosine), cosine);
    if (angle == 0) {
        return a;
    }
    return (std::sin((1 - t) * angle) * a + std::sin(t * angle) * b) / std::sin(angle);
}

/// θ rad from `a` on the 3-sphere.
dvec4 turned_by(support::random_source& random, const dvec4& a, double angle) {
    dvec4 across(random.direction(), random.between(-1, 1));
    across -= a * glm::dot(a, across);
    return a * std::cos(angle) + across / glm::length(across) * std::sin(angle);
}

double worst(const dvec4& a, const dvec4& b) {
    const dvec4 d = glm::abs(a - b);
    return std::max({d.x, d.y, d.z, d.w});
}

// A component is the sum of two products, each with a weight of at most 1, divided by a length near
// 1. A weight carries the relative error of θ (√, arctan: 2e-8 and 4 roundings), of the sine's
// polynomial (2e-9 and 4 roundings) and of 1 / sin θ, and moves by less than that much of itself.
// 10 roundings of 2⁻²⁴ at worst, all one way.
constexpr double slerp_tolerance = 10 * 5.97e-8;

} // namespace

TEST(quaternion, slerp_agrees_with_double_precision_at_any_angle) {
    support::random_source random(1);
    for (int i = 0; i < 200'000; ++i) {
        const dvec4 a = random.rotation(2 * half_pi);
        // Angles on the 3-sphere up to π: both ways round.
        const vec4 b(turned_by(random, a, random.between(0, 2 * half_pi)));
        const vec4 from(a);
        const auto t = static_cast<float>(random.between(0, 1));
        const double angle = std::acos(std::min(1.0, std::abs(glm::dot(a, dvec4(b)))));
        dvec4 q(shared::slerp(from, b, t));
        const dvec4 e = exact_slerp(dvec4(from), dvec4(b), t);
        if (half_pi - angle < 1e-6) {
            continue; // either way round is as short
        }
        ASSERT_LE(worst(q, e), slerp_tolerance) << "angle " << angle << ", t " << t;
    }
}

TEST(quaternion, slerp_of_nearly_equal_rotations) {
    support::random_source random(2);
    for (const double angle : {1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 9.99e-4, 1e-3, 1.001e-3, 2e-3, 1e-2}) {
        for (int i = 0; i < 2000; ++i) {
            const dvec4 a = random.rotation(2 * half_pi);
            const vec4 from(a);
            const vec4 to(turned_by(random, a, angle) * (i % 2 == 0 ? 1.0 : -1.0));
            const auto t = static_cast<float>(random.between(0, 1));
            const dvec4 q(shared::slerp(from, to, t));
            // Below 1e-3 rad it is a lerp: θ³ / 16 · max |t (1 − t)(1 − 2t)| < 1e-11 off the arc.
            ASSERT_LE(worst(q, exact_slerp(dvec4(from), dvec4(to), t)), slerp_tolerance)
                << "angle " << angle << ", t " << t;
        }
    }
}

// The step of a slow turn must be even: an angle rounded away would show here, not in components.
TEST(quaternion, slerp_goes_at_an_even_speed) {
    support::random_source random(3);
    for (const double angle : {1e-3, 1.1e-3, 0.01, 0.1, 1.0, 1.5}) {
        const vec4 from(0, 0, 0, 1);
        const vec4 to(turned_by(random, dvec4(from), angle));
        const double whole =
            std::atan2(glm::length(dvec3(to)), double{to.w}); // not quite `angle`: rounded
        for (int i = 1; i < 16; ++i) {
            const dvec4 q(shared::slerp(from, to, static_cast<float>(i) / 16));
            const double done = std::atan2(glm::length(dvec3(q)), q.w);
            ASSERT_NEAR(done, whole * i / 16, 2 * slerp_tolerance * whole) << angle << ' ' << i;
        }
    }
}

TEST(quaternion, slerp_ends_are_the_ends_bit_for_bit) {
    support::random_source random(4);
    for (int i = 0; i < 20'000; ++i) {
        const dvec4 a = random.rotation(2 * half_pi);
        const double angle = i % 2 == 0 ? random.between(0, 2 * half_pi) : random.between(0, 2e-3);
        const vec4 from(a);
        const vec4 to(turned_by(random, a, angle));
        const shared::slerp_arc arc = shared::slerp_begin(from, to);
        ASSERT_EQ(shared::slerp_at(arc, 0), from);
        const vec4 last = shared::slerp_at(arc, 1);
        ASSERT_TRUE(last == to || last == -to);
        ASSERT_GE(glm::dot(dvec4(from), dvec4(last)), -1e-6); // the short way
    }
}

TEST(quaternion, slerp_between_equal_and_opposite_signs_stays_put) {
    support::random_source random(5);
    for (int i = 0; i < 2000; ++i) {
        const vec4 a(random.rotation(2 * half_pi));
        for (const float t : {0.0f, 0.25f, 0.5f, 1.0f}) {
            for (const vec4 b : {a, -a}) {
                ASSERT_LE(worst(dvec4(shared::slerp(a, b, t)), dvec4(a)), slerp_tolerance);
            }
        }
    }
}

// A half turn: the two quaternions are at right angles, and either way is as short. The result must
// still be a unit quaternion half way between.
TEST(quaternion, slerp_over_half_a_turn) {
    const vec4 a(0, 0, 0, 1);
    const vec4 b(1, 0, 0, 0);
    const dvec4 q(shared::slerp(a, b, 0.5f));
    EXPECT_NEAR(std::abs(q.x), std::sqrt(0.5), slerp_tolerance);
    EXPECT_NEAR(std::abs(q.w), std::sqrt(0.5), slerp_tolerance);
    EXPECT_NEAR(glm::length(q), 1, slerp_tolerance);
}

TEST(quaternion, not_a_number_stays_one) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const vec4 fine(0, 0, 0, 1);
    for (int component = 0; component < 4; ++component) {
        vec4 bad = fine;
        bad[component] = nan;
        for (const float t : {0.25f, 0.5f, 0.75f}) {
            EXPECT_TRUE(std::isnan(shared::slerp(bad, fine, t)[component]));
            EXPECT_TRUE(std::isnan(shared::slerp(fine, bad, t)[component]));
        }
    }
}

TEST(quaternion, arctan_and_sine_are_as_good_as_they_say) {
    for (int i = 0; i <= 100'000; ++i) {
        const auto x = static_cast<float>(i / 1e5);
        // Abramowitz and Stegun 4.4.49: 2e-8, and the roundings of 1 + s · (…) times x.
        ASSERT_NEAR(double{shared::arctan_unit(x)}, std::atan(double{x}), 2e-8 + 2 * 5.97e-8) << x;
        const auto angle = static_cast<float>(i / 1e5 * half_pi);
        ASSERT_NEAR(double{shared::sin_quarter(angle)}, std::sin(double{angle}),
                    (2e-9 + 3 * 5.97e-8) * std::sin(double{angle}) + 1e-12)
            << angle;
    }
}

// Rodrigues' formula, from the angle and the axis and not from the quaternion.
TEST(quaternion, axes_are_those_of_the_rotation) {
    support::random_source random(6);
    for (int i = 0; i < 20'000; ++i) {
        const dvec3 axis = random.direction();
        const double angle = random.between(-2 * half_pi, 2 * half_pi);
        const vec4 q(dvec4(std::sin(angle / 2) * axis, std::cos(angle / 2)));
        const auto turned = [&](const dvec3& v) {
            return v * std::cos(angle) + glm::cross(axis, v) * std::sin(angle) +
                   axis * glm::dot(axis, v) * (1 - std::cos(angle));
        };
        // Each component is 1 − 2 (a² + b²) or 2 (ab ± cd) of floats with half an ulp of error.
        const double tolerance = 8 * 5.97e-8;
        ASSERT_LE(glm::length(dvec3(shared::quaternion_x(q)) - turned({1, 0, 0})), tolerance);
        ASSERT_LE(glm::length(dvec3(shared::quaternion_y(q)) - turned({0, 1, 0})), tolerance);
        ASSERT_LE(glm::length(dvec3(shared::quaternion_z(q)) - turned({0, 0, 1})), tolerance);
    }
}
