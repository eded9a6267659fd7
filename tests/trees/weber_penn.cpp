#include <skybark/trees/build_skeleton.hpp>
#include <skybark/trees/species.hpp>

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

using namespace skybark;
using trees::grow;
using trees::segment;
using trees::weber_penn_parameters;

namespace {

std::vector<segment> grown(const weber_penn_parameters& p, std::uint32_t seed = 1) {
    auto tree = grow(p, seed);
    EXPECT_TRUE(tree) << tree.error().message;
    return tree ? *std::move(tree) : std::vector<segment>{};
}

std::string complaint(const weber_penn_parameters& p) {
    const auto tree = grow(p, 1);
    return tree ? std::string() : tree.error().message;
}

::testing::AssertionResult has(const std::string& sentence, std::string_view part) {
    if (sentence.find(part) != std::string::npos)
        return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << '"' << sentence << "\" lacks \"" << part << '"';
}

/// A bare pole of 10 m.
weber_penn_parameters pole() {
    weber_penn_parameters p;
    p.level[0].curve_res = 10;
    return p;
}

/// A pole with straight level branches, all at right angles.
weber_penn_parameters comb(int shape, int branches) {
    weber_penn_parameters p = pole();
    p.levels = 2;
    p.shape = shape;
    p.base_size = 0.2f;
    p.level[1].branches = branches;
    p.level[1].length = 0.5f;
    p.level[1].down_angle = 90;
    p.level[1].rotate = 120;
    return p;
}

bool finite(const segment& s) {
    const glm::vec3 sum = s.base + s.tip;
    return std::isfinite(sum.x + sum.y + sum.z) && s.radius >= 0 && s.base_radius >= 0;
}

double length_of(const segment& s) { return glm::length(glm::dvec3(s.tip) - glm::dvec3(s.base)); }

} // namespace

TEST(weber_penn, a_pole_is_straight_and_tapers) {
    const auto tree = grown(pole());
    ASSERT_EQ(tree.size(), 10u);
    for (std::size_t i = 0; i < tree.size(); ++i) {
        EXPECT_NEAR(tree[i].tip.y, static_cast<double>(i + 1), 1e-5);
        EXPECT_NEAR(tree[i].tip.x, 0, 1e-6);
        EXPECT_NEAR(tree[i].radius, 0.2 * (1 - 0.1 * static_cast<double>(i + 1)), 1e-6);
        EXPECT_EQ(tree[i].parent, i == 0 ? trees::none : i - 1);
    }
    EXPECT_NEAR(tree[0].base_radius, 0.2, 1e-6);
}

TEST(weber_penn, z_scale_stretches_upwards) {
    weber_penn_parameters p = pole();
    p.z_scale = 2.5f;
    EXPECT_NEAR(grown(p).back().tip.y, 25, 1e-4);
}

TEST(weber_penn, tapers) {
    weber_penn_parameters p = pole();
    const auto radius = [&p](float taper, std::size_t i) {
        p.level[0].taper = taper;
        return static_cast<double>(grown(p)[i].radius);
    };
    EXPECT_NEAR(radius(0, 9), 0.2, 1e-6) << "a cylinder";
    EXPECT_NEAR(radius(0.5f, 9), 0.1, 1e-6);
    EXPECT_NEAR(radius(1, 9), 0, 1e-6) << "a cone";
    EXPECT_NEAR(radius(1.5f, 4), 0.2 * 0.75, 1e-6) << "like 0.5 below the end";
    EXPECT_NEAR(radius(1.5f, 9), 0, 1e-6) << "a rounded end";
    EXPECT_NEAR(radius(2, 8), 0.2, 1e-6);
    // strings of balls touch the axis every diameter: 0.4 m, so at 2, 4, 6 m
    p.ratio = 0.02f;
    EXPECT_NEAR(radius(3, 1), 0, 1e-3);
    EXPECT_NEAR(radius(3, 0), 0.2, 1e-3) << "9 m from the tip: 22.5 balls";
}

TEST(weber_penn, flare_widens_the_foot) {
    weber_penn_parameters p = pole();
    p.flare = 1;
    const auto tree = grown(p);
    EXPECT_GT(tree.size(), 10u) << "finer where the radius changes";
    EXPECT_NEAR(tree[0].base_radius, 0.2 * 1.99, 1e-6) << "(100^1 - 1) / 100 + 1";
    EXPECT_NEAR(tree.back().radius, 0, 1e-6);
    for (const segment& s : tree)
        if (s.tip.y > 1.26f) {
            EXPECT_NEAR(s.radius, 0.2 * (1 - s.tip.y / 10), 1e-6) << "no flare above 1/8";
        }
}

