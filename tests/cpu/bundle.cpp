// The CPU backend's own way to resolve bundles, against the composed one: the same bits.

#include "support/cpu_work.hpp"

#include <skybark/gather/bundle_resolver.hpp>

#include <cstring>
#include <gtest/gtest.h>
#include <limits>

using namespace skybark;
using support::expect_value;

namespace {

using device = cpu::device;
using cpu::bundle_lanes;
using support::random_source;

static_assert(resolves_bundles<device>);

device with_threads(std::uint32_t threads) {
    cpu::device_options options;
    options.threads = threads;
    return device(options);
}

struct scene {
    std::vector<gather_triangle> triangles;
    std::vector<gather_sample> samples;
    std::vector<std::uint32_t> alpha;
};

glm::vec3 vector(random_source& random, double reach = 1) {
    return {random.between(-reach, reach), random.between(-reach, reach),
            random.between(-reach, reach)};
}

gather_triangle triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    gather_triangle t;
    t.a = a;
    t.b = b;
    t.c = c;
    return t;
}

gather_sample sample(glm::vec3 position, glm::vec3 normal) {
    gather_sample s;
    s.position = position;
    s.normal = normal;
    return s;
}

/// Triangles of all sizes up to `reach`, and samples about them.
scene random_scene(std::uint32_t seed, std::size_t triangles, std::size_t samples, double reach) {
    random_source random(seed);
    scene s;
    for (std::size_t i = 0; i < triangles; ++i) {
        const glm::vec3 middle = vector(random);
        const double size = reach * std::exp2(-random.between(0, 8));
        s.triangles.push_back(triangle(middle + vector(random, size), middle + vector(random, size),
                                       middle + vector(random, size)));
    }
    for (std::size_t i = 0; i < samples; ++i) {
        s.samples.push_back(sample(vector(random, 1.2), glm::vec3(random.direction())));
    }
    return s;
}

/// Puts a sample on a corner, on an edge, and within each of some triangles.
void add_samples_on_triangles(scene& s, std::uint32_t seed, std::size_t count) {
    random_source random(seed);
    for (std::size_t i = 0; i < count; ++i) {
        const gather_triangle& t =
            s.triangles[random.below(static_cast<std::uint32_t>(s.triangles.size()))];
        const glm::vec3 normal(random.direction());
        const auto u = static_cast<float>(random.between(0, 1));
        const auto v = static_cast<float>(random.between(0, 1 - double{u}));
        s.samples.push_back(sample(t.a, normal));
        s.samples.push_back(sample(t.b + u * (t.c - t.b), normal));
        s.samples.push_back(sample(t.a + u * (t.b - t.a) + v * (t.c - t.a), normal));
    }
}

std::vector<gather_hit> hits_of(device& d, const scene& s, const ray_bundle& bundle,
                                std::optional<bundle_lanes> lanes) {
    const auto triangles = expect_value(make_buffer<device, gather_triangle>(d, s.triangles));
    const auto samples = expect_value(make_buffer<device, gather_sample>(d, s.samples));
    const auto alpha = expect_value(make_buffer<device, std::uint32_t>(d, s.alpha));
    const auto hits = expect_value(d.create_buffer(s.samples.size() * sizeof(gather_hit)));
    bundle_work<device> work{
        view<device>(triangles), {}, view<device>(samples), view<device>(hits)};
    if (!s.alpha.empty()) {
        work.alpha = view<device>(alpha);
    }
    if (lanes) {
        cpu::bundle_scratch scratch;
        EXPECT_TRUE(cpu::resolve_bundle(d, scratch, bundle, work, *lanes));
    } else {
        gather::resolver_options options;
        options.route = gather::resolve_route::composed;
        options.cells = static_cast<std::uint32_t>(bundle.direction.w);
        auto resolver =
            expect_value(gather::bundle_resolver<device>::create(d, s.triangles.size(), options));
        EXPECT_TRUE(run(d, [&](auto& r) { resolver.record(r, bundle, work); }));
    }
    std::vector<gather_hit> out(s.samples.size());
    EXPECT_TRUE((read_back<device, gather_hit>(d, hits, out)));
    return out;
}

