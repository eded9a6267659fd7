// Layers that are peeled off by the rasteriser, against planes whose depths are known.
#include "support.hpp"

namespace skybark::testing {
namespace {

using kernels::probe_peel;

static_assert(peels<device, probe_peel>);

class peeling : public both_ways {
  protected:
    /// A square from x0, y0 to x1, y1 in clip space, its depth growing by `slope` per unit of x
    /// from `z` at x = 0 on: triangles 2 n and 2 n + 1 of the n-th square.
    void add(float x0, float y0, float x1, float y1, float z, float slope = 0) {
        const glm::vec4 a{x0, y0, z + slope * x0, 0}, b{x1, y0, z + slope * x1, 0};
        const glm::vec4 c{x1, y1, z + slope * x1, 0}, d{x0, y1, z + slope * x0, 0};
        corners.insert(corners.end(), {a, b, c, a, c, d});
    }

    void begin(std::uint32_t w, std::uint32_t h) {
        width = w;
        height = h;
        in.emplace(upload(gpu(), corners));
        // Views that begin and end inside their buffers, to see whether anybody writes beside them.
        const std::size_t around = 64;
        depth.emplace(upload(gpu(), std::vector<float>(w * h + 2 * around, 1.0f)));
        number.emplace(upload(gpu(), std::vector<std::uint32_t>(w * h + 2 * around, 77u)));
        count.emplace(upload(gpu(), std::vector<count_record>(1, count_record{9, 9, {}})));
    }

    [[nodiscard]] peeled_layer<device> layer() const {
        return {width, height, view<device, float>(*depth, 64, std::uint64_t{width} * height),
                view<device, std::uint32_t>(*number, 64, std::uint64_t{width} * height),
                view<device>(*count)};
    }

    void record(vulkan::recorder& r, range triangles, probe_peel k = {}) const {
        r.peel(k, bound<probe_peel>{view<device>(*in)}, triangles, layer());
    }

    void peel(range triangles, probe_peel k = {}) {
        go(gpu(), [&](auto& r) { record(r, triangles, k); });
    }

    [[nodiscard]] std::vector<float> depths() {
        return download<float>(gpu(), *depth, std::size_t{width} * height, 64);
    }
    [[nodiscard]] std::vector<std::uint32_t> numbers() {
        return download<std::uint32_t>(gpu(), *number, std::size_t{width} * height, 64);
    }
    [[nodiscard]] std::uint32_t counted_pixels() {
        const count_record c = download<count_record>(gpu(), *count, 1)[0];
        EXPECT_EQ(c.written, c.required);
        return c.written;
    }
    void expect_untouched_around() {
        const std::size_t all = std::size_t{width} * height + 128;
        const auto d = download<float>(gpu(), *depth, all);
        const auto n = download<std::uint32_t>(gpu(), *number, all);
        for (std::size_t i = 0; i < 64; ++i) {
            ASSERT_TRUE(d[i] == 1.0f && d[all - 1 - i] == 1.0f && n[i] == 77 &&
                        n[all - 1 - i] == 77);
        }
    }