TEST(weber_penn, shapes_decide_the_length_of_branches) {
    // ShapeRatio at ratio r from the top (0) to the base of the crown (1); section 4.3
    const double pi = std::acos(-1.0);
    const std::array<double (*)(double, double), 8> ratio{
        [](double r, double) { return 0.2 + 0.8 * r; },
        [](double r, double w) { return 0.2 + 0.8 * std::sin(w * r); },
        [](double r, double w) { return 0.2 + 0.8 * std::sin(0.5 * w * r); },
        [](double, double) { return 1.0; },
        [](double r, double) { return 0.5 + 0.5 * r; },
        [](double r, double) { return r <= 0.7 ? r / 0.7 : (1 - r) / 0.3; },
        [](double r, double) { return 1 - 0.8 * r; },
        [](double r, double) { return r <= 0.7 ? 0.5 + 0.5 * r / 0.7 : 0.5 + 0.5 * (1 - r) / 0.3; },
    };
    for (int shape = 0; shape < 8; ++shape) {
        const auto tree = grown(comb(shape, 20));
        ASSERT_EQ(tree.size(), 10u + 20u);
        for (std::size_t i = 10; i < tree.size(); ++i) {
            const double r = (10 - static_cast<double>(tree[i].base.y)) / 8;
            EXPECT_GE(tree[i].base.y, 2.0f) << "the base is bare";
            EXPECT_NEAR(length_of(tree[i]), 5 * ratio[static_cast<std::size_t>(shape)](r, pi), 1e-4)
                << "shape " << shape << " at " << r;
            EXPECT_NEAR(tree[i].tip.y, tree[i].base.y, 1e-5) << "down angle 90";
        }
    }
}

TEST(weber_penn, children_start_on_their_parent_and_are_no_thicker) {
    for (const auto& species : trees::all_species()) {
        const auto tree = grown(species.parameters, 4);
        std::size_t off = 0;
        for (const segment& s : tree) {
            ASSERT_TRUE(finite(s));
            if (s.parent == trees::none)
                continue;
            const segment& p = tree[s.parent];
            const glm::dvec3 axis = glm::dvec3(p.tip) - glm::dvec3(p.base);
            const glm::dvec3 at = glm::dvec3(s.base) - glm::dvec3(p.base);
            const double t = std::clamp(glm::dot(at, axis) / glm::dot(axis, axis), 0.0, 1.0);
            off += glm::length(at - t * axis) > 1e-4;
            EXPECT_LE(s.base_radius, std::max(p.base_radius, p.radius) * 1.0001f + 1e-7f);
        }
        EXPECT_EQ(off, 0u) << species.name;
    }
}

TEST(weber_penn, rotate_winds_around_or_alternates) {
    const auto azimuth = [](const segment& s) {
        return std::atan2(static_cast<double>(s.tip.z - s.base.z),
                          static_cast<double>(s.tip.x - s.base.x)) *
               180 / std::acos(-1.0);
    };
    const auto step = [&](float rotate) {
        weber_penn_parameters p = comb(3, 8);
        p.level[1].rotate = rotate;
        const auto tree = grown(p);
        std::vector<segment> branch(tree.begin() + 10, tree.end());
        std::sort(branch.begin(), branch.end(),
                  [](const segment& a, const segment& b) { return a.base.y < b.base.y; });
        std::vector<double> steps;
        for (std::size_t i = 1; i < branch.size(); ++i)
            steps.push_back(std::fmod(azimuth(branch[i]) - azimuth(branch[i - 1]) + 720, 360));
        return steps;
    };
    for (const double s : step(140)) // about +Y, seen from below: either way round is one helix
        EXPECT_NEAR(std::min(s, 360 - s), 140, 0.01);
    const auto sides = step(-90); // 90° to either side in turn: always opposite
    for (const double s : sides)
        EXPECT_NEAR(s, 180, 0.01);
}

TEST(weber_penn, negative_down_angle_variation_goes_by_height) {
    weber_penn_parameters p = comb(3, 16);
    p.level[1].down_angle = 60;
    p.level[1].down_angle_v = -50;
    const auto tree = grown(p);
    for (std::size_t i = 10; i < tree.size(); ++i) {
        const double r = (10 - static_cast<double>(tree[i].base.y)) / 8;
        const double expected = 60 - 50 * (1 - 2 * (0.2 + 0.8 * r));
        const double up = static_cast<double>(tree[i].tip.y - tree[i].base.y);
        EXPECT_NEAR(std::acos(up / length_of(tree[i])) * 180 / std::acos(-1.0), expected, 0.01);
    }
}

