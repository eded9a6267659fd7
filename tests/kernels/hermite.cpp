// The centreline against a Bézier form in double precision, and its derivative.

#include <skybark/shared/hermite.hpp>

#include "support/random.hpp"

#include <algorithm>
#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;
using glm::vec3;

namespace {

struct curve {
    vec3 p1, n1, p2, n2;

    /// The same cubic by its Bézier points p1, p1 + n1/3, p2 − n2/3, p2 and de Casteljau's scheme.
    [[nodiscard]] dvec3 exact(double t) const {
        const dvec3 a(p1);
        const dvec3 b = a + dvec3(n1) / 3.0;
        const dvec3 d(p2);
        const dvec3 c = d - dvec3(n2) / 3.0;
        const auto mix = [t](const dvec3& x, const dvec3& y) { return x + (y - x) * t; };
        const dvec3 ab = mix(a, b), bc = mix(b, c), cd = mix(c, d);
        return mix(mix(ab, bc), mix(bc, cd));
    }
    [[nodiscard]] vec3 at(float t) const { return shared::hermite_point(p1, n1, p2, n2, t); }
    [[nodiscard]] vec3 derivative(float t) const {
        return shared::hermite_derivative(p1, n1, p2, n2, t);
    }
    [[nodiscard]] double size() const {
        double most = 0;
        for (const vec3& v : {p1, n1, p2, n2}) {
            most = std::max(most, glm::length(dvec3(v)));
        }
        return most;
    }
};

curve random_curve(support::random_source& random) {
    const auto vector = [&] { return vec3(random.direction() * random.between(0, 10)); };
    return {vector(), vector(), vector(), vector()};
}

// Weights of at most 1 with 4 roundings each, 4 products and 3 sums.
constexpr double tolerance = 4 * (4 + 2) * 5.97e-8;

} // namespace

TEST(hermite, point_is_on_the_cubic) {
    support::random_source random(1);
    for (int i = 0; i < 50'000; ++i) {
        const curve c = random_curve(random);
        const auto t = static_cast<float>(random.between(0, 1));
        ASSERT_LE(glm::length(dvec3(c.at(t)) - c.exact(t)), tolerance * c.size()) << t;
    }
}

// Central differences of a cubic are exact up to h² p'''/6; by Richardson's step that falls out.
TEST(hermite, derivative_is_that_of_the_point) {
    support::random_source random(2);
    for (int i = 0; i < 50'000; ++i) {
        const curve c = random_curve(random);
        const auto t = static_cast<float>(random.between(0, 1));
        const auto difference = [&](double h) {
            return (c.exact(t + h) - c.exact(t - h)) / (2 * h);
        };
        const dvec3 exact = (4.0 * difference(1e-3) - difference(2e-3)) / 3.0;
        // Weights of at most 1.5.
        ASSERT_LE(glm::length(dvec3(c.derivative(t)) - exact), 2 * tolerance * c.size()) << t;
    }
}

TEST(hermite, ends_are_the_ends_bit_for_bit) {
    support::random_source random(3);
    for (int i = 0; i < 10'000; ++i) {
        const curve c = random_curve(random);
        ASSERT_EQ(c.at(0), c.p1);
        ASSERT_EQ(c.at(1), c.p2);
        ASSERT_EQ(c.derivative(0), c.n1);
        ASSERT_EQ(c.derivative(1), c.n2);
    }
}

// Tangents along the growth and as long as the chord: a straight line at an even speed. With the
// paper's own sign of the last term it would turn round at its end.
TEST(hermite, straight_segment_is_straight_and_even) {
    const vec3 base(1, 2, 3);
    const vec3 chord(0.5f, 4, -1);
    const curve c{base, chord, base + chord, chord};
    for (int i = 0; i <= 64; ++i) {
        const double t = i / 64.0;
        EXPECT_LE(
            glm::length(dvec3(c.at(static_cast<float>(t))) - (dvec3(base) + dvec3(chord) * t)),
            tolerance * c.size());
    }
}

TEST(hermite, no_length_is_a_point) {
    const vec3 p(3, -2, 1);
    const curve c{p, vec3(0), p, vec3(0)};
    for (int i = 0; i <= 7; ++i) {
        const auto t = static_cast<float>(i) / 7;
        EXPECT_LE(glm::length(c.at(t) - p), 1e-6f);
        EXPECT_EQ(c.derivative(t), vec3(0));
    }
}
