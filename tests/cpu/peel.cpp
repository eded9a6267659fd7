// The CPU backend's peel, against integer coverage and depths in double precision.

#include "support/cpu_work.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>

using namespace skybark;
using support::expect_value;

namespace {

using device = cpu::device;
using support::random_source;

/// Corners as they are.
struct given_corner {
    using buffers = buffer_list<readonly<glm::vec4>>;
    [[nodiscard]] glm::vec4 corner(std::uint32_t i, std::span<const glm::vec4> corners) const {
        return corners[i];
    }
};
static_assert(peels<device, given_corner>);

device with_threads(std::uint32_t threads) {
    cpu::device_options options;
    options.threads = threads;
    return device(options);
}

struct layer {
    std::vector<float> depth;
    std::vector<std::uint32_t> triangle;
    std::uint32_t count = 0;

    bool operator==(const layer&) const = default;
};

/// All layers of these corners, farthest first, without the empty one at the end.
std::vector<layer> layers_of(device& d, const std::vector<glm::vec4>& corners, std::uint32_t width,
                             std::uint32_t height, range triangles) {
    const std::size_t pixels = std::size_t{width} * height;
    const auto in = expect_value(make_buffer<device, glm::vec4>(d, corners));
    const std::vector<float> ones(pixels, 1.0f);
    const auto depth = expect_value(make_buffer<device, float>(d, ones));
    const auto triangle = expect_value(d.create_buffer(pixels * 4));
    const auto count = expect_value(d.create_buffer(sizeof(count_record)));
    std::vector<layer> all;
    while (true) {
        const peeled_layer<device> to{width, height, view<device>(depth), view<device>(triangle),
                                      view<device>(count)};
        EXPECT_TRUE(
            run(d, [&](auto& r) { r.peel(given_corner{}, {view<device>(in)}, triangles, to); }));
        layer next{std::vector<float>(pixels), std::vector<std::uint32_t>(pixels), 0};
        count_record counted{1, 2, {}};
        EXPECT_TRUE((read_back<device, float>(d, depth, next.depth)));
        EXPECT_TRUE((read_back<device, std::uint32_t>(d, triangle, next.triangle)));
        EXPECT_TRUE((read_back<device, count_record>(d, count, std::span(&counted, 1))));
        EXPECT_EQ(counted.written, counted.required);
        next.count = counted.written;
        if (next.count == 0 || all.size() > 1000) {
            EXPECT_EQ(std::count(next.depth.begin(), next.depth.end(), 0.0f),
                      static_cast<std::ptrdiff_t>(pixels));
            return all;
        }
        all.push_back(next);
    }
}

/// Corners on quarters of a pixel, so that integers say exactly what is covered.
struct quarters {
    std::int64_t x;
    std::int64_t y;
};
glm::vec4 clip_of(quarters q, float z, std::uint32_t width, std::uint32_t height) {
    return {static_cast<float>(q.x) / (2.0f * static_cast<float>(width)) - 1.0f,
            static_cast<float>(q.y) / (2.0f * static_cast<float>(height)) - 1.0f, z, 1};
}

/// Twice the area of a, b and the place, in sixteenths of a pixel.
std::int64_t turn(quarters a, quarters b, quarters at) {
    return (b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x);
}

constexpr std::uint32_t width = 64; // powers of two: clip coordinates are exact
constexpr std::uint32_t height = 32;

TEST(peel, finds_every_depth_from_far_to_near) {
    random_source random(31);
    const auto place = [&](std::uint32_t most) {
        return static_cast<std::int64_t>(random.below(most + 80)) - 40;
    };
    std::vector<glm::vec4> corners;
    std::vector<std::vector<double>> expected(std::size_t{width} * height);
    for (int t = 0; t < 300; ++t) {
        quarters q[3];
        float z[3];
        for (int k = 0; k < 3; ++k) {
            q[k] = {place(4 * width), place(4 * height)};
            z[k] = static_cast<float>(random.between(-0.2, 1.2));
            corners.push_back(clip_of(q[k], z[k], width, height));
        }
        const std::int64_t area = turn(q[0], q[1], q[2]);
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x) {
                const quarters at{4 * std::int64_t{x} + 2, 4 * std::int64_t{y} + 2};
                const std::int64_t e[3] = {turn(q[1], q[2], at), turn(q[2], q[0], at),
                                           turn(q[0], q[1], at)};
                const bool within =
                    (e[0] > 0 && e[1] > 0 && e[2] > 0) || (e[0] < 0 && e[1] < 0 && e[2] < 0);
                const double depth = (static_cast<double>(e[0]) * double{z[0]} +
                                      static_cast<double>(e[1]) * double{z[1]} +
                                      static_cast<double>(e[2]) * double{z[2]}) /
                                     static_cast<double>(area);
                if (within && depth > 0 && depth < 1) {
                    expected[y * width + x].push_back(depth);
                }
            }
        }
        // Those with a centre on an edge are left out: who owns it is another test's matter.
        for (std::uint32_t p = 0; p < width * height && area != 0; ++p) {
            const quarters at{4 * std::int64_t{p % width} + 2, 4 * std::int64_t{p / width} + 2};
            const std::int64_t e[3] = {turn(q[1], q[2], at), turn(q[2], q[0], at),
                                       turn(q[0], q[1], at)};
            if (e[0] == 0 || e[1] == 0 || e[2] == 0) {
                expected[p].push_back(std::numeric_limits<double>::quiet_NaN());
            }
        }
    }
    device d = with_threads(2);
    const auto all = layers_of(d, corners, width, height, range{0, 300});
    std::size_t compared = 0;
    for (std::size_t p = 0; p < expected.size(); ++p) {
        std::vector<double>& depths = expected[p];
        if (std::any_of(depths.begin(), depths.end(), [](double z) { return z != z; })) {
            continue;
        }
        std::sort(depths.begin(), depths.end(), std::greater<>());
        for (std::size_t l = 0; l < all.size(); ++l) {
            // A depth's slope over the raster is below 1e3 in some slivers, its float steps 1e-7.
            ASSERT_NEAR(double{all[l].depth[p]}, l < depths.size() ? depths[l] : 0.0, 2e-5)
                << p << ' ' << l;
            ASSERT_EQ(all[l].triangle[p] == 0xffffffffu, l >= depths.size());
        }
        ASSERT_LE(depths.size(), all.size());
        ++compared;
    }
    EXPECT_GT(compared, expected.size() / 3);
}

