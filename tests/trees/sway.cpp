// Sway against closed forms, energy, and one backend against the other.
//
// Beams: E, I and rho A uniform, length L, clamped at the root. A load acts at the middle of its
// segment, so a beam that is to be loaded at its tip ends with a segment without length.

#include "support/allocations.hpp"
#include "support/devices.hpp"
#include "support/random.hpp"
#include "support/test_trees.hpp"

#include <skybark/core/validated.hpp>
#include <skybark/trees/sway.hpp>

#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>

using namespace skybark;
using glm::dquat;
using glm::dvec3;
using trees::joint_motion;
using trees::sway_model;
using trees::sway_options;

namespace {

constexpr double pi = 3.14159265358979323846;
using cpu_sway = trees::sway<cpu::device>;

template <class T>
T expect_value(result<T> r) {
    if (!r) {
        throw std::runtime_error(r.error().message);
    }
    return *std::move(r);
}
void expect_done(const result<void>& done) { ASSERT_TRUE(done) << done.error().message; }

/// A beam from the origin in N segments, and a segment without length at its tip.
struct beam {
    std::uint32_t segments = 16;
    double length = 2;
    double base_radius = 0.02;
    double tip_radius = 0.02;
    dvec3 direction{0, 1, 0};
    double elasticity = 1e10;
    double density = 800;

    [[nodiscard]] double radius_at(double t) const {
        return base_radius + (tip_radius - base_radius) * t;
    }
    [[nodiscard]] trees::skeleton skeleton() const {
        std::vector<trees::segment> parts;
        const auto at = [&](double t) { return glm::vec3(direction * (length * t)); };
        for (std::uint32_t i = 0; i < segments; ++i) {
            const double t0 = double(i) / segments, t1 = double(i + 1) / segments;
            parts.push_back({at(t0), at(t1), static_cast<float>(radius_at(t0)),
                             static_cast<float>(radius_at(t1)), i == 0 ? trees::none : i - 1});
        }
        const auto thin = static_cast<float>(tip_radius);
        parts.push_back({at(1), at(1), thin, thin, segments - 1});
        return support::built(parts);
    }
    [[nodiscard]] trees::wood material(double damping_ratio = 0) const {
        return {elasticity, density, damping_ratio};
    }
    [[nodiscard]] double bending_stiffness() const { // E I of a uniform one
        return elasticity * pi / 4 * std::pow(base_radius, 4);
    }
    [[nodiscard]] double mass_per_length() const {
        return density * pi * base_radius * base_radius;
    }
};

/// A sway on the CPU with loads that stay where they are put.
class swaying {
  public:
    swaying(const trees::skeleton& of, sway_options options, std::span<const float> leaves = {},
            std::uint32_t threads = 1)
        : device_([&] {
              cpu::device_options o;
              o.threads = threads;
              return o;
          }()),
          skeleton_(of), sway_(expect_value(cpu_sway::create(device_, of, options, leaves))),
          loads_(expect_value(device_.create_buffer(of.size() * sizeof(segment_load)))) {}

    void load(std::size_t segment, const dvec3& force, double drag = 0) {
        const segment_load l{glm::vec3(force), static_cast<float>(drag)};
        expect_done(device_.upload(loads_, segment * sizeof l, std::as_bytes(std::span(&l, 1))));
    }
    void frame(double step) {
        expect_done(run(device_, [&](auto& r) {
            sway_.record(r, view<cpu::device>(loads_), static_cast<float>(step));
        }));
    }
    [[nodiscard]] std::vector<segment_pose> poses() {
        std::vector<segment_pose> poses(sway_.size());
        expect_done(
            read_back<cpu::device, segment_pose>(device_, *sway_.poses().buffer, std::span(poses)));
        return poses;
    }
    [[nodiscard]] std::vector<glm::vec4> velocities() {
        std::vector<glm::vec4> v(sway_.size());
        expect_done(
            read_back<cpu::device, glm::vec4>(device_, *sway_.velocities().buffer, std::span(v)));
        return v;
    }
    /// Where the base of the last segment is.
    [[nodiscard]] dvec3 tip() {
        const segment_pose pose = poses().back();
        return dvec3(pose.base) + dvec3(pose.shift);
    }
    [[nodiscard]] dquat tip_rotation() {
        const glm::dvec4 q = poses().back().rotation;
        return {q.w, q.x, q.y, q.z};
    }
    [[nodiscard]] std::vector<joint_motion> motions() {
        return expect_value(sway_.download(device_));
    }
    void put(std::span<const joint_motion> motions) { expect_done(sway_.upload(device_, motions)); }
    [[nodiscard]] cpu_sway& operator*() { return sway_; }
    [[nodiscard]] cpu_sway* operator->() { return &sway_; }
    [[nodiscard]] cpu::device& device() { return device_; }
    [[nodiscard]] const trees::skeleton& skeleton() const { return skeleton_; }

