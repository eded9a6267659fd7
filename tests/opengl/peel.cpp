// peel: every layer against fragments found in double precision, until none is left.

#include "support.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

namespace skybark::opengl::tests {
namespace {

using kernels::probe_peel;

static_assert(peels<gpu, probe_peel>);
static_assert(peels<gpu, kernels::bundle_corner>);

constexpr std::uint32_t none = 0xffffffffu;
constexpr std::uint32_t guard = 0x3f4dcafeu;
/// Words before and after a view: a multiple of any view's alignment.
constexpr std::uint32_t guards = 64;

struct fragment {
    double depth = 0;
    std::uint32_t triangle = none;
};

/// A raster, and what its layers are.
struct raster {
    std::uint32_t width = 0;
    std::uint32_t height = 0;

    [[nodiscard]] std::uint32_t pixels() const { return width * height; }
    [[nodiscard]] glm::dvec2 middle(std::uint32_t pixel) const {
        return {(pixel % width + 0.5) / width * 2 - 1, (pixel / width + 0.5) / height * 2 - 1};
    }
};

struct layer {
    std::vector<float> depth;
    std::vector<std::uint32_t> triangle;
    count_record count;
};

/// Corners of triangles, xyz in clip space.
using corners = std::vector<glm::vec4>;

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// The fragment of a triangle at a place, by barycentric coordinates; none where the place is
/// outside, `doubt` where it is within `margin` (clip units) of an edge or of an end of the depths.
std::optional<fragment> fragment_at(const corners& all, std::uint32_t t, glm::dvec2 place,
                                    double margin, bool& doubt) {
    const glm::dvec3 a(all[3 * t]);
    const glm::dvec3 b(all[3 * t + 1]);
    const glm::dvec3 c(all[3 * t + 2]);
    const double area = cross(glm::dvec2(b) - glm::dvec2(a), glm::dvec2(c) - glm::dvec2(a));
    const glm::dvec3 corner[] = {a, b, c};
    double weight[3] = {};
    bool inside = true;
    for (int i = 0; i < 3; ++i) {
        const glm::dvec2 p(corner[(i + 1) % 3]);
        const glm::dvec2 q(corner[(i + 2) % 3]);
        weight[i] = cross(q - p, place - p) / area;
        const double distance = weight[i] * std::abs(area) / glm::length(q - p);
        inside = inside && distance > -margin;
        doubt = doubt || std::abs(distance) < margin;
    }
    const double depth = weight[0] * a.z + weight[1] * b.z + weight[2] * c.z;
    if (!inside || depth <= 0 || depth >= 1) {
        return {};
    }
    return fragment{depth, t};
}

class peel_test : public device_test {
  protected:
    /// Peels triangles [first, first + count) until a layer is empty, which comes last.
    std::vector<layer> peel_all(const corners& all, const raster& size, range triangles) {
        const buffer vertices = make(all);
        std::vector<float> ones(size.pixels() + 2 * guards, 1.0f);
        const buffer depth = make(ones);
        const std::vector<std::uint32_t> words(size.pixels() + 2 * guards, guard);
        const buffer number = make(words);
        const buffer count = make(std::vector<count_record>(3, {guard, guard, {guard, guard}}));
        std::vector<layer> layers;
        const peeled_layer<gpu> out{size.width, size.height,
                                    view<gpu, float>(depth, guards, size.pixels()),
                                    view<gpu, std::uint32_t>(number, guards, size.pixels()),
                                    view<gpu, count_record>(count, 1, 1)};
        do {
            run([&](recorder& r) { r.peel(probe_peel{}, {view<gpu>(vertices)}, triangles, out); });
            layer got;
            got.depth = inside(read<float>(depth, ones.size()), 1.0f);
            got.triangle = inside(read<std::uint32_t>(number, words.size()), guard);
            const auto counts = read<count_record>(count, 3);
            EXPECT_EQ(counts[0].written, guard);
            EXPECT_EQ(counts[2].written, guard);
            got.count = counts[1];
            layers.push_back(std::move(got));
        } while (layers.back().count.written != 0 && layers.size() < 1000);
        return layers;
    }
    /// What lies between the guards, which nobody may have touched.
    template <class T>
    static std::vector<T> inside(const std::vector<T>& words, T untouched) {
        for (std::size_t i = 0; i < guards; ++i) {
            EXPECT_EQ(words[i], untouched);
            EXPECT_EQ(words[words.size() - 1 - i], untouched);
        }
        return {words.begin() + guards, words.end() - guards};
    }
    /// Depths fall from layer to layer, no triangle comes twice to a pixel, counts are right, and
    /// what is empty stays so.
    static void expect_layers(const std::vector<layer>& layers) {
        ASSERT_FALSE(layers.empty());
        for (std::size_t p = 0; p < layers[0].depth.size(); ++p) {
            float before = 1;
            std::vector<std::uint32_t> seen;
            for (const layer& each : layers) {
                const float depth = each.depth[p];
                ASSERT_EQ(depth == 0, each.triangle[p] == none) << p;
                ASSERT_TRUE(depth < before || (depth == 0 && before == 0)) << p;
                before = depth;
                if (depth > 0) {
                    ASSERT_EQ(std::count(seen.begin(), seen.end(), each.triangle[p]), 0) << p;
                    seen.push_back(each.triangle[p]);
                }
            }
        }
        for (const layer& each : layers) {
            const auto drawn = each.triangle.size() -
                               static_cast<std::size_t>(
                                   std::count(each.triangle.begin(), each.triangle.end(), none));
            EXPECT_EQ(each.count.written, drawn);
            EXPECT_EQ(each.count.required, drawn);
        }
        EXPECT_EQ(layers.back().count.written, 0u);
    }
    /// The layers of each pixel are the fragments found in double precision, sorted. Pixels are
    /// left out whose middles come within 1/100 pixel of an edge (rasterisers snap corners to 1/256
    /// of one and more), or where two depths are closer than rounding makes them different.
    static void expect_fragments(const std::vector<layer>& layers, const corners& all,
                                 const raster& size, range triangles) {
        const double margin = 0.01 * 2 / std::min(size.width, size.height);
        // Corners move by 1/512 pixel, and depths with them, by as much as they rise there.
        const double rounding = 2e-4;
        std::size_t compared = 0;
        for (std::uint32_t p = 0; p < size.pixels(); ++p) {
            std::vector<fragment> expected;
            bool doubt = false;
            for (std::uint32_t t = triangles.first; t < triangles.first + triangles.count; ++t) {
                if (const auto f = fragment_at(all, t, size.middle(p), margin, doubt)) {
                    expected.push_back(*f);
                }
            }
            std::sort(expected.begin(), expected.end(),
                      [](const fragment& a, const fragment& b) { return a.depth > b.depth; });
            for (std::size_t i = 1; i < expected.size(); ++i) {
                doubt = doubt || expected[i - 1].depth - expected[i].depth < 2 * rounding;
            }
            if (doubt) {
                continue;
            }
            ++compared;
            ASSERT_GT(layers.size(), expected.size());
            for (std::size_t i = 0; i < layers.size(); ++i) {
                const bool there = i < expected.size();
                ASSERT_EQ(layers[i].triangle[p], there ? expected[i].triangle : none)
                    << p << ", layer " << i;
                ASSERT_NEAR(layers[i].depth[p], there ? expected[i].depth : 0, rounding)
                    << p << ", layer " << i;
            }
        }
        EXPECT_GT(compared, size.pixels() / 2);
    }
    static corners random_triangles(std::uint32_t n, double steep, std::uint32_t seed) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<float> place(-1.1f, 1.1f);
        std::uniform_real_distribution<float> depth(0.1f, 0.9f);
        std::uniform_real_distribution<float> rise(static_cast<float>(-steep),
                                                   static_cast<float>(steep));
        corners all;
        for (std::uint32_t t = 0; t < n; ++t) {
            const float middle = depth(random);
            for (int k = 0; k < 3; ++k) {
                const float x = place(random);
                const float y = place(random);
                all.emplace_back(x, y, middle + rise(random), 1.0f);
            }
        }
        return all;
    }
};

TEST_F(peel_test, every_layer_of_triangles_that_cross) {
    const raster size{61, 47};
    const corners all = random_triangles(40, 0.1, 1);
    const auto layers = peel_all(all, size, {0, 40});
    EXPECT_GT(layers.size(), 5u);
    expect_layers(layers);
    expect_fragments(layers, all, size, {0, 40});
}

TEST_F(peel_test, of_a_range_of_triangles) {
    const raster size{33, 64};
    const corners all = random_triangles(30, 0.1, 2);
    const auto layers = peel_all(all, size, {7, 11});
    expect_layers(layers);
    expect_fragments(layers, all, size, {7, 11});
}

TEST_F(peel_test, depths_that_rise_beyond_both_ends) {
    const raster size{64, 64};
    const corners all = random_triangles(60, 3, 3);
    const auto layers = peel_all(all, size, {0, 60});
    EXPECT_GT(layers.size(), 3u);
    expect_layers(layers);
}

/// Two triangles that fill a rectangle, at one depth.
void add_rectangle(corners& all, glm::vec2 low, glm::vec2 high, float depth) {
    const glm::vec4 a(low.x, low.y, depth, 1);
    const glm::vec4 b(high.x, low.y, depth, 1);
    const glm::vec4 c(low.x, high.y, depth, 1);
    const glm::vec4 d(high.x, high.y, depth, 1);
    for (const glm::vec4& corner : {a, b, c, c, b, d}) {
        all.push_back(corner);
    }
}

TEST_F(peel_test, row_0_is_at_the_lower_end) {
    corners all;
    add_rectangle(all, {-1, -1}, {0, -0.5f}, 0.25f);
    const auto layers = peel_all(all, {8, 8}, {0, 2});
    ASSERT_EQ(layers.size(), 2u);
    for (std::uint32_t p = 0; p < 64; ++p) {
        const bool drawn = p % 8 < 4 && p / 8 < 2;
        EXPECT_EQ(layers[0].depth[p], drawn ? 0.25f : 0.0f) << p;
    }
    EXPECT_EQ(layers[0].count.written, 8u);
}

TEST_F(peel_test, a_shared_edge_is_one_layer_and_so_are_equal_depths) {
    corners all;
    add_rectangle(all, {-1, -1}, {1, 1}, 0.5f);
    add_rectangle(all, {-1, -1}, {1, 1}, 0.5f);
    const auto layers = peel_all(all, {50, 50}, {0, 4});
    ASSERT_EQ(layers.size(), 2u);
    EXPECT_EQ(layers[0].count.written, 2500u);
    expect_layers(layers);
}

TEST_F(peel_test, nothing_at_the_ends_of_the_depths_or_beyond) {
    corners all;
    for (const float depth : {-0.5f, 0.0f, 1.0f, 1.5f, 1e-30f}) {
        add_rectangle(all, {-1, -1}, {1, 1}, depth);
    }
    const auto layers = peel_all(all, {4, 4}, {0, 10});
    ASSERT_EQ(layers.size(), 2u);
    EXPECT_EQ(layers[0].depth, std::vector<float>(16, 1e-30f));
}

TEST_F(peel_test, of_no_triangles_is_empty) {
    const auto layers = peel_all({glm::vec4(0)}, {5, 3}, {0, 0});
    ASSERT_EQ(layers.size(), 1u);
    EXPECT_EQ(layers[0].depth, std::vector<float>(15, 0.0f));
    EXPECT_EQ(layers[0].triangle, std::vector<std::uint32_t>(15, none));
}

TEST_F(peel_test, of_no_pixels_counts_none) {
    const buffer words = make(std::vector<std::uint32_t>(64, guard));
    run([&](recorder& r) {
        r.peel(probe_peel{}, {view<gpu>(words)}, {0, 5},
               {0, 7, {}, {}, view<gpu, count_record>(words, 0, 1)});
    });
    EXPECT_EQ(read<std::uint32_t>(words, 5), (std::vector<std::uint32_t>{0, 0, 0, 0, guard}));
}

TEST_F(peel_test, two_layers_in_one_recorder_and_other_sizes_in_turn) {
    corners all;
    for (const float depth : {0.25f, 0.75f, 0.5f}) {
        add_rectangle(all, {-1, -1}, {1, 1}, depth);
    }
    const buffer vertices = make(all);
    for (const std::uint32_t side : {16u, 5u, 16u}) {
        const buffer depth = make(std::vector<float>(side * side, 1.0f));
        const buffer number = zeros(side * side * 4);
        const buffer count = zeros(16);
        const peeled_layer<gpu> out{side, side, view<gpu>(depth), view<gpu>(number),
                                    view<gpu>(count)};
        run([&](recorder& r) {
            r.peel(probe_peel{}, {view<gpu>(vertices)}, {0, 6}, out);
            r.peel(probe_peel{}, {view<gpu>(vertices)}, {0, 6}, out);
        });
        EXPECT_EQ(read<float>(depth, side * side), std::vector<float>(side * side, 0.5f));
    }
}

} // namespace
} // namespace skybark::opengl::tests
