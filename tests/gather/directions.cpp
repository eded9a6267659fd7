// The axes that bundles are taken along: even, unbiased, the same everywhere, and how large errors
// are with so many of them.

#include "support/form_factors.hpp"

#include <skybark/gather/directions.hpp>

#include <algorithm>
#include <functional>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <vector>

using namespace skybark;
using gather::bundle_axes;
using glm::dvec3;

namespace {

constexpr int side = 6; ///< points of a form: side²

/// What is seen from a point of the plane z = 0 along a direction of z > 0, and how much of it.
struct form {
    const char* name;
    std::function<bool(double x, double y, dvec3 direction)> seen;
    std::function<double(double x, double y)> share;
};

const std::vector<form>& forms() {
    static const std::vector<form> all{
        {"parallel squares",
         [](double x, double y, dvec3 d) {
             const double u = x + d.x / d.z;
             const double v = y + d.y / d.z;
             return u >= 0 && u <= 1 && v >= 0 && v <= 1;
         },
         support::share_of_parallel_square},
        {"standing squares",
         [](double x, double y, dvec3 d) {
             const double t = -x / d.x;
             const double v = y + d.y * t;
             return d.x < 0 && v >= 0 && v <= 1 && d.z * t <= 1;
         },
         support::share_of_standing_square},
        {"disk",
         [](double x, double, dvec3 d) {
             const double height = 0.25 + 1.5 * x;
             return (d.x * d.x + d.y * d.y) * height * height <= d.z * d.z;
         },
         [](double x, double) { return support::share_of_disk(1, 0.25 + 1.5 * x); }},
        {"sphere",
         [](double x, double y, dvec3 d) {
             const dvec3 middle(2 - 4 * x, 2 - 4 * y, 1.5);
             const double along = dot(middle, d);
             return along > 0 && dot(middle, middle) - along * along <= 1;
         },
         [](double x, double y) {
             return support::share_of_sphere(1, 1.5, std::hypot(2 - 4 * x, 2 - 4 * y));
         }},
    };
    return all;
}

/// The sum of squared errors over a form's points, with these axes.
double squared_errors(const form& f, const std::vector<dvec3>& axes) {
    double sum = 0;
    for (int i = 0; i < side * side; ++i) {
        const double x = (i % side + 0.5) / side;
        const double y = (i / side + 0.5) / side;
        double seen = 0;
        double all = 0;
        for (const dvec3& axis : axes) {
            const dvec3 d = axis.z < 0 ? -axis : axis;
            all += d.z;
            seen += f.seen(x, y, d) ? d.z : 0;
        }
        const double error = seen / all - f.share(x, y);
        sum += error * error;
    }
    return sum;
}

/// Axes [first, first + step, …) of a seed: `count` of them.
std::vector<dvec3> axes_of(std::uint64_t seed, std::uint64_t first, std::uint64_t step,
                           std::uint64_t count) {
    const bundle_axes all(seed);
    std::vector<dvec3> axes;
    for (std::uint64_t k = 0; k < count; ++k) {
        axes.push_back(all[first + step * k]);
    }
    return axes;
}

/// Root mean square over a form's points and `seeds` seeds.
double rms(const form& f, int seeds, std::uint64_t first, std::uint64_t step, std::uint64_t count) {
    double sum = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
        sum += squared_errors(f, axes_of(static_cast<std::uint64_t>(seed), first, step, count));
    }
    return std::sqrt(sum / (seeds * side * side));
}

} // namespace

TEST(directions, are_unit_vectors) {
    const bundle_axes axes(3);
    for (std::uint64_t k = 0; k < 5000; ++k) {
        EXPECT_NEAR(length(axes[k]), 1, 1e-14);
    }
    const dvec3 late = axes[(std::uint64_t{1} << 60) + 5];
    EXPECT_NEAR(length(late), 1, 1e-14);
}

/// Worked out by a script in Python, with fractions for the lattice and a matrix for the rotation.
TEST(directions, are_the_same_on_every_machine) {
    const auto expect = [](std::uint64_t seed, std::uint64_t k, dvec3 axis) {
        EXPECT_LT(length(bundle_axes(seed)[k] - axis), 1e-9); // 2^-32 of the shifts by fifths
    };
    expect(1, 0, {-0.546007097087, 0.345930782143, 0.763025650877});
    expect(1, 13, {0.751470377298, -0.022905857667, -0.659369087635});
    expect(42, 1000003, {-0.842652812006, -0.366676039268, -0.394315762612});
}

