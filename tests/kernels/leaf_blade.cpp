// leaf_blade: the blade against the octagon's closed form, its motion, and what distance leaves.

#include "support/random.hpp"

#include <skybark/conformance/leaf_reference.hpp>
#include <skybark/cpu/cpu.hpp>
#include <skybark/trees/leaf_mesh.hpp>

#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;
using kernels::leaf_blade;

namespace reference = skybark::conformance::reference;

namespace {

using vertices = std::array<surface_vertex, 10>;

const segment_pose rest;
const glm::vec4 calm(0);

glm::vec4 random_turn(support::random_source& random) {
    const dvec3 axis = random.direction();
    const double half = random.between(0, 1.6);
    return glm::vec4(glm::dvec4(axis * std::sin(half), std::cos(half)));
}

leaf random_leaf(support::random_source& random) {
    leaf l;
    l.position = glm::vec3(random.direction() * random.between(0, 8));
    l.length = static_cast<float>(random.between(0.02, 0.3));
    l.width = l.length * static_cast<float>(random.between(0.2, 1));
    l.orientation = random_turn(random);
    l.fold = static_cast<float>(random.between(-1.5, 1.5));
    l.seed = random.below(0xffffffffu);
    return l;
}

segment_pose random_pose(support::random_source& random) {
    segment_pose p;
    p.base = glm::vec3(random.direction() * random.between(0, 8));
    p.shift = glm::vec3(random.direction() * random.between(0, 2));
    p.rotation = random_turn(random);
    return p;
}

glm::vec4 random_air(support::random_source& random) {
    const double speed = random.between(0, 30);
    return {glm::vec3(random.direction() * speed), static_cast<float>(speed)};
}

/// The plain kernel's ring.
vertices ring_of(const leaf_blade& kernel, const leaf& l, const segment_pose& pose = rest,
                 const glm::vec4& air = calm) {
    vertices out;
    std::size_t n = 0;
    kernel.ring(0, 0, 10, [&](const surface_vertex& v) { out.at(n++) = v; }, {&l, 1}, {&pose, 1},
                {&air, 1});
    return out;
}

std::array<std::uint32_t, 18> index_pattern() {
    std::array<std::uint32_t, 18> p;
    for (std::uint32_t k = 0; k < 18; ++k) {
        p[k] = leaf_blade{}.ring_index(k);
    }
    return p;
}

dvec3 twice_area(const vertices& v, std::size_t triangle) {
    static const auto p = index_pattern();
    const dvec3 a(v[p[3 * triangle]].position);
    return glm::cross(dvec3(v[p[3 * triangle + 1]].position) - a,
                      dvec3(v[p[3 * triangle + 2]].position) - a);
}
double area(const vertices& v) {
    double sum = 0;
    for (std::size_t t = 0; t < 6; ++t) {
        sum += glm::length(twice_area(v, t)) / 2;
    }
    return sum;
}

/// Positions to 4e-6 of the leaf's place and size (eight roundings of its distance from the pivot),
/// directions and texture coordinates to 4e-6.
void expect_near(const vertices& actual, const reference::leaf_blade_now& expected, double size,
                 std::uint32_t i) {
    for (std::size_t k = 0; k < 10; ++k) {
        const reference::leaf_corner& e = expected.corners[k];
        ASSERT_LE(glm::distance(dvec3(actual[k].position), e.position), 4e-6 * size)
            << i << ' ' << k;
        ASSERT_LE(glm::distance(dvec3(actual[k].normal), e.normal), 4e-6) << i << ' ' << k;
        ASSERT_LE(glm::distance(dvec3(glm::vec3(actual[k].tangent)), e.tangent), 4e-6) << i;
        ASSERT_EQ(actual[k].tangent.w, 1.0f);
        ASSERT_NEAR(actual[k].u, e.u, 4e-6) << i << ' ' << k;
        ASSERT_NEAR(actual[k].v, e.v, 4e-6) << i << ' ' << k;
    }
}

} // namespace