  private:
    cpu::device device_;
    trees::skeleton skeleton_;
    cpu_sway sway_;
    cpu::buffer loads_;
};

dquat rotation_of(const dvec3& bend) {
    const double angle = glm::length(bend);
    return angle > 0 ? glm::angleAxis(angle, bend / angle) : dquat(1, 0, 0, 0);
}

/// Energy in double precision: springs, and rigid rods that turn and fly.
struct energy {
    double kinetic = 0;
    double elastic = 0;
    [[nodiscard]] double sum() const { return kinetic + elastic; }
};
energy energy_of(const trees::skeleton& tree, const std::vector<shared::sway_joint>& joints,
                 std::span<const joint_motion> motions) {
    struct body {
        dquat rotation{1, 0, 0, 0};
        dvec3 turn{0}, speed{0};
    };
    std::vector<body> bodies(tree.size());
    energy e;
    for (std::size_t i = 0; i < tree.size(); ++i) {
        const shared::sway_joint& joint = joints[i];
        const body before = tree.parent[i] == trees::none ? body{} : bodies[tree.parent[i]];
        body& b = bodies[i];
        const dvec3 bend(motions[i].bend);
        b.rotation = before.rotation * rotation_of(bend);
        b.turn = before.turn + before.rotation * dvec3(motions[i].rate);
        b.speed = before.speed + glm::cross(before.turn, before.rotation * dvec3(joint.offset));
        const dvec3 axis = b.rotation * dvec3(joint.axis);
        const double mass = double{joint.mass};
        const double arm = mass > 0 ? double{joint.lever} / mass : 0;
        // König: the centre's motion, and the turn about it.
        const dvec3 centre = b.speed + glm::cross(b.turn, axis * arm);
        const double spin = glm::dot(axis, b.turn);
        const double across = double{joint.across} - mass * arm * arm;
        e.kinetic += mass / 2 * glm::dot(centre, centre) +
                     across / 2 * (glm::dot(b.turn, b.turn) - spin * spin) +
                     double{joint.along} / 2 * spin * spin;
        e.elastic += double{joint.stiffness} / 2 * glm::dot(bend, bend);
    }
    return e;
}

} // namespace

namespace {

sway_options with(const trees::wood& material, sway_model model = sway_model::dynamic,
                  std::uint32_t iterations = 8) {
    return {model, material, iterations};
}

/// A beam at rest under a dead load at its tip, P = alpha E I / L².
swaying loaded(const beam& b, sway_model model, double alpha) {
    swaying s(b.skeleton(), with(b.material(model == sway_model::dynamic ? 0.7 : 0), model));
    s.load(b.segments, {alpha * b.bending_stiffness() / (b.length * b.length), 0, 0});
    // Some fifteen periods of the first mode, damped by 0.7 of critical.
    const double period = 2 * pi / (*s).trees()[0].frequency;
    for (int i = 0; i < (model == sway_model::dynamic ? 300 : 3); ++i) {
        s.frame(period / 20);
    }
    return s;
}

/// x'' = −alpha cos x (x the angle from the rest direction, over the arc length 0 … 1), x(0) = 0,
/// x'(1) = 0: Euler's elastica, by shooting for x'(0) with classical Runge–Kutta steps.
struct elastica {
    double across, shortened, angle;
};
elastica shoot(double alpha) {
    const auto run = [&](double slope) {
        constexpr int steps = 4000;
        const double h = 1.0 / steps;
        double x = 0, v = slope, across = 0, ahead = 0;
        for (int i = 0; i < steps; ++i) {
            const double v1 = v, a1 = -alpha * std::cos(x);
            const double v2 = v + h / 2 * a1, a2 = -alpha * std::cos(x + h / 2 * v1);
            const double v3 = v + h / 2 * a2, a3 = -alpha * std::cos(x + h / 2 * v2);
            const double v4 = v + h * a3, a4 = -alpha * std::cos(x + h * v3);
            const double next = x + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
            const double middle = x + h / 2 * v2;
            across += h / 6 * (std::sin(x) + 4 * std::sin(middle) + std::sin(next));
            ahead += h / 6 * (std::cos(x) + 4 * std::cos(middle) + std::cos(next));
            x = next;
            v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
        }
        return std::array<double, 4>{v, across, 1 - ahead, x};
    };
    double low = 0, high = alpha;
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (run(middle)[0] < 0 ? low : high) = middle;
    }
    const auto end = run(low);
    return {end[1], end[2], end[3]};
}

void expect_elastica(sway_model model, double alpha, const elastica& e) {
    beam b;
    b.segments = 32;
    auto s = loaded(b, model, alpha);
    const dvec3 tip = s.tip() / b.length;
    EXPECT_NEAR(tip.x, e.across, 5e-4) << alpha;
    EXPECT_NEAR(1 - tip.y, e.shortened, 5e-4) << alpha;
    EXPECT_NEAR(tip.z, 0, 1e-6) << alpha;
    EXPECT_NEAR(2 * std::acos(std::abs(s.tip_rotation().w)), e.angle, 1e-3) << alpha;
}

/// The curvature of a uniform cantilever in mode 1 or 2, over x / L; any scale.
double mode_curvature(int mode, double x) {
    const double beta = mode == 1 ? 1.8751040687 : 4.6940911330;
    const double sigma = mode == 1 ? 0.7340955138 : 1.0184673193;
    return std::cosh(beta * x) + std::cos(beta * x) -
           sigma * (std::sinh(beta * x) + std::sin(beta * x));
}