TEST(weber_penn, curve_bends_by_its_angle) {
    weber_penn_parameters p = pole();
    p.level[0].curve = 80;
    const auto direction = [](const segment& s) {
        return glm::normalize(glm::dvec3(s.tip) - glm::dvec3(s.base));
    };
    const auto turn = [&](const std::vector<segment>& t, std::size_t a, std::size_t b) {
        return std::acos(glm::dot(direction(t[a]), direction(t[b]))) * 180 / std::acos(-1.0);
    };
    const auto once = grown(p);
    EXPECT_NEAR(turn(once, 0, 9), 72, 1e-2) << "nine joints of 80/10";
    p.level[0].curve_back = -80;
    const auto back = grown(p);
    EXPECT_NEAR(turn(back, 0, 4), 64, 1e-2) << "four joints of 80/5";
    EXPECT_NEAR(turn(back, 4, 9), 80, 1e-2) << "five joints back";
}

TEST(weber_penn, helix_keeps_its_declination) {
    weber_penn_parameters p = pole();
    p.level[0].curve_v = -30;
    const auto tree = grown(p);
    for (const segment& s : tree)
        EXPECT_NEAR((s.tip.y - s.base.y) / length_of(s), std::cos(std::acos(-1.0) / 6), 1e-5);
    EXPECT_NEAR(tree.back().tip.x, 0, 1e-4) << "a whole turn ends over its foot";
    EXPECT_NEAR(tree.back().tip.z, 0, 1e-4);
}

TEST(weber_penn, attraction_leads_up_or_down) {
    weber_penn_parameters p = comb(3, 12);
    p.levels = 3;
    p.level[1].down_angle = 90;
    p.level[2].branches = 6;
    p.level[2].length = 0.5f;
    p.level[2].down_angle = 60;
    p.level[2].rotate = 140;
    p.level[2].curve_res = 8;
    const auto mean_rise = [&p](float attraction) {
        p.attraction_up = attraction;
        double sum = 0;
        int count = 0;
        for (const segment& s : grown(p))
            if (s.tip.y < 9.5f && glm::length(glm::vec2(s.tip.x, s.tip.z)) > 1.5f) {
                sum += static_cast<double>(s.tip.y - s.base.y) / length_of(s);
                ++count;
            }
        return sum / count;
    };
    EXPECT_GT(mean_rise(2), mean_rise(0) + 0.1);
    EXPECT_LT(mean_rise(-2), mean_rise(0) - 0.1);
}

TEST(weber_penn, splits_by_error_diffusion) {
    weber_penn_parameters p = pole();
    p.level[0].split_angle = 20;
    p.base_splits = 2;
    EXPECT_EQ(grown(p).size(), 1u + 3 * 9u) << "three stems from the second segment on";
    p.base_splits = 0;
    p.level[0].curve_res = 4;
    p.level[0].seg_splits = 1;
    // base_splits, not seg_splits, decides at the first joint; then 2 and 4
    EXPECT_EQ(grown(p).size(), 1u + 1 + 2 + 4);
    p.level[0].seg_splits = 0.5f;
    EXPECT_LT(grown(p).size(), 8u);
    EXPECT_GT(grown(p).size(), 4u);
}

TEST(weber_penn, clones_share_the_children) {
    weber_penn_parameters p = comb(3, 30);
    p.base_splits = 3;
    p.level[0].split_angle = 20;
    p.level[0].seg_splits = 0.3f;
    p.level[1].curve_res = 1;
    std::size_t branches = 0;
    for (const segment& s : grown(p))
        branches += s.base_radius < 0.2f && std::abs(length_of(s) - 5) < 1e-3;
    EXPECT_EQ(branches, 30u);
}

TEST(weber_penn, pruning_keeps_to_the_envelope) {
    weber_penn_parameters p = comb(3, 60);
    p.level[1].curve_res = 6;
    p.level[1].down_angle = 50;
    p.prune_ratio = 1;
    p.prune_width = 0.2f;
    p.prune_width_peak = 0.5f;
    p.prune_power_low = 0.5f;
    p.prune_power_high = 0.5f;
    const auto tree = grown(p);
    EXPECT_GT(tree.size(), 100u);
    double widest = 0;
    for (const segment& s : tree) {
        const double ratio = (10 - static_cast<double>(s.tip.y)) / 8;
        const double r = std::hypot(s.tip.x, s.tip.z);
        widest = std::max(widest, r);
        if (r < 1e-5) // the trunk isn't pruned
            continue;
        const double half = ratio < 0.5 ? ratio / 0.5 : (1 - ratio) / 0.5;
        EXPECT_LE(r, 2 * std::sqrt(std::max(0.0, half)) + 1e-4);
    }
    EXPECT_GT(widest, 1.5) << "and fills it";
    p.prune_ratio = 0;
    double unpruned = 0;
    for (const segment& s : grown(p))
        unpruned = std::max(unpruned, std::hypot(s.tip.x, s.tip.z) * 1.0);
    EXPECT_GT(unpruned, 3.0);
}