// A regular octagon of circumradius R has the area 2 √2 R²; scaled to half the width and half the
// length, width · length / √2. Six triangles' roundings: 1e-6 of it.
TEST(leaf_blade, has_the_octagons_area_whatever_the_fold) {
    support::random_source random(1);
    for (int i = 0; i < 200; ++i) {
        leaf l = random_leaf(random);
        l.position = {0, 0, 0};
        const double expected = double{l.width} * l.length / std::sqrt(2.0);
        EXPECT_NEAR(area(ring_of({}, l)), expected, 1e-6 * expected);
    }
}

TEST(leaf_blade, has_the_octagons_outline_when_it_is_flat) {
    leaf l;
    l.width = 2;
    l.length = 2;
    const vertices v = ring_of({}, l);
    for (std::size_t k = 0; k < 10; ++k) {
        // Corners at every 45 degrees from the stalk at (0, -1), one way and the other.
        const double angle = 0.78539816339744831 * static_cast<double>(k % 5);
        const double x = (k < 5 ? 1 : -1) * std::sin(angle);
        const double y = -std::cos(angle);
        EXPECT_NEAR(v[k].position.x, x, 2e-7);
        EXPECT_NEAR(v[k].position.y, 1 + y, 2e-7);
        EXPECT_EQ(v[k].position.z, 0.0f);
        EXPECT_NEAR(v[k].u, 0.5 + 0.5 * x, 1e-7);
        EXPECT_NEAR(v[k].v, 0.5 + 0.5 * y, 1e-7);
        EXPECT_EQ(v[k].normal, glm::vec3(0, 0, 1));
        EXPECT_EQ(v[k].tangent, glm::vec4(1, 0, 0, 1));
    }
}

TEST(leaf_blade, keeps_its_midrib_under_any_fold) {
    support::random_source random(2);
    for (int i = 0; i < 50; ++i) {
        leaf l = random_leaf(random);
        leaf flat = l;
        flat.fold = 0;
        const vertices folded = ring_of({}, l);
        const vertices straight = ring_of({}, flat);
        for (const std::size_t k : {0u, 4u, 5u, 9u}) {
            EXPECT_EQ(folded[k].position, straight[k].position);
        }
        EXPECT_EQ(folded[0].position, l.position);
    }
}

// Counter-clockwise from above, and the bitangent is w · cross(normal, tangent): towards growing v.
TEST(leaf_blade, triangles_face_the_way_of_their_normals) {
    support::random_source random(3);
    const auto p = index_pattern();
    for (int i = 0; i < 100; ++i) {
        const leaf l = random_leaf(random);
        const vertices v = ring_of({}, l);
        for (std::size_t t = 0; t < 6; ++t) {
            const dvec3 face = glm::normalize(twice_area(v, t));
            for (std::size_t k = 0; k < 3; ++k) {
                const surface_vertex& corner = v[p[3 * t + k]];
                EXPECT_NEAR(glm::dot(face, dvec3(corner.normal)), 1, 1e-4); // 8 m off: 5e-7 / 0.01
                const dvec3 bitangent =
                    glm::cross(dvec3(corner.normal), dvec3(glm::vec3(corner.tangent)));
                const dvec3 midrib = dvec3(v[4].position) - dvec3(v[0].position);
                EXPECT_NEAR(glm::dot(bitangent, glm::normalize(midrib)), 1, 1e-4);
            }
        }
    }
}

TEST(leaf_blade, is_where_the_reference_says_in_wind_and_far_away) {
    support::random_source random(4);
    for (std::uint32_t i = 0; i < 2000; ++i) {
        const leaf l = random_leaf(random);
        const segment_pose pose = random_pose(random);
        const glm::vec4 air = random_air(random);
        leaf_blade kernel;
        kernel.time = random.below(0xffffffffu);
        if (i % 2 == 0) {
            kernel.camera = {0, 0, 30, static_cast<float>(random.between(20, 4000))};
        }
        const auto expected = reference::leaf_now(kernel, l, pose, air);
        // A fading leaf's size has the relative error of its rank's distance to the threshold.
        if (expected.scale != 1 && expected.scale < 0.05) {
            continue;
        }
        expect_near(ring_of(kernel, l, pose, air), expected, 30 * std::max(1.0, expected.scale), i);
    }
}