TEST(peel, gives_a_shared_edge_to_one_triangle) {
    // A fan around a centre on a pixel's middle, every corner on a pixel's middle.
    const quarters centre{4 * 30 + 2, 4 * 14 + 2};
    const quarters rim[] = {{122 + 40, 58},      {122 + 40, 58 + 40}, {122, 58 + 40},
                            {122 - 40, 58 + 40}, {122 - 40, 58},      {122 - 40, 58 - 40},
                            {122, 58 - 40},      {122 + 40, 58 - 40}};
    std::vector<glm::vec4> corners;
    for (std::uint32_t k = 0; k < 8; ++k) {
        const float z = 0.1f + 0.1f * static_cast<float>(k); // each its own: none hides another
        for (const quarters q : {centre, rim[k], rim[(k + 1) % 8]}) {
            corners.push_back(clip_of(q, z, width, height));
        }
        if (k % 2 == 1) {
            std::swap(corners[corners.size() - 1], corners[corners.size() - 2]);
        }
    }
    device d = with_threads(1);
    const auto all = layers_of(d, corners, width, height, range{0, 8});
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0].count, 20u * 20u); // 20 × 20 pixels, without two of the four outer edges
}

TEST(peel, numbers_triangles_from_the_start_of_their_view_and_the_lowest_wins) {
    std::vector<glm::vec4> corners;
    for (int t = 0; t < 5; ++t) {
        for (const glm::vec2 at : {glm::vec2(-1, -1), glm::vec2(3, -1), glm::vec2(-1, 3)}) {
            corners.emplace_back(at.x, at.y, t == 1 ? 0.75f : 0.5f, 1.0f);
        }
    }
    device d = with_threads(3);
    const auto all = layers_of(d, corners, width, height, range{2, 3});
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0].count, width * height);
    for (const std::uint32_t triangle : all[0].triangle) {
        ASSERT_EQ(triangle, 2u);
    }
    EXPECT_EQ(layers_of(d, corners, width, height, range{0, 5}).size(), 2u);
}

TEST(peel, draws_no_depths_beyond_its_range_and_no_corners_that_are_no_numbers) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float huge = std::numeric_limits<float>::max();
    device d = with_threads(1);
    for (const float z : {0.0f, -0.5f, 1.0f, 1.5f, nan}) {
        const std::vector<glm::vec4> corners{{-1, -1, z, 1}, {3, -1, z, 1}, {-1, 3, z, 1}};
        EXPECT_TRUE(layers_of(d, corners, width, height, range{0, 1}).empty()) << z;
    }
    const std::vector<glm::vec4> odd{{nan, -1, 0.5f, 1},  {3, -1, 0.5f, 1}, {-1, 3, 0.5f, 1},
                                     {-1, -1, 0.5f, 1},   {3, -1, 0.5f, 1}, {1, -1, 0.5f, 1},
                                     {huge, -1, 0.5f, 1}, {3, 1, 0.5f, 1},  {-1, huge, 0.5f, 1}};
    for (const layer& l : layers_of(d, odd, width, height, range{0, 3})) {
        for (const std::uint32_t triangle : l.triangle) {
            ASSERT_TRUE(triangle == 2 || triangle == 0xffffffffu);
        }
    }
    EXPECT_TRUE(layers_of(d, odd, width, height, range{0, 0}).empty());
}

TEST(peel, gives_the_same_bits_for_any_number_of_threads) {
    random_source random(32);
    std::vector<glm::vec4> corners;
    for (int t = 0; t < 20'000; ++t) {
        const glm::vec2 at(random.between(-1.1, 1.1), random.between(-1.1, 1.1));
        for (int k = 0; k < 3; ++k) {
            corners.emplace_back(at.x + 0.05f * static_cast<float>(random.between(-1, 1)),
                                 at.y + 0.05f * static_cast<float>(random.between(-1, 1)),
                                 0.25f * static_cast<float>(random.below(5)), 1.0f);
        }
    }
    device one = with_threads(1);
    const auto expected = layers_of(one, corners, 333, 77, range{0, 20'000});
    EXPECT_GT(expected.size(), 2u);
    for (const std::uint32_t threads : {2u, 3u}) {
        device more = with_threads(threads);
        EXPECT_TRUE(layers_of(more, corners, 333, 77, range{0, 20'000}) == expected);
    }
}

} // namespace