TEST(weber_penn, same_seed_same_tree_other_seed_other_tree) {
    const auto a = grown(trees::quaking_aspen(), 1);
    const auto b = grown(trees::quaking_aspen(), 1);
    const auto c = grown(trees::quaking_aspen(), 2);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        EXPECT_EQ(a[i].tip, b[i].tip);
    EXPECT_NE(a[5].tip, c[5].tip);
}

TEST(weber_penn, random_numbers_are_the_same_everywhere) {
    // computed with the recurrence of O'Neill's paper in arbitrary precision
    trees::detail::weber_penn::pcg32 random(42);
    for (const std::uint32_t expected : {3270867926u, 1795671209u, 1924641435u, 1143034755u})
        EXPECT_EQ(random.next(), expected);
}

TEST(weber_penn, every_species_is_a_tree) {
    for (const auto& species : trees::all_species())
        for (std::uint32_t seed = 0; seed < 8; ++seed) {
            const auto tree = grown(species.parameters, seed);
            EXPECT_GT(tree.size(), 1000u) << species.name;
            const auto skeleton = trees::build_skeleton(tree);
            ASSERT_TRUE(skeleton) << skeleton.error().message;
            EXPECT_EQ(skeleton->levels[1], 1u) << "one root";
            const double tall = trees::height(*skeleton);
            const double scale = species.parameters.scale + species.parameters.scale_v;
            EXPECT_LT(tall, 2 * scale) << species.name;
            EXPECT_GT(tall, 0.05 * species.parameters.scale) << species.name;
        }
    EXPECT_EQ(trees::find_species("quaking_aspen")->parameters.level[1].branches, 50);
    EXPECT_EQ(trees::find_species("oak"), nullptr);
}

TEST(weber_penn, the_willow_weeps_and_the_aspen_is_slender) {
    const auto box = [](const weber_penn_parameters& p) {
        return trees::bounds(*trees::build_skeleton(grown(p)));
    };
    const auto aspen = box(trees::quaking_aspen());
    EXPECT_GT(aspen.max.y, 1.5f * (aspen.max.x - aspen.min.x));
    double down = 0;
    const auto willow = grown(trees::weeping_willow());
    for (const segment& s : willow)
        down += s.tip.y < s.base.y;
    EXPECT_GT(down / static_cast<double>(willow.size()), 0.5);
}

TEST(weber_penn, names_a_bad_parameter) {
    const auto with = [](auto change) {
        weber_penn_parameters p = pole();
        change(p);
        return complaint(p);
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(has(with([&](auto& p) { p.scale = nan; }), "parameter scale is nan; expected"));
    EXPECT_TRUE(has(with([](auto& p) { p.scale = -1; }), "parameter scale is -1"));
    EXPECT_TRUE(has(with([](auto& p) { p.levels = 0; }), "parameter levels is 0"));
    EXPECT_TRUE(has(with([](auto& p) { p.shape = 9; }), "parameter shape is 9"));
    EXPECT_TRUE(has(with([](auto& p) { p.base_splits = -1; }), "parameter base_splits is -1"));
    EXPECT_TRUE(has(with([](auto& p) { p.level[2].branches = -5; }),
                    "parameter branches of level 2 is -5"));
    EXPECT_TRUE(has(with([&](auto& p) { p.level[3].curve_v = nan; }), "curve_v of level 3 is nan"));
    EXPECT_TRUE(has(with([](auto& p) { p.level[0].curve_res = 0; }), "curve_res of level 0 is 0"));
}

TEST(weber_penn, refuses_no_trunk_and_an_endless_one) {
    weber_penn_parameters p = pole();
    p.level[0].length = 0;
    EXPECT_TRUE(has(complaint(p), "leave the trunk no length (0 ± 0 of the scale)"));
    p.level[0].length = 1000;
    p.scale = 1e6f;
    EXPECT_TRUE(has(complaint(p), "more than 1e9 metres"));
}

TEST(weber_penn, no_power_makes_a_radius_nan) {
    weber_penn_parameters p = comb(0, 20);
    p.ratio = 0;
    p.ratio_power = -100;
    p.level[1].length = 0.001f;
    for (const segment& s : grown(p))
        EXPECT_EQ(s.base_radius, 0.0f);
}

TEST(weber_penn, refuses_more_than_fifty_million_segments) {
    weber_penn_parameters p = comb(3, 100'000);
    p.levels = 3;
    p.level[2].branches = 100'000;
    EXPECT_TRUE(has(complaint(p), "could make about 10000100010 segments; expected at most"));
    weber_penn_parameters q = pole();
    q.level[0].curve_res = 1000;
    q.level[0].seg_splits = 2;
    EXPECT_TRUE(has(complaint(q), "segments; expected at most 50000000"));
}