/// Bends in the shape of a mode, towards −x, that move the tip by about `amplitude` L. Without a
/// segment at the tip: its least mass would be one part in a thousand of the first mode's.
std::vector<joint_motion> mode_shape(std::size_t n, int mode, double amplitude) {
    std::vector<joint_motion> motions(n);
    double tip = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const double at = static_cast<double>(i) / static_cast<double>(n);
        const double bend = mode_curvature(mode, at) * (i == 0 ? 0.5 : 1);
        motions[i].bend.z = static_cast<float>(bend);
        tip += bend * (1 - at);
    }
    for (joint_motion& m : motions) {
        m.bend.z *= static_cast<float>(amplitude / tip);
    }
    return motions;
}

trees::skeleton bare(const beam& b) { // no segment at the tip
    std::vector<trees::segment> parts;
    for (std::uint32_t i = 0; i < b.segments; ++i) {
        const double t0 = double(i) / b.segments, t1 = double(i + 1) / b.segments;
        parts.push_back({glm::vec3(b.direction * (b.length * t0)),
                         glm::vec3(b.direction * (b.length * t1)),
                         static_cast<float>(b.radius_at(t0)), static_cast<float>(b.radius_at(t1)),
                         i == 0 ? trees::none : i - 1});
    }
    return support::built(parts);
}

/// How the angle of the last segment swings: the times when it passes zero, and its extremes.
struct swing {
    std::vector<double> zeros;
    std::vector<double> extremes; ///< the largest |angle| between two zeros
};
swing watch(swaying& s, double step, int frames) {
    swing w;
    const auto angle = [&] {
        const dquat q = s.tip_rotation();
        return 2 * std::atan2(q.z, q.w);
    };
    double before = angle(), most = std::abs(before);
    for (int i = 1; i <= frames; ++i) {
        s.frame(step);
        const double now = angle();
        if ((before < 0) != (now < 0)) {
            w.zeros.push_back(step * (i - now / (now - before)));
            w.extremes.push_back(most);
            most = 0;
        }
        most = std::max(most, std::abs(now));
        before = now;
    }
    return w;
}
/// rad/s
double frequency_of(const swing& w) {
    return pi * static_cast<double>(w.zeros.size() - 1) / (w.zeros.back() - w.zeros.front());
}
double beam_frequency(const beam& b, double eigenvalue) {
    return eigenvalue * std::sqrt(b.bending_stiffness() / b.mass_per_length()) /
           (b.length * b.length);
}

std::vector<joint_motion> random_motions(std::size_t n, std::uint32_t seed, double bend,
                                         double rate) {
    support::random_source random(seed);
    std::vector<joint_motion> motions(n);
    for (joint_motion& m : motions) {
        m.bend = glm::vec3(random.direction() * random.between(0, bend));
        m.rate = glm::vec3(random.direction() * random.between(0, rate));
    }
    return motions;
}

} // namespace

// ---- What bends ---------------------------------------------------------------------------------

TEST(sway, cantilever_is_off_by_half_the_square_of_the_segments) {
    for (const sway_model model : {sway_model::quasi_static, sway_model::dynamic}) {
        for (const std::uint32_t n : {8u, 16u, 32u}) {
            beam b;
            b.segments = n;
            constexpr double alpha = 1e-2; // and the elastica is off the line by alpha²/40
            auto s = loaded(b, model, alpha);
            const double ratio = s.tip().x / (alpha * b.length / 3);
            EXPECT_NEAR(ratio, 1, 1 / (2.0 * n * n) + 1e-5) << n;
            EXPECT_GT(std::abs(ratio - 1), 1 / (2.2 * n * n)) << n; // off by 1 / 2n²
        }
    }
}

TEST(sway, tapered_cantilever) {
    // E v'' = M / I with I = pi r⁴/4, r from 2 r1 to r1: v(L) = P L³ / (3 E I0) · r0 / r1.
    beam b;
    b.base_radius = 0.02;
    b.tip_radius = 0.01;
    for (const std::uint32_t n : {16u, 32u, 64u}) {
        b.segments = n;
        auto s = loaded(b, sway_model::quasi_static, 1e-3);
        const double expected = 1e-3 * b.length / 3 * b.base_radius / b.tip_radius;
        EXPECT_NEAR(s.tip().x / expected, 1, 1.2 / (n * n) + 1e-5) << n;
    }
}

TEST(sway, any_direction_bends_alike) {
    const double alpha = 2;
    beam upright;
    const dvec3 expected = loaded(upright, sway_model::quasi_static, alpha).tip();
    support::random_source random(3);
    for (int i = 0; i < 8; ++i) {
        beam b;
        b.direction = random.direction();
        const dvec3 across =
            glm::normalize(glm::cross(b.direction, random.direction() + dvec3(0.1, 0, 0)));
        swaying s(b.skeleton(), with(b.material(), sway_model::quasi_static));
        s.load(b.segments, across * (alpha * b.bending_stiffness() / (b.length * b.length)));
        s.frame(1);
        s.frame(1);
        const dvec3 tip = s.tip();
        EXPECT_NEAR(glm::dot(tip, across), expected.x, 1e-5);
        EXPECT_NEAR(glm::dot(tip, b.direction), expected.y, 1e-5);
    }
}