// Nothing but the carrier moves it: a leaf on a turned carrier is the turned leaf.
TEST(leaf_blade, is_carried_rigidly_and_exactly_when_calm) {
    support::random_source random(5);
    for (std::uint32_t i = 0; i < 200; ++i) {
        const leaf l = random_leaf(random);
        const segment_pose pose = random_pose(random);
        leaf_blade kernel;
        kernel.time = random.below(0xffffffffu);
        const vertices still = ring_of({}, l);
        const vertices moved = ring_of(kernel, l, pose);
        const glm::dquat q = glm::normalize(reference::quaternion_of(pose.rotation));
        for (std::size_t k = 0; k < 10; ++k) {
            const dvec3 y = dvec3(still[k].position) - dvec3(pose.base);
            const dvec3 expected = dvec3(pose.base) + dvec3(pose.shift) + q * y;
            EXPECT_LE(glm::distance(dvec3(moved[k].position), expected), 1e-5); // of 16 m
            EXPECT_LE(glm::distance(dvec3(moved[k].normal), q * dvec3(still[k].normal)), 4e-6);
        }
        segment_pose unmoved = pose;
        unmoved.shift = {0, 0, 0};
        unmoved.rotation = {0, 0, 0, 1};
        const vertices same = ring_of(kernel, l, unmoved);
        for (std::size_t k = 0; k < 10; ++k) {
            EXPECT_EQ(same[k].position, still[k].position);
            EXPECT_EQ(same[k].normal, still[k].normal);
        }
    }
}

// Twist at most 2 atan(flutter), nodding half of it: the turn is 2 atan of at most √1.25 flutter.
// A step of 1/240 s turns an oscillation by 255/64 · 2π / 240 = 0.105 rad, so half-tangents change
// by at most 0.105 · √1.25 · flutter, and the angle by twice that.
TEST(leaf_blade, flutter_is_bounded_continuous_and_periodic) {
    support::random_source random(6);
    leaf_blade kernel;
    kernel.lean = 0;
    const double most = std::sqrt(1.25) * kernel.flutter;
    for (std::uint32_t i = 0; i < 60; ++i) {
        const leaf l = random_leaf(random);
        const glm::vec4 gale(0, 0, 1e4f, 1e4f);
        const glm::dquat still = reference::quaternion_of(l.orientation);
        dvec3 before(0);
        double widest = 0;
        for (int step = 0; step <= 480; ++step) {
            kernel.time = kernels::flutter_time(step / 240.0);
            const vertices v = ring_of(kernel, l, rest, gale);
            const dvec3 tip = glm::normalize(dvec3(v[9].position) - dvec3(v[0].position));
            const dvec3 normal = glm::normalize(dvec3(v[2].normal) + dvec3(v[7].normal));
            const dvec3 upright = still * dvec3(0, 0, 1);
            const double turned =
                std::acos(std::clamp(glm::dot(normal, glm::normalize(upright)), -1.0, 1.0));
            EXPECT_LE(turned, 2 * std::atan(most) + 1e-3);
            widest = std::max(widest, turned);
            if (step > 0) {
                EXPECT_LE(glm::distance(tip, before), 2 * 0.105 * most + 1e-3);
            }
            before = tip;
        }
        EXPECT_GT(widest, 0.3); // it does move
        kernel.time = kernels::flutter_time(7.5);
        const vertices now = ring_of(kernel, l, rest, gale);
        kernel.time = kernels::flutter_time(7.5 + 1e6 * kernels::flutter_period);
        const vertices later = ring_of(kernel, l, rest, gale);
        EXPECT_EQ(std::memcmp(&now, &later, sizeof now), 0);
    }
}

