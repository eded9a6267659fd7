#pragma once
// bundle_axes: the axes that a final gather looks along: eight growing sequences on the hemisphere,
// each turned at random.
//
// An axis stands for a direction and its opposite, so half a sphere holds them all. It is filled
// from a unit square, by Shirley and Chiu's map of equal areas (1997, "A Low Distortion Map Between
// Disk and Square") and Lambert's from the disk to the hemisphere. In the square, the first 2^m
// points of a sequence are a square lattice, for any m: point k, of binary digits b_0 b_1 …, is
//
//     Σ b_j (1 + i)^−(j+1)   in the complex plane, modulo 1 and i,
//
// so that each further digit adds the middles of the squares there were. Lattices are what an
// area's share is counted best with: the error of a form factor falls with the number of axes like
// n^−0.75. Measured on squares, disks and spheres, as rms times n^0.75 (tests/gather/directions.cpp
// prints it): 0.45 at powers of two and 0.5 between, where a spherical Fibonacci spiral, which does
// not grow, has 0.45, the R2 sequence (Roberts 2018) 0.59, and Sobol's 0.60.
//
// Axis number k is the (k / 8)-th of replicate k % 8. The replicates are four pairs. A pair has a
// rotation and a shift in the square of its own, both uniformly random; the second one of a pair is
// the first one, moved by 1/(2 + i). That is no multiple of any of the lattices, and falls between
// the points of each of them in the same way, so that the two are better together than one by
// chance beside the other: the mean of all eight has 0.92 times the error of eight that know
// nothing of each other where borders are smooth, and the same where light is like noise. Every
// replicate alone is unbiased, and what their spread says of the mean's error is right or, by that
// much, too large.

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace skybark::gather {

namespace detail {

/// The n-th of an endless row of random numbers in [0, 1) that a seed has (splitmix64: Steele, Lea
/// and Flood 2014).
[[nodiscard]] constexpr double random_number(std::uint64_t seed, std::uint64_t n) {
    const auto mixed = [](std::uint64_t z) {
        z = (z ^ (z >> 30u)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27u)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31u);
    };
    constexpr std::uint64_t step = 0x9e3779b97f4a7c15u;
    return static_cast<double>(mixed(mixed(seed + step) + (n + 1) * step) >> 11u) * 0x1p-53;
}

/// A place in the unit square, modulo 1, in 2^−32.
struct lattice_place {
    std::uint32_t x = 0;
    std::uint32_t y = 0;
};

/// The n-th point of the growing lattice: Σ b_j (1 + i)^−(j+1), which 32 bits hold exactly.
[[nodiscard]] constexpr lattice_place lattice_point(std::uint64_t n) {
    std::int64_t x = std::int64_t{1} << 32;
    std::int64_t y = 0;
    std::int64_t sum_x = 0;
    std::int64_t sum_y = 0;
    for (; n != 0; n >>= 1u) {
        const std::int64_t turned = (y - x) / 2; // over 1 + i
        x = (x + y) / 2;
        y = turned;
        if ((n & 1u) != 0) {
            sum_x += x;
            sum_y += y;
        }
    }
    return {static_cast<std::uint32_t>(sum_x), static_cast<std::uint32_t>(sum_y)};
}

/// Cosine and sine up to π/4: Taylor's series to 1e-17, for libraries differ in the last bit.
[[nodiscard]] inline glm::dvec2 cosine_and_sine(double angle) {
    const double square = angle * angle;
    double cosine = 0;
    double sine = 0;
    for (int k = 18; k >= 2; k -= 2) {
        cosine = (1 + cosine) * (-square / ((k - 1) * k));
        sine = (1 + sine) * (-square / (k * (k + 1)));
    }
    return {1 + cosine, (1 + sine) * angle};
}

/// From the unit square to the half sphere of z ≥ 0, all areas alike.
[[nodiscard]] inline glm::dvec3 hemisphere_point(double u, double v) {
    constexpr double quarter_pi = 0.78539816339744830962;
    const double a = 2 * u - 1;
    const double b = 2 * v - 1;
    const bool wide = std::abs(a) > std::abs(b);
    const double radius = wide ? a : b;
    if (radius == 0) {
        return {0, 0, 1};
    }
    const glm::dvec2 turn = cosine_and_sine(quarter_pi * (wide ? b / a : a / b));
    const double out = radius * std::sqrt(2 - radius * radius);
    return {out * (wide ? turn.x : turn.y), out * (wide ? turn.y : turn.x), 1 - radius * radius};
}

} // namespace detail

class bundle_axes {
  public:
    static constexpr std::uint32_t replicates = 8;

    explicit bundle_axes(std::uint64_t seed = 1) {
        std::uint64_t n = 0;
        for (pair& p : pairs_) {
            p.shift = {word(seed, n), word(seed, n + 1)};
            n += 2;
            p.rotation = rotation(seed, n);
        }
    }

    /// Axis number k: a unit vector. The same on every machine.
    [[nodiscard]] glm::dvec3 operator[](std::uint64_t k) const {
        const std::uint64_t replicate = k % replicates;
        const pair& p = pairs_[replicate / 2];
        detail::lattice_place at = detail::lattice_point(k / replicates);
        at.x += p.shift.x + (replicate % 2 == 1 ? 0x66666666u : 0u); // 1/(2 + i) = 0.4 − 0.2 i
        at.y += p.shift.y + (replicate % 2 == 1 ? 0xcccccccdu : 0u);
        const glm::dvec3 point =
            detail::hemisphere_point((at.x + 0.5) * 0x1p-32, (at.y + 0.5) * 0x1p-32);
        return turned(p.rotation, point);
    }

  private:
    struct pair {
        detail::lattice_place shift;
        glm::dvec4 rotation{0, 0, 0, 1}; ///< unit quaternion x, y, z, w
    };

    [[nodiscard]] static std::uint32_t word(std::uint64_t seed, std::uint64_t n) {
        return static_cast<std::uint32_t>(detail::random_number(seed, n) * 4294967296.0);
    }

    /// Uniform among all rotations (Marsaglia 1972, "Choosing a Point from the Surface of a
    /// Sphere"). Takes numbers of the seed from `n` on, and counts them.
    [[nodiscard]] static glm::dvec4 rotation(std::uint64_t seed, std::uint64_t& n) {
        const auto in_disk = [&] {
            for (;;) {
                const double x = 2 * detail::random_number(seed, n) - 1;
                const double y = 2 * detail::random_number(seed, n + 1) - 1;
                n += 2;
                const double square = x * x + y * y;
                if (square > 0 && square < 1) {
                    return glm::dvec3(x, y, square);
                }
            }
        };
        const glm::dvec3 a = in_disk();
        const glm::dvec3 b = in_disk();
        const double scale = std::sqrt((1 - a.z) / b.z);
        return {a.x, a.y, b.x * scale, b.y * scale};
    }

    /// v + 2 q × (q × v + w v)
    [[nodiscard]] static glm::dvec3 turned(const glm::dvec4& q, const glm::dvec3& v) {
        const glm::dvec3 t(q.y * v.z - q.z * v.y + q.w * v.x, q.z * v.x - q.x * v.z + q.w * v.y,
                           q.x * v.y - q.y * v.x + q.w * v.z);
        return {v.x + 2 * (q.y * t.z - q.z * t.y), v.y + 2 * (q.z * t.x - q.x * t.z),
                v.z + 2 * (q.x * t.y - q.y * t.x)};
    }

    std::array<pair, replicates / 2> pairs_;
};

} // namespace skybark::gather