TEST(sway, large_bends_follow_the_elastica) {
    // Published values (Bisshopp and Drucker 1945; Mattiasson 1981), and our own by shooting.
    const elastica one = shoot(1), five = shoot(5);
    EXPECT_NEAR(one.across, 0.30172, 1e-5);
    EXPECT_NEAR(one.shortened, 0.05643, 1e-5);
    EXPECT_NEAR(one.angle, 0.46135, 1e-5);
    EXPECT_NEAR(five.across, 0.71379, 1e-5);
    EXPECT_NEAR(five.shortened, 0.38763, 1e-5);
    EXPECT_NEAR(five.angle, 1.21537, 1e-5);
    for (const sway_model model : {sway_model::quasi_static, sway_model::dynamic}) {
        expect_elastica(model, 1, one);
        expect_elastica(model, 5, five);
        expect_elastica(model, 10, shoot(10));
    }
}

TEST(sway, quasi_static_finds_its_way_whatever_the_load) {
    for (const double alpha : {0.1, 3.0, 30.0, 300.0}) {
        beam b;
        b.segments = 32;
        swaying s(b.skeleton(), with(b.material(), sway_model::quasi_static, 16));
        // Against the growth as well: it buckles and turns over, or stays; never NaN.
        s.load(b.segments,
               dvec3(1e-3, -1, 0) * (alpha * b.bending_stiffness() / (b.length * b.length)));
        for (int i = 0; i < 20; ++i) {
            s.frame(1);
        }
        const dvec3 before = s.tip();
        s.frame(1);
        EXPECT_LT(glm::distance(before, s.tip()), 1e-4 * b.length) << alpha;
        EXPECT_LT(s.tip().y, alpha > 2.5 ? b.length * 0.9 : b.length + 1e-5)
            << alpha; // Euler: 2.47
    }
}

TEST(sway, the_papers_forces_do_not_converge) {
    // docs/sway.md has this table. Turning by the force alone, the k-th of N joints moves the tip
    // by a lever of (N − k) L / N: (N + 1) / (2 N²) of the true bend in all.
    for (const std::uint32_t n : {1u, 2u, 4u, 8u, 16u, 32u, 64u}) {
        beam b;
        b.segments = n;
        auto s = loaded(b, sway_model::paper, 1e-3);
        const double ratio = s.tip().x / (1e-3 * b.length / 3);
        EXPECT_NEAR(ratio, (n + 1.0) / (2.0 * n * n), 1e-4) << n;
        auto right = loaded(b, sway_model::quasi_static, 1e-3);
        const double other = right.tip().x / (1e-3 * b.length / 3);
        EXPECT_NEAR(other, 1 + 1 / (2.0 * n * n), 1e-4) << n;
        std::printf("| %u | %.4f | %.4f |\n", n, ratio, other);
    }
}

// ---- What swings --------------------------------------------------------------------------------

TEST(sway, first_and_second_frequency_of_a_beam) {
    const beam b;
    for (const int mode : {1, 2}) {
        const double expected = beam_frequency(b, mode == 1 ? 3.5160152685 : 22.0344915647);
        swaying s(bare(b), with(b.material()));
        s.put(mode_shape(b.segments, mode, 1e-4));
        // 200 steps a period lengthen it by (2 pi / 200)² / 12 = 8e-5.
        const double found = frequency_of(watch(s, 2 * pi / expected / 200, 200 * 20));
        EXPECT_NEAR(found / expected, 1, mode == 1 ? 3e-3 : 2e-2) << mode;
        if (mode == 1) {
            EXPECT_NEAR((*s).trees()[0].frequency / expected, 1, 3e-3);
        }
    }
}

TEST(sway, frequency_of_a_cone) {
    // 8.7192 sqrt(E I0 / rho A0) / L² for a cone (Conway, Becker and Dubil 1964). The tip is cut
    // off at half a millimetre, the least radius of wood.
    beam b;
    b.length = 5;
    b.base_radius = 0.1;
    b.tip_radius = 0;
    b.segments = 64;
    const double expected = beam_frequency(b, 8.7192);
    swaying s(bare(b), with(b.material()));
    EXPECT_NEAR((*s).trees()[0].frequency / expected, 1, 5e-3);
}

TEST(sway, swings_at_the_frequency_that_create_found) {
    beam b;
    b.tip_radius = 0.01;
    swaying s(bare(b), with(b.material(0.02))); // higher modes are soon gone
    const double expected = s->trees()[0].frequency;
    s.put(mode_shape(b.segments, 1, 1e-3));
    swing w = watch(s, 2 * pi / expected / 200, 200 * 20);
    w.zeros.erase(w.zeros.begin(), w.zeros.begin() + 10);
    EXPECT_NEAR(frequency_of(w) / expected, std::sqrt(1 - 0.02 * 0.02), 1e-3);
}

TEST(sway, leaves_slow_a_tree_down) {
    // Leaves as heavy as the wood, spread like it: the frequency falls by sqrt 2.
    const beam b;
    const trees::skeleton tree = bare(b);
    const std::vector<float> leaves(
        tree.size(), static_cast<float>(b.mass_per_length() * b.length / b.segments));
    const double bare_one = swaying(tree, with(b.material()))->trees()[0].frequency;
    const double leafy = swaying(tree, with(b.material()), leaves)->trees()[0].frequency;
    EXPECT_NEAR(bare_one / leafy, std::sqrt(2.0), 1e-4);
}