TEST(leaf_blade, times_of_all_kinds_are_phases) {
    EXPECT_EQ(kernels::flutter_time(0), 0u);
    EXPECT_EQ(kernels::flutter_time(32), 0x80000000u);
    EXPECT_EQ(kernels::flutter_time(64), 0u);
    EXPECT_EQ(kernels::flutter_time(-16), 0xc0000000u);
    EXPECT_EQ(kernels::flutter_time(-1e-30), 0u); // rounds to a whole period
    EXPECT_EQ(kernels::flutter_time(std::numeric_limits<double>::infinity()), 0u);
    EXPECT_EQ(kernels::flutter_time(std::numeric_limits<double>::quiet_NaN()), 0u);
}

TEST(leaf_blade, leans_with_the_wind_and_more_in_more_of_it) {
    leaf l;
    l.length = l.width = 1;
    leaf_blade kernel;
    kernel.flutter = 0;
    double before = 0;
    for (const float speed : {2.0f, 5.0f, 10.0f, 20.0f}) {
        const vertices v = ring_of(kernel, l, rest, {speed, 0, 0, speed});
        const dvec3 tip = dvec3(v[9].position);
        const double k = 0.6 * speed * speed / (speed * speed + 100);
        EXPECT_NEAR(std::atan2(tip.x, tip.y), 2 * std::atan(k), 1e-6);
        EXPECT_GT(tip.x, before);
        before = tip.x;
    }
}

// The mean of the drawn area over many leaves. One leaf's area over its full one is 0 or up to
// 1 / mean; its variance is at most 1 / mean, so that n leaves are off by 5 standard errors
// sqrt(1 / (mean n)) with a chance below 1e-6.
TEST(leaf_blade, thinning_keeps_the_area_in_expectation) {
    support::random_source random(7);
    constexpr std::uint32_t n = 40'000;
    for (const float pixels : {2.9f, 2.5f, 2.0f, 1.0f, 0.5f, 0.2f}) {
        leaf l;
        l.length = l.width = 0.1f;
        leaf_blade kernel;
        kernel.camera = {0, 0, 10, pixels * 100};
        double sum = 0;
        std::uint32_t kept = 0;
        for (std::uint32_t i = 0; i < n; ++i) {
            l.seed = i;
            const auto d = kernel.detail(l, l.position);
            sum += double{d.scale} * d.scale;
            kept += d.scale > 0 ? 1 : 0;
        }
        const double nu = 2 * std::pow(pixels / 3.0, 2);
        const double mean = reference::mean_leaf_part(nu);
        EXPECT_NEAR(sum / n, 1, 5 * std::sqrt(1 / (mean * n))) << pixels;
        // Those of a rank below nu are left.
        EXPECT_NEAR(kept / double{n}, std::min(nu, 1.0), 5 * std::sqrt(0.25 / n)) << pixels;
    }
}

// As the eye moves back by a part h of the distance, nu falls by 2 h of itself; a leaf's area is
// part(nu) / mean(nu) of the full one, part's slope is at most 2 / nu and mean's logarithm's at
// most 1 / nu: the area changes by at most (2 · 2 + 2) h / mean.
TEST(leaf_blade, nothing_pops_as_the_eye_moves) {
    constexpr double h = 1e-3;
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
        leaf l;
        l.length = l.width = 0.1f;
        l.seed = seed * 7919;
        leaf_blade kernel;
        double before = -1;
        for (double distance = 5; distance < 2000; distance *= 1 + h) {
            kernel.camera = {0, 0, static_cast<float>(distance), 800};
            const double now = area(ring_of(kernel, l)) / (0.01 / std::sqrt(2.0));
            const double nu = std::max(2 * std::pow(80 / distance / 3, 2), 1.0 / 2048);
            const double bound = 6 * h / reference::mean_leaf_part(nu);
            if (before >= 0) {
                ASSERT_LE(std::abs(now - before), 1.05 * bound + 1e-5) << distance << ' ' << seed;
            }
            before = now;
        }
    }
}