std::vector<bundle_lanes> all_lanes() {
    std::vector<bundle_lanes> lanes;
    for (const bundle_lanes l : {bundle_lanes::one, bundle_lanes::eight, bundle_lanes::sixteen}) {
        if (l <= cpu::best_bundle_lanes()) {
            lanes.push_back(l);
        }
    }
    return lanes;
}

/// How many samples hit something.
std::size_t expect_same_bits(const scene& s, const gather::bounds& box, std::uint32_t seed,
                             int directions = 3) {
    random_source random(seed);
    const std::uint32_t cells = gather::default_cells(s.triangles.size());
    std::size_t found = 0;
    for (int i = 0; i < directions; ++i) {
        const glm::dvec3 axis = i == 0 ? glm::dvec3(0, 0, 1) : random.direction();
        const ray_bundle bundle = gather::make_bundle(box, axis, cells, gather::default_lift(box));
        device one = with_threads(1);
        const auto expected = hits_of(one, s, bundle, {});
        for (const gather_hit& hit : expected) {
            found += hit.surface != no_surface ? 1 : 0;
        }
        for (const std::uint32_t threads : {1u, 2u, 3u}) {
            device d = with_threads(threads);
            for (const bundle_lanes lanes : all_lanes()) {
                const auto hits = hits_of(d, s, bundle, lanes);
                std::size_t wrong = 0;
                std::size_t first = 0;
                for (std::size_t k = hits.size(); k-- > 0;) {
                    if (std::memcmp(&hits[k], &expected[k], sizeof(gather_hit)) != 0) {
                        ++wrong;
                        first = k;
                    }
                }
                EXPECT_EQ(wrong, 0u)
                    << threads << " threads, lanes " << static_cast<int>(lanes) << ", direction "
                    << i << ", sample " << first << ": " << hits[first].distance << ' '
                    << hits[first].surface << " for " << expected[first].distance << ' '
                    << expected[first].surface;
                if (wrong != 0) {
                    return found;
                }
            }
        }
    }
    return found;
}