    std::uint32_t width = 0, height = 0;
    std::vector<glm::vec4> corners;
    std::optional<vulkan::buffer> in, depth, number, count;
};
INSTANTIATE_TEST_SUITE_P(vulkan, peeling, ::testing::Bool(), way_name);

TEST_P(peeling, layers_come_from_far_to_near_until_there_is_none) {
    // In no order; depths are fractions of two, so that every step of the way is exact.
    const float z[] = {0.5f, 0.125f, 0.75f, 0.25f};
    for (const float one : z) {
        add(-1, -1, 1, 1, one);
    }
    begin(7, 5);
    for (const std::uint32_t square : {2u, 0u, 3u, 1u}) {
        peel({0, 8});
        EXPECT_EQ(depths(), std::vector<float>(35, z[square]));
        for (const std::uint32_t n : numbers()) {
            EXPECT_EQ(n / 2, square);
        }
        EXPECT_EQ(counted_pixels(), 35u);
    }
    for (int again = 0; again < 2; ++again) {
        peel({0, 8});
        EXPECT_EQ(depths(), std::vector<float>(35, 0.0f));
        EXPECT_EQ(numbers(), std::vector<std::uint32_t>(35, ~0u));
        EXPECT_EQ(counted_pixels(), 0u);
    }
    expect_untouched_around();
}

TEST_P(peeling, row_0_is_at_the_lowest_y_and_other_pixels_stay_empty) {
    add(-1, -1, 0, -0.5f, 0.5f); // 4 pixels of 8 across, 2 of 8 upwards
    begin(8, 8);
    peel({0, 2});
    const auto d = depths();
    const auto n = numbers();
    for (std::uint32_t y = 0; y < 8; ++y) {
        for (std::uint32_t x = 0; x < 8; ++x) {
            const bool inside = x < 4 && y < 2;
            EXPECT_EQ(d[y * 8 + x], inside ? 0.5f : 0.0f) << x << " " << y;
            EXPECT_EQ(n[y * 8 + x] == ~0u, !inside) << x << " " << y;
        }
    }
    EXPECT_EQ(counted_pixels(), 8u);
}

TEST_P(peeling, slopes_are_met_at_the_middles_of_pixels) {
    // Two slopes that cross in the middle: which is the farther one changes there.
    add(-1, -1, 1, 1, 0.5f, 0.3f);
    add(-1, -1, 1, 1, 0.5f, -0.3f);
    begin(64, 3);
    for (const bool far : {true, false}) {
        peel({0, 4});
        const auto d = depths();
        const auto n = numbers();
        for (std::uint32_t i = 0; i < 64 * 3; ++i) {
            const double x = (i % 64 + 0.5) / 32 - 1;
            const double expected = 0.5 + (far ? 0.3 : -0.3) * std::abs(x);
            // Four roundings of numbers below 1, and llvmpipe's own way to interpolate.
            EXPECT_NEAR(d[i], expected, 1e-6);
            EXPECT_EQ(n[i] / 2, (x > 0) == far ? 0u : 1u);
        }
        EXPECT_EQ(counted_pixels(), 192u);
    }
    peel({0, 4});
    EXPECT_EQ(counted_pixels(), 0u);
}

TEST_P(peeling, many_slopes_lose_no_layer_and_show_none_twice) {
    // What is compared must be what was kept, bit for bit: else a layer is seen again, or its
    // neighbour is lost.
    noise random;
    const std::uint32_t layers = 24;
    for (std::uint32_t i = 0; i < layers; ++i) {
        add(-1, -1, 1, 1, 0.25f + 0.5f * random.unit(), 0.4f * (random.unit() - 0.5f));
    }
    begin(33, 17);
    std::vector<std::vector<std::uint32_t>> seen(33 * 17);
    std::vector<float> last(33 * 17, 1.0f);
    for (std::uint32_t i = 0; i < layers; ++i) {
        peel({0, 2 * layers});
        const auto d = depths();
        const auto n = numbers();
        for (std::size_t p = 0; p < d.size(); ++p) {
            ASSERT_LT(d[p], last[p]);
            seen[p].push_back(n[p] / 2);
        }
        last = d;
        EXPECT_EQ(counted_pixels(), 33u * 17u) << i;
    }
    for (auto& squares : seen) {
        std::sort(squares.begin(), squares.end());
        for (std::uint32_t i = 0; i < layers; ++i) {
            ASSERT_EQ(squares[i], i);
        }
    }
}

TEST_P(peeling, takes_a_range_of_triangles_and_its_parameters) {
    for (const float z : {0.25f, 0.5f, 0.75f}) {
        add(-1, -1, 1, 1, z);
    }
    begin(4, 4);
    peel({2, 2}, probe_peel{{1, 1, 0.5f, 0}, {0, 0, 0.125f, 0}});
    EXPECT_EQ(depths(), std::vector<float>(16, 0.375f));
    for (const std::uint32_t n : numbers()) {
        EXPECT_EQ(n / 2, 1u);
    }
    peel({0, 0});
    EXPECT_EQ(counted_pixels(), 0u);
    EXPECT_EQ(depths(), std::vector<float>(16, 0.0f));
}

TEST_P(peeling, what_lies_beyond_the_depths_or_is_no_number_is_not_drawn) {
    const float none = std::numeric_limits<float>::quiet_NaN();
    add(-1, -1, 1, 1, 1.5f);
    add(-1, -1, 1, 1, -0.5f);
    add(-1, -1, 1, 1, 0.0f);
    add(-1, -1, 1, 1, 1.0f); // not nearer than 1
    corners.insert(corners.end(), 3, glm::vec4(none, none, none, 0));
    corners.insert(corners.end(), 3, glm::vec4(0.1f, 0.1f, 0.5f, 0)); // a point
    begin(4, 4);
    peel({0, 10});
    EXPECT_EQ(counted_pixels(), 0u);
    EXPECT_EQ(depths(), std::vector<float>(16, 0.0f));
}

TEST_P(peeling, both_sides_of_triangles_are_drawn) {
    add(-1, -1, 1, 1, 0.5f);
    std::swap(corners[0], corners[1]);
    begin(16, 16);
    peel({0, 2});
    EXPECT_EQ(counted_pixels(), 256u);
}

TEST_P(peeling, several_layers_of_several_sizes_go_into_one_recorder) {
    for (const float z : {0.25f, 0.5f, 0.75f}) {
        add(-1, -1, 1, 1, z);
    }
    begin(40, 9);
    const auto small = upload(gpu(), std::vector<float>(12, 1.0f));
    const auto small_number = must(gpu().create_buffer(12 * 4));
    const auto small_count = must(gpu().create_buffer(16));
    go(gpu(), [&](auto& r) {
        record(r, {0, 6});
        r.peel(probe_peel{}, bound<probe_peel>{view<device>(*in)}, range{0, 4},
               peeled_layer<device>{3, 4, view<device>(small), view<device>(small_number),
                                    view<device>(small_count)});
        record(r, {0, 6});
    });
    EXPECT_EQ(depths(), std::vector<float>(360, 0.5f));
    EXPECT_EQ(counted_pixels(), 360u);
    EXPECT_EQ(download<float>(gpu(), small, 12), std::vector<float>(12, 0.5f));
    EXPECT_EQ(download<count_record>(gpu(), small_count, 1)[0].written, 12u);
}

} // namespace
} // namespace skybark::testing