TEST(sway, each_tree_of_a_stand_has_its_own_frequency) {
    std::vector<trees::segment> parts;
    for (const double length : {1.0, 2.0}) {
        const auto first = static_cast<std::uint32_t>(parts.size());
        for (std::uint32_t i = 0; i < 16; ++i) {
            const auto at = [&](std::uint32_t k) {
                return glm::vec3(length * 10, length * k / 16, 0);
            };
            parts.push_back({at(i), at(i + 1), 0.02f, 0.02f, i == 0 ? trees::none : first + i - 1});
        }
    }
    const auto layout = trees::layout_sway(support::built(parts), {});
    ASSERT_EQ(layout.trees.size(), 2u);
    EXPECT_NEAR(layout.trees[0].frequency / layout.trees[1].frequency, 4, 2e-2);
}

TEST(sway, decay_is_the_damping_ratios) {
    // Amplitude falls by exp(−pi z / sqrt(1 − z²)) from one extreme to the next.
    beam b;
    b.length = 4;
    b.base_radius = b.tip_radius = 0.03; // 1.9 Hz: 32 frames a period
    for (const double ratio : {0.01, 0.03, 0.08}) {
        swaying s(bare(b), with(b.material(ratio)));
        s.put(mode_shape(b.segments, 1, 1e-3));
        const double expected = beam_frequency(b, 3.5160152685);
        for (const double step : {1 / 60.0, 2 * pi / expected / 400}) {
            s.put(mode_shape(b.segments, 1, 1e-3));
            const swing w = watch(s, step, static_cast<int>(8 * 2 * pi / expected / step));
            ASSERT_GE(w.extremes.size(), 12u);
            const double fell = std::log(w.extremes[1] / w.extremes[11]) / 10;
            // A frame's raster may miss an extreme by 1 − cos(pi / 32) = 0.5 % of it, which is 0.05
            // % a half period over ten of them.
            EXPECT_NEAR(fell, pi * ratio / std::sqrt(1 - ratio * ratio), 0.02 * pi * ratio + 5e-4)
                << ratio << ' ' << step;
        }
    }
}

TEST(sway, drag_damps_without_a_limit_of_the_step) {
    // One stiff rod: J a'' + D (L/2)² a' + k a = 0.
    beam b;
    b.segments = 1;
    swaying s(bare(b), with(b.material()));
    s.load(0, {}, 2.0);
    s.put(mode_shape(1, 1, 1e-3));
    const auto joint = trees::layout_sway(s.skeleton(), b.material()).joints[0];
    const double frequency = std::sqrt(double{joint.stiffness} / double{joint.across});
    const double decay = 2.0 * b.length * b.length / 4 / (2 * double{joint.across});
    const swing w = watch(s, 2 * pi / frequency / 200, 200 * 4);
    ASSERT_GE(w.extremes.size(), 7u);
    EXPECT_NEAR(std::log(w.extremes[1] / w.extremes[6]) / 5,
                pi * decay / std::sqrt(frequency * frequency - decay * decay),
                0.03 * pi * decay / frequency);
    // And a gale of it: everything stands still, nothing explodes.
    s.load(0, {}, 1e9);
    for (int i = 0; i < 100; ++i) {
        s.frame(0.5);
    }
    EXPECT_LE(std::abs(s.motions()[0].rate.z), 1e-3);
}

// ---- Energy -------------------------------------------------------------------------------------

TEST(sway, free_vibration_keeps_its_energy) {
    beam b;
    swaying s(bare(b), with(b.material()));
    const auto joints = trees::layout_sway(s.skeleton(), b.material()).joints;
    auto shape = mode_shape(b.segments, 1, 0.04);
    const auto second = mode_shape(b.segments, 2, 0.005);
    for (std::size_t i = 0; i < shape.size(); ++i) {
        shape[i].bend.x = second[i].bend.z; // out of the plane too
    }
    s.put(shape);
    const double start = energy_of(s.skeleton(), joints, s.motions()).sum();
    double least = start, most = start;
    for (int i = 0; i < 100'000; ++i) {
        s.frame(1 / 60.0);
        if (i % 97 == 0) {
            const double now = energy_of(s.skeleton(), joints, s.motions()).sum();
            least = std::min(least, now);
            most = std::max(most, now);
        }
    }
    EXPECT_GT(least / start, 0.99);
    EXPECT_LT(most / start, 1.00001); // single precision's rounding of the state
    RecordProperty("least", std::to_string(least / start));
}