TEST(directions, follow_a_lattice_by_powers_of_one_plus_i) {
    const auto at = [](std::uint64_t n) {
        const gather::detail::lattice_place p = gather::detail::lattice_point(n);
        return std::pair(p.x * 0x1p-32, p.y * 0x1p-32);
    };
    // 1/(1+i) = ½ − ½i; 1/(1+i)² = −½i; 1/(1+i)³ = −¼ − ¼i
    EXPECT_EQ(at(0), std::pair(0.0, 0.0));
    EXPECT_EQ(at(1), std::pair(0.5, 0.5));
    EXPECT_EQ(at(2), std::pair(0.0, 0.5));
    EXPECT_EQ(at(3), std::pair(0.5, 0.0));
    EXPECT_EQ(at(4), std::pair(0.75, 0.75));
    EXPECT_EQ(at(6), std::pair(0.75, 0.25));
}

TEST(directions, hold_a_lattice_at_every_power_of_two) {
    for (int m = 0; m <= 12; ++m) {
        // Of 2^m points of a lattice, differences are points of it too, so all are found by adding.
        std::vector<std::pair<std::uint32_t, std::uint32_t>> points;
        for (std::uint64_t k = 0; k < std::uint64_t{1} << m; ++k) {
            const auto p = gather::detail::lattice_point(k);
            points.emplace_back(p.x, p.y);
        }
        std::sort(points.begin(), points.end());
        EXPECT_EQ(std::unique(points.begin(), points.end()), points.end());
        const auto step = gather::detail::lattice_point((std::uint64_t{1} << m) / 2);
        for (const auto& [x, y] : points) {
            EXPECT_TRUE(std::binary_search(points.begin(), points.end(),
                                           std::pair(x + step.x, y + step.y)));
            EXPECT_TRUE(std::binary_search(points.begin(), points.end(),
                                           std::pair(x - step.y, y + step.x)));
        }
    }
}

/// The map of the square keeps areas: a grid of 300² points has the moments of the hemisphere,
/// z: 1/2, z²: 1/3, x²: 1/3, and none sideways.
TEST(directions, fill_the_hemisphere_evenly) {
    constexpr int n = 300;
    double z = 0;
    double zz = 0;
    double xx = 0;
    double xy = 0;
    double x4 = 0;
    for (int i = 0; i < n * n; ++i) {
        const dvec3 d = gather::detail::hemisphere_point((i % n + 0.5) / n, (i / n + 0.5) / n);
        EXPECT_NEAR(dot(d, d), 1, 1e-14);
        EXPECT_GE(d.z, 0);
        z += d.z;
        zz += d.z * d.z;
        xx += d.x * d.x;
        xy += d.x * d.y;
        x4 += d.x * d.x * d.x * d.x;
    }
    // The midpoint rule's error, of a map whose second derivatives are a few units: some 1/n².
    EXPECT_NEAR(z / (n * n), 1.0 / 2, 5e-5);
    EXPECT_NEAR(zz / (n * n), 1.0 / 3, 5e-5);
    EXPECT_NEAR(xx / (n * n), 1.0 / 3, 5e-5);
    EXPECT_NEAR(xy / (n * n), 0, 1e-12);
    EXPECT_NEAR(x4 / (n * n), 1.0 / 5, 5e-5);
    EXPECT_EQ(gather::detail::hemisphere_point(0.5, 0.5), dvec3(0, 0, 1));
}

TEST(directions, cosines_and_sines_are_those_of_the_library) {
    for (int i = -100; i <= 100; ++i) {
        const double angle = i * 0.00785398163397448;
        const glm::dvec2 found = gather::detail::cosine_and_sine(angle);
        EXPECT_NEAR(found.x, std::cos(angle), 3e-16);
        EXPECT_NEAR(found.y, std::sin(angle), 3e-16);
    }
}