TEST(bundle, meets_random_triangles) {
    for (const double reach : {0.05, 0.5, 4.0}) {
        for (const std::size_t samples : {300u, 20'000u}) {
            const scene s = random_scene(1, reach > 1 ? 300 : 2000, samples, reach);
            const auto box = gather::bounds_of(s.triangles);
            EXPECT_GT(expect_same_bits(s, box, 2), samples / 80) << samples << ' ' << reach;
        }
    }
}

TEST(bundle, meets_many_triangles_with_many_samples) {
    scene s = random_scene(3, 30'000, 120'000, 0.05);
    add_samples_on_triangles(s, 4, 5000);
    EXPECT_GT(expect_same_bits(s, gather::bounds_of(s.triangles), 5, 2), 40'000u);
}

TEST(bundle, meets_every_number_of_triangles_and_samples) {
    for (const std::size_t triangles : {0u, 1u, 2u, 15u, 16u, 17u, 33u}) {
        for (const std::size_t samples : {0u, 1u, 2u, 15u, 16u, 17u, 31u, 33u}) {
            const scene s = random_scene(6, triangles, samples, 2);
            expect_same_bits(s, gather::bounds_of(s.triangles), 7, 1);
        }
    }
}

TEST(bundle, chooses_the_lowest_of_triangles_in_one_plane) {
    random_source random(8);
    scene s;
    // A grid of quads, and each once more later, some of them turned: equal distances everywhere.
    for (int copy = 0; copy < 3; ++copy) {
        for (int y = 0; y < 20; ++y) {
            for (int x = 0; x < 20; ++x) {
                const glm::vec3 a(x, y, 0);
                const glm::vec3 b = a + glm::vec3(1, 0, 0);
                const glm::vec3 c = a + glm::vec3(1, 1, 0);
                const glm::vec3 d = a + glm::vec3(0, 1, 0);
                s.triangles.push_back(copy == 1 ? triangle(a, c, b) : triangle(a, b, c));
                s.triangles.push_back(triangle(a, c, d));
            }
        }
    }
    s.triangles.push_back(triangle({0, 0, 0}, {20, 0, 0}, {20, 20, 0}));
    std::swap(s.triangles.front(), s.triangles.back());
    for (int i = 0; i < 20'000; ++i) {
        // On corners, on edges, and between.
        const auto step = [&] { return 0.25f * static_cast<float>(random.below(81)); };
        const float height = i % 3 == 0 ? 0.0f : static_cast<float>(random.between(-2, 2));
        s.samples.push_back(sample({step(), step(), height}, {0, 0, i % 2 == 0 ? 1 : -1}));
    }
    gather::bounds box = gather::bounds_of(s.triangles);
    box.add({0, 0, 2});
    EXPECT_GT(expect_same_bits(s, box, 9), 10'000u);
}

TEST(bundle, chooses_the_lowest_of_neighbours_in_one_plane) {
    random_source random(22);
    scene s;
    glm::vec3 middle(0);
    for (int i = 0; i < 20'000; ++i) {
        middle = i % 16 == 0 ? vector(random) : middle; // many over each other, one after another
        gather_triangle t = triangle(middle + vector(random, 0.03), middle + vector(random, 0.03),
                                     middle + vector(random, 0.03));
        t.a.z = t.b.z = t.c.z = 0;
        s.triangles.push_back(t);
    }
    for (int i = 0; i < 10'000; ++i) {
        s.samples.push_back(sample(vector(random), {0, 0, i % 2 == 0 ? 1 : -1}));
    }
    gather::bounds box = gather::bounds_of(s.triangles);
    box.add({0, 0, 1});
    EXPECT_GT(expect_same_bits(s, box, 23, 2), 2000u);
}

TEST(bundle, looks_through_holes) {
    random_source random(10);
    scene s = random_scene(11, 3000, 20'000, 0.5);
    constexpr std::uint32_t coordinates = 40;
    constexpr std::uint32_t width = 8;
    constexpr std::uint32_t height = 5;
    for (std::uint32_t i = 0; i < coordinates; ++i) {
        alpha_coordinates c;
        const auto place = [&] { return glm::vec2(random.between(-2, 2), random.between(-2, 2)); };
        c.a = place();
        c.b = place();
        c.c = place();
        c.map = coordinates * 12;
        c.size = width + 65536 * height;
        std::uint32_t words[12];
        std::memcpy(words, &c, sizeof c);
        s.alpha.insert(s.alpha.end(), words, words + 12);
    }
    for (std::uint32_t i = 0; i < width * height; ++i) {
        s.alpha.push_back(glm::floatBitsToUint(static_cast<float>(random.between(0, 1))));
    }
    for (gather_triangle& t : s.triangles) {
        t.alpha = random.below(coordinates + 1);
    }
    const auto box = gather::bounds_of(s.triangles);
    const std::size_t with = expect_same_bits(s, box, 12);
    for (gather_triangle& t : s.triangles) {
        t.alpha = 0;
    }
    EXPECT_LT(with, expect_same_bits(s, box, 12));
}

TEST(bundle, meets_triangles_that_are_none) {
    random_source random(13);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinite = std::numeric_limits<float>::infinity();
    const float huge = std::numeric_limits<float>::max();
    scene s = random_scene(14, 500, 2000, 0.5);
    const auto box = gather::bounds_of(s.triangles);
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 a = vector(random);
        const glm::vec3 step = vector(random);
        // Points, and lines.
        s.triangles.push_back(triangle(a, a, a));
        s.triangles.push_back(triangle(a, a, a + step));
        s.triangles.push_back(triangle(a, a + step, a + 0.5f * step));
        // Almost.
        s.triangles.push_back(triangle(a, a + step, a + 0.3f * step + vector(random, 1e-7)));
        s.triangles.push_back(triangle(a, a + vector(random, 1e-7), a + vector(random, 1e-7)));
        s.triangles.push_back(triangle(a, a + step, a + step + vector(random, 1e-6)));
        s.samples.push_back(sample(a, glm::vec3(random.direction())));
        s.samples.push_back(sample(a + 0.25f * step, glm::vec3(random.direction())));
        s.samples.push_back(sample(a + 1.5f * step, glm::vec3(random.direction())));
        // A little beyond the ends of lines, where rounding alone says what is inside.
        for (int k = 0; k < 10; ++k) {
            const auto beyond = static_cast<float>(random.between(0, 0.01));
            s.samples.push_back(sample(k % 2 == 0 ? a - beyond * step : a + (1 + beyond) * step,
                                       glm::vec3(random.direction())));
        }
    }
    for (const float odd : {nan, infinite, -infinite, huge, -huge, 1e30f, 1e10f, 1e4f}) {
        for (int k = 0; k < 9; ++k) {
            glm::vec3 corners[3] = {vector(random), vector(random), vector(random)};
            corners[k / 3][k % 3] = odd;
            s.triangles.push_back(triangle(corners[0], corners[1], corners[2]));
        }
        for (int k = 0; k < 6; ++k) {
            gather_sample at = sample(vector(random), glm::vec3(random.direction()));
            (k < 3 ? at.position : at.normal)[k % 3] = odd;
            s.samples.push_back(at);
        }
        const glm::vec3 far(odd, 2 * odd, -odd);
        s.triangles.push_back(triangle({-odd, -odd, 0.5f}, {odd, -odd, 0.1f}, {0, odd, 0.3f}));
        s.triangles.push_back(triangle(far, far, far));
    }
    EXPECT_GT(expect_same_bits(s, box, 15, 4), 1000u);
    // A grid that fits nothing.
    gather::bounds tiny;
    tiny.add({0.5f, 0.5f, 0.5f});
    tiny.add({0.51f, 0.5f, 0.5f});
    expect_same_bits(s, tiny, 16);
}

TEST(bundle, takes_samples_all_in_one_place) {
    scene s = random_scene(17, 1000, 0, 0.5);
    for (int i = 0; i < 9000; ++i) {
        s.samples.push_back(sample({0.1f, 0.2f, 0.001f * static_cast<float>(i)}, {0, 0, 1}));
    }
    EXPECT_GT(expect_same_bits(s, gather::bounds_of(s.triangles), 18), 1000u);
    for (gather_sample& at : s.samples) {
        at.position.z = 0; // in one line across the bundle
    }
    expect_same_bits(s, gather::bounds_of(s.triangles), 19);
}

/// Rows of a lattice as long as the grid looks samples over: each 512th is in one column.
TEST(bundle, spreads_its_grid_over_a_lattice) {
    constexpr int side = 512;
    std::vector<gather_sample> lattice;
    gather::bounds box;
    for (int i = 0; i < side * side; ++i) {
        lattice.push_back(
            sample({static_cast<float>(i % side), static_cast<float>(i / side), 0}, {0, 0, 1}));
        box.add(lattice.back().position);
    }
    const ray_bundle bundle = gather::make_bundle(box, {0, 0, 1}, 512, 0.001f);
    const cpu::bundles::grid grid = cpu::bundles::make_grid(bundle, lattice, 100000);
    // A square lattice: nearly as many columns as rows, and of the order of one for each sample's.
    EXPECT_GT(grid.columns, 256u);
    EXPECT_GT(grid.rows, 256u);
}

TEST(bundle, recorders_resolve) {
    const scene s = random_scene(20, 1000, 1000, 0.5);
    device d = with_threads(2);
    const auto box = gather::bounds_of(s.triangles);
    const ray_bundle bundle = gather::make_bundle(box, {1, 2, 3}, 32, gather::default_lift(box));
    const auto triangles = expect_value(make_buffer<device, gather_triangle>(d, s.triangles));
    const auto samples = expect_value(make_buffer<device, gather_sample>(d, s.samples));
    const auto hits = expect_value(d.create_buffer(s.samples.size() * sizeof(gather_hit)));
    ASSERT_TRUE(run(d, [&](auto& r) {
        r.resolve(bundle, {view<device>(triangles), {}, view<device>(samples), view<device>(hits)});
    }));
    std::vector<gather_hit> out(s.samples.size());
    ASSERT_TRUE((read_back<device, gather_hit>(d, hits, out)));
    const auto expected = hits_of(d, s, bundle, {});
    EXPECT_EQ(std::memcmp(out.data(), expected.data(), out.size() * sizeof(gather_hit)), 0);
}

} // namespace