TEST(sway, energy_never_exceeds_the_start_and_the_work) {
    const auto aspen = trees::grow(trees::quaking_aspen(), 1);
    ASSERT_TRUE(aspen);
    const support::test_tree all[] = {support::scanned_tree(), {"aspen", support::built(*aspen)}};
    for (const support::test_tree& tree : all) {
        for (const double ratio : {0.0, 0.03}) {
            swaying s(tree.skeleton, with({9.5e9, 800, ratio}));
            const auto joints = trees::layout_sway(tree.skeleton, {9.5e9, 800, ratio}).joints;
            for (const double step : {1 / 600.0, 1 / 60.0, 0.2, 1.0}) {
                for (const double bend : {pi, 0.0}) {
                    s.put(random_motions(tree.skeleton.size(), 5, bend, 10));
                    const double start = energy_of(tree.skeleton, joints, s.motions()).sum();
                    for (int i = 0; i < 20; ++i) {
                        s.frame(step);
                        const double now = energy_of(tree.skeleton, joints, s.motions()).sum();
                        // Rates of many joints cancel in the velocity of a tip: rounding them to
                        // single precision moves the energy by up to some thousandths.
                        ASSERT_LE(now, start * 1.005)
                            << tree.name << ' ' << ratio << ' ' << step << ' ' << bend << ' ' << i;
                    }
                }
            }
        }
    }
}

TEST(sway, energy_never_exceeds_the_work_of_gusts) {
    const support::test_tree tree = support::scanned_tree();
    support::random_source random(11);
    for (const double ratio : {0.0, 0.03}) {
        for (const double step : {1 / 60.0, 1.0}) {
            swaying s(tree.skeleton, with({9.5e9, 800, ratio}));
            const auto joints = trees::layout_sway(tree.skeleton, {9.5e9, 800, ratio}).joints;
            std::vector<dvec3> loads(tree.skeleton.size());
            double work = 0, gross = 0;
            for (int i = 0; i < 100; ++i) {
                if (i % 10 == 0) {
                    for (std::size_t k = 0; k < loads.size(); ++k) {
                        loads[k] = glm::dvec3(glm::vec3(random.direction() * 2.0));
                        s.load(k, loads[k], 0.05);
                    }
                }
                s.frame(step);
                const auto velocities = s.velocities();
                for (std::size_t k = 0; k < loads.size(); ++k) {
                    const double power = glm::dot(loads[k], dvec3(velocities[k]));
                    work += power * step;
                    gross += std::abs(power * step);
                }
                const double now = energy_of(tree.skeleton, joints, s.motions()).sum();
                ASSERT_LE(now, work + 1e-4 * gross) << ratio << ' ' << step << ' ' << i;
            }
        }
    }
}

TEST(sway, nothing_makes_it_nan) {
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
        const support::test_tree tree = support::wild_scan(seed);
        for (const double ratio : {0.0, 0.03}) {
            swaying s(tree.skeleton, with({9.5e9, 800, ratio}));
            for (const double step : {1 / 600.0, 1 / 60.0, 0.1, 1.0}) {
                s.put(random_motions(tree.skeleton.size(), seed, pi, 10));
                for (std::size_t k = 0; k < tree.skeleton.size(); k += 7) {
                    s.load(k, {0, -1e4, 1e3}, k % 2 == 0 ? 0 : 1e3);
                }
                for (int i = 0; i < 100; ++i) {
                    s.frame(step);
                }
                for (const segment_pose& pose : s.poses()) {
                    ASSERT_TRUE(std::isfinite(pose.shift.x + pose.shift.y + pose.shift.z))
                        << seed << ' ' << ratio << ' ' << step;
                    ASSERT_NEAR(glm::length(pose.rotation), 1, 1e-5);
                }
            }
        }
    }
}

// ---- State --------------------------------------------------------------------------------------

TEST(sway, rest_is_exactly_rest) {
    const support::test_tree tree = support::scanned_tree();
    for (const sway_model model :
         {sway_model::paper, sway_model::quasi_static, sway_model::dynamic}) {
        swaying s(tree.skeleton, with({}, model));
        const auto at_rest = [&] {
            const auto poses = s.poses();
            for (std::size_t i = 0; i < poses.size(); ++i) {
                ASSERT_EQ(poses[i].rotation, glm::vec4(0, 0, 0, 1)) << i;
                ASSERT_EQ(poses[i].shift, glm::vec3(0)) << i;
                ASSERT_EQ(poses[i].base, tree.skeleton.position[i]) << i;
            }
        };
        at_rest(); // before the first frame too
        s.frame(1 / 60.0);
        at_rest();
        s.load(tree.skeleton.size() - 1, {3, 0, 0});
        s.frame(1 / 60.0);
        EXPECT_NE(s.poses().back().shift, glm::vec3(0));
        const auto before = s.poses();
        s.frame(0); // no time passes
        EXPECT_EQ(before.back().shift, s.poses().back().shift);
        expect_done((*s).reset(s.device()));
        at_rest();
    }
}

TEST(sway, resumes_where_it_was_saved) {
    const support::test_tree tree = support::scanned_tree();
    swaying a(tree.skeleton, {});
    swaying b(tree.skeleton, {});
    const std::size_t n = tree.skeleton.size();
    for (std::size_t k = 0; k < n; k += 3) {
        a.load(k, {1, 0, 0.5}, 0.02);
        b.load(k, {1, 0, 0.5}, 0.02);
    }
    for (int i = 0; i < 50; ++i) {
        a.frame(1 / 60.0);
    }
    b.put(a.motions());
    const double height = double{trees::height(tree.skeleton)};
    for (int i = 0; i < 50; ++i) {
        const auto pa = a.poses(), pb = b.poses();
        for (std::size_t k = 0; k < n; ++k) {
            ASSERT_LE(glm::distance(pa[k].shift, pb[k].shift), 1e-5 * height) << i << ' ' << k;
        }
        a.frame(1 / 60.0);
        b.frame(1 / 60.0);
    }
}