/// Each replicate's first axis, over seeds, has the moments of the whole sphere: mean 0, squares
/// 1/3, products 0, within 4.5 standard deviations of a mean of `seeds`.
TEST(directions, of_each_replicate_are_unbiased) {
    constexpr int seeds = 4000;
    for (std::uint64_t replicate = 0; replicate < 8; ++replicate) {
        dvec3 mean(0);
        dvec3 squares(0);
        dvec3 products(0);
        for (std::uint64_t seed = 0; seed < seeds; ++seed) {
            const dvec3 d = bundle_axes(seed)[replicate + 8 * (seed % 3)];
            mean += d;
            squares += d * d;
            products += d * dvec3(d.y, d.z, d.x);
        }
        const double n = seeds;
        for (int a = 0; a < 3; ++a) {
            EXPECT_NEAR(mean[a] / n, 0, 4.5 * std::sqrt(1.0 / 3 / n));
            EXPECT_NEAR(squares[a] / n, 1.0 / 3, 4.5 * std::sqrt(4.0 / 45 / n));
            EXPECT_NEAR(products[a] / n, 0, 4.5 * std::sqrt(1.0 / 15 / n));
        }
    }
}

TEST(directions, of_other_seeds_and_replicates_are_others) {
    const bundle_axes one(1);
    const bundle_axes two(2);
    for (std::uint64_t i = 0; i < 8; ++i) {
        EXPECT_GT(length(one[i] - two[i]), 1e-6);
        for (std::uint64_t j = 0; j < i; ++j) {
            EXPECT_GT(length(one[i] - one[j]), 1e-6);
        }
    }
}

/// A replicate's rms error times n^0.75: measured 0.38…0.49 and 0.42…0.55 (see the header). A
/// sequence without the exponent, by chance, has 1.0 at n = 16 and 2.4 at 512.
TEST(directions, of_a_replicate_err_by_the_power_of_three_quarters) {
    for (const std::uint64_t n : {16u, 64u, 128u, 512u, 100u, 300u}) {
        double squares = 0;
        for (const form& f : forms()) {
            const double e = rms(f, n > 200 ? 12 : 40, 1, 8, n);
            squares += e * e / static_cast<double>(forms().size());
        }
        const double scaled = std::sqrt(squares) * std::pow(static_cast<double>(n), 0.75);
        RecordProperty("scaled_error_of_" + std::to_string(n), std::to_string(scaled));
        EXPECT_LT(scaled, (n & (n - 1)) == 0 ? 0.53 : 0.62) << n;
    }
}

/// All eight together, against closed forms at 1,024 and 4,096 axes. Of independent replicates
/// the first would be 0.0041.
TEST(directions, of_all_replicates_err_little) {
    double all = 0;
    for (const form& f : forms()) {
        const double some = rms(f, 30, 0, 1, 1024);
        const double many = rms(f, 10, 0, 1, 4096);
        RecordProperty(std::string(f.name) + " at 1024", std::to_string(some));
        RecordProperty(std::string(f.name) + " at 4096", std::to_string(many));
        EXPECT_LT(some, 0.005) << f.name;
        EXPECT_LT(many, 0.002) << f.name;
        all += some * some / static_cast<double>(forms().size());
    }
    EXPECT_LT(std::sqrt(all), 0.004);
}

/// The mean of a pair has less than the error of two that know nothing of each other, at every
/// power of two: 0.92 was measured, 1 would be chance.
TEST(directions, of_a_pair_fill_each_others_gaps) {
    double ratio = 0;
    for (const std::uint64_t n : {16u, 32u, 64u, 128u}) {
        double alone = 0;
        double paired = 0;
        for (const form& f : forms()) {
            for (std::uint64_t seed = 1; seed <= 80; ++seed) {
                auto first = axes_of(seed, 0, 8, n);
                const auto second = axes_of(seed, 1, 8, n);
                alone += squared_errors(f, first) / 2;
                first.insert(first.end(), second.begin(), second.end());
                paired += squared_errors(f, first);
            }
        }
        ratio += std::sqrt(paired / alone) / 4;
    }
    RecordProperty("ratio", std::to_string(ratio));
    EXPECT_LT(ratio, 0.97);
    EXPECT_GT(ratio, 0.85);
}