TEST(leaf_blade, is_full_when_near_and_when_detail_is_off) {
    support::random_source random(8);
    for (int i = 0; i < 100; ++i) {
        leaf l = random_leaf(random);
        leaf_blade near;
        near.camera = {0, 0, 0, 1e6f};
        const vertices a = ring_of({}, l);
        const vertices b = ring_of(near, l);
        EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0);
    }
}

// The octagon's corners sink into a quadrilateral of the same area.
TEST(leaf_blade, quadrilateral_has_the_same_area) {
    leaf l;
    l.length = l.width = 0.1f;
    leaf_blade kernel;
    kernel.full = 1e-3f; // none are dropped
    for (const float pixels : {8.0f, 7.0f, 6.0f, 5.0f, 4.1f, 4.0f, 1.0f}) {
        kernel.camera = {0, 0, 10, pixels * 100};
        const vertices v = ring_of(kernel, l);
        EXPECT_NEAR(area(v), 0.01 / std::sqrt(2.0), 1e-8) << pixels;
        if (pixels <= 4) { // corner 1 lies between 0 and 2
            const dvec3 middle = (dvec3(v[0].position) + dvec3(v[2].position)) * 0.5;
            EXPECT_LE(glm::distance(middle, dvec3(v[1].position)), 1e-7);
        }
    }
}

// The CPU's four leaves at a time have the plain kernel's bits, for any number and any settings.
TEST(leaf_blade, four_at_a_time_are_the_same_bits) {
    support::random_source random(9);
    cpu::device device;
    for (const std::uint32_t count : {0u, 1u, 3u, 4u, 5u, 67u, 1000u}) {
        std::vector<leaf> leaves;
        std::vector<segment_pose> poses;
        std::vector<glm::vec4> air;
        for (std::uint32_t i = 0; i < 50; ++i) {
            poses.push_back(i == 0 ? rest : random_pose(random));
            air.push_back(i < 3 ? calm : random_air(random));
        }
        for (std::uint32_t i = 0; i < count; ++i) {
            leaves.push_back(random_leaf(random));
            leaves.back().carrier = random.below(50);
            if (i % 9 == 0) {
                leaves.back().fold = 0;
            }
        }
        for (int setting = 0; setting < 4; ++setting) {
            leaf_blade kernel;
            kernel.time = random.below(0xffffffffu);
            kernel.camera = {0, 1, 2, setting % 2 == 0 ? 0.0f : 300.0f};
            kernel.pose_step = kernel.air_step = setting < 2 ? 1 : 0;
            std::vector<surface_vertex> plain;
            for (std::uint32_t i = 0; i < count; ++i) {
                kernel.ring(
                    i, 0, 10, [&](const surface_vertex& v) { plain.push_back(v); },
                    std::span<const leaf>(leaves), std::span<const segment_pose>(poses),
                    std::span<const glm::vec4>(air));
            }
            const auto l = *make_buffer<cpu::device, leaf>(device, leaves);
            const auto p = *make_buffer<cpu::device, segment_pose>(device, poses);
            const auto a = *make_buffer<cpu::device, glm::vec4>(device, air);
            const auto out = *device.create_buffer(plain.size() * sizeof(surface_vertex));
            ASSERT_TRUE(run(device, [&](auto& r) {
                r.expand_rings(kernel,
                               {view<cpu::device>(l), view<cpu::device>(p), view<cpu::device>(a)},
                               range{0, count}, view<cpu::device>(out));
            }));
            std::vector<surface_vertex> made(plain.size());
            ASSERT_TRUE((read_back<cpu::device, surface_vertex>(device, out, std::span(made))));
            for (std::size_t i = 0; i < made.size(); ++i) {
                ASSERT_EQ(std::memcmp(&made[i], &plain[i], sizeof plain[i]), 0)
                    << count << " leaves, setting " << setting << ", vertex " << i;
            }
        }
    }
}