TEST(sway, any_number_of_threads_gives_the_same_bits) {
    std::vector<trees::segment> stand; // levels wide enough to be cut among threads
    for (std::uint32_t i = 0; i < 9000; ++i) {
        const bool root = i % 3 == 0;
        const glm::vec3 base(i / 3, static_cast<float>(i % 3), 0);
        stand.push_back(
            {base, base + glm::vec3(0.1f, 1, 0), 0.02f, 0.01f, root ? trees::none : i - 1});
    }
    const trees::skeleton tree = support::built(stand);
    swaying one(tree, {}, {}, 1), three(tree, {}, {}, 3);
    const auto start = random_motions(tree.size(), 2, 1, 5);
    one.put(start);
    three.put(start);
    for (int i = 0; i < 5; ++i) {
        one.frame(1 / 60.0);
        three.frame(1 / 60.0);
    }
    const auto a = one.poses(), b = three.poses();
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]), 0);
}

// The CPU backend computes four joints at a time; the plain kernels say what must come out.
TEST(sway, four_at_a_time_has_the_plain_kernels_bits) {
    for (const std::uint32_t count : {1u, 2u, 3u, 5u, 300u}) {
        const support::test_tree tree = support::wild_scan(count, count);
        const auto joints = trees::layout_sway(tree.skeleton).joints;
        support::random_source random(count);
        const auto filled = [&]<class T>(std::vector<T> records) {
            for (T& r : records) {
                float values[sizeof(T) / 4];
                for (float& v : values) {
                    v = static_cast<float>(random.between(-2, 2));
                }
                std::memcpy(&r, values, sizeof r);
            }
            return records;
        };
        const auto loads = filled(std::vector<segment_load>(count));
        const auto states = filled(std::vector<shared::sway_state>(count + 1));
        const auto energies = filled(std::vector<shared::sway_energy>(count));
        const auto carried = filled(std::vector<shared::sway_carry>(count));
        const auto gains = filled(std::vector<shared::sway_gain>(count));
        const auto compare = [&](const auto& a, const auto& b, const char* what) {
            EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]), 0) << what << count;
        };
        {
            using K = kernels::sway_inertia;
            std::vector<shared::sway_carry> a(count), b(count);
            std::vector<shared::sway_gain> c(count), d(count);
            const auto go = [&](const auto& run, auto& carry, auto& gain) {
                run(K{0.02f}, range{0, count}, std::span(joints), std::span(loads),
                    std::span(states), std::span(energies), std::span(carried), std::span(carry),
                    std::span(gain));
            };
            go([](auto... x) { cpu::plain_program<K>::map(x...); }, a, c);
            go([](auto... x) { cpu::program<K>::map(x...); }, b, d);
            compare(a, b, "carry ");
            compare(c, d, "gain ");
        }
        {
            using K = kernels::sway_motion;
            std::vector<shared::sway_state> a(count), b(count);
            std::vector<segment_pose> c(count), d(count);
            std::vector<glm::vec4> e(count), f(count);
            const auto go = [&](const auto& run, auto& state, auto& pose, auto& velocity) {
                run(K{0.02f}, range{0, count}, std::span(joints), std::span(energies),
                    std::span(gains), std::span(states), std::span(states), std::span(state),
                    std::span(pose), std::span(velocity));
            };
            go([](auto... x) { cpu::plain_program<K>::map(x...); }, a, c, e);
            go([](auto... x) { cpu::program<K>::map(x...); }, b, d, f);
            compare(a, b, "state ");
            compare(c, d, "pose ");
            compare(e, f, "velocity ");
        }
    }
}

TEST(sway, frames_allocate_nothing) {
    if (SKYBARK_TEST_COUNTS_ALLOCATIONS == 0) {
        GTEST_SKIP() << "Allocations are the sanitizer's here.";
    }
    const support::test_tree tree = support::scanned_tree();
    for (const sway_model model :
         {sway_model::paper, sway_model::quasi_static, sway_model::dynamic}) {
        swaying s(tree.skeleton, with({}, model), {}, 3);
        s.frame(1 / 60.0);
        const std::uint64_t before = support::allocations;
        for (int i = 0; i < 3; ++i) {
            s.frame(1 / 60.0);
        }
        EXPECT_EQ(support::allocations, before);
    }
}

TEST(sway, keeps_the_backends_contract) {
    const support::test_tree tree = support::scanned_tree();
    cpu::device inner;
    std::vector<std::string> misuse;
    using checked = validated<cpu::device>;
    checked device(inner, [&](std::string_view sentence) { misuse.emplace_back(sentence); });
    for (const sway_model model :
         {sway_model::paper, sway_model::quasi_static, sway_model::dynamic}) {
        auto s = expect_value(trees::sway<checked>::create(device, tree.skeleton, with({}, model)));
        const auto loads =
            expect_value(device.create_buffer(tree.skeleton.size() * sizeof(segment_load)));
        for (int i = 0; i < 2; ++i) {
            expect_done(run(device, [&](auto& r) { s.record(r, view<checked>(loads), 0.02f); }));
        }
        expect_done(s.reset(device));
    }
    EXPECT_TRUE(misuse.empty()) << misuse.front();
}

TEST(sway, says_what_is_wrong_with_its_input) {
    cpu::device device;
    const support::test_tree tree = support::scanned_tree();
    const auto message = [&](const trees::skeleton& of, sway_options options,
                             std::span<const float> leaves = {}) {
        const auto made = cpu_sway::create(device, of, options, leaves);
        return made ? std::string() : made.error().message;
    };
    EXPECT_EQ(message(tree.skeleton, {}), "");
    EXPECT_NE(message({}, {}), "");
    EXPECT_NE(message(tree.skeleton, with({0, 800, 0.03})), "");
    EXPECT_NE(message(tree.skeleton, with({9e9, -1, 0.03})), "");
    EXPECT_NE(message(tree.skeleton, with({9e9, 800, -0.1})), "");
    EXPECT_NE(message(tree.skeleton, with({}, sway_model::quasi_static, 0)), "");
    EXPECT_NE(message(tree.skeleton, {}, std::vector<float>(3)), "");
    std::vector<float> leaves(tree.skeleton.size());
    EXPECT_EQ(message(tree.skeleton, {}, leaves), "");
    leaves.back() = -1;
    EXPECT_NE(message(tree.skeleton, {}, leaves), "");
    auto s = expect_value(cpu_sway::create(device, tree.skeleton));
    EXPECT_FALSE(s.upload(device, std::vector<joint_motion>(1)));
    cpu::device_options small;
    small.limits.max_buffer_bytes = 1000;
    cpu::device narrow(small);
    EXPECT_FALSE(cpu_sway::create(narrow, tree.skeleton));
}

// ---- Backends -----------------------------------------------------------------------------------

namespace {

/// Where bases and tips are after 600 frames of 1/60 s in gusts that are the same everywhere.
template <backend B>
std::vector<glm::vec3> after_gusts(B& device, const trees::skeleton& tree, sway_model model,
                                   int frames) {
    auto s = expect_value(trees::sway<B>::create(device, tree, with({}, model, 4)));
    std::vector<segment_load> loads(tree.size());
    auto buffer = expect_value(make_buffer<B, segment_load>(device, loads));
    for (int i = 0; i < frames; ++i) {
        const double t = i / 60.0;
        for (std::size_t k = 0; k < loads.size(); ++k) {
            const double area = double{tree.length[k]} * (double{tree.radius[k]} + 0.02);
            const double gust = 1 + 0.5 * std::sin(2.1 * t + 0.3 * double{tree.position[k].x}) +
                                0.3 * std::sin(5.3 * t + static_cast<double>(k % 13));
            loads[k] = {glm::vec3(60 * area * gust, 0, 20 * area * (gust - 1)),
                        static_cast<float>(6 * area)};
        }
        expect_done(device.upload(buffer, 0, std::as_bytes(std::span(std::as_const(loads)))));
        expect_done(run(device, [&](auto& r) { s.record(r, view<B>(buffer), 1 / 60.0f); }));
    }
    std::vector<segment_pose> poses(tree.size());
    expect_done(read_back<B, segment_pose>(device, *s.poses().buffer, std::span(poses)));
    std::vector<glm::vec3> places;
    for (std::size_t k = 0; k < poses.size(); ++k) {
        places.push_back(poses[k].base + poses[k].shift);
        places.push_back(shared::posed_point(poses[k], tree.tip(k)));
    }
    return places;
}

template <backend B>
void expect_like_the_cpu(B& device, int dynamic_frames) {
    cpu::device cpu;
    const support::test_tree tree = support::scanned_tree();
    const double height = double{trees::height(tree.skeleton)};
    for (const sway_model model :
         {sway_model::dynamic, sway_model::quasi_static, sway_model::paper}) {
        const int frames = model == sway_model::dynamic ? dynamic_frames : 10;
        const auto expected = after_gusts(cpu, tree.skeleton, model, frames);
        const auto actual = after_gusts(device, tree.skeleton, model, frames);
        double most = 0, moved = 0;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            most = std::max(most, double{glm::distance(expected[i], actual[i])});
            const glm::vec3 rest =
                i % 2 == 0 ? tree.skeleton.position[i / 2] : tree.skeleton.tip(i / 2);
            moved = std::max(moved, double{glm::distance(expected[i], rest)});
        }
        EXPECT_LE(most, 1e-4 * height) << static_cast<int>(model);
        EXPECT_GE(moved, 1e-3 * height) << static_cast<int>(model);
        ::testing::Test::RecordProperty("apart", std::to_string(most / height));
    }
}

void check(const std::string& backend, int frames) {
    support::with_device(backend, [&](auto& device) { expect_like_the_cpu(device, frames); });
}

} // namespace

TEST(sway, opengl_agrees_with_the_cpu) { check("opengl", 60); }
TEST(sway, vulkan_agrees_with_the_cpu) { check("vulkan", 60); }
TEST(sway, opengl_agrees_with_the_cpu_after_600_frames_slow) { check("opengl", 600); }
TEST(sway, vulkan_agrees_with_the_cpu_after_600_frames_slow) { check("vulkan", 600); }
