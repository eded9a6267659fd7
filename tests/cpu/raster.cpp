// The rasteriser against exact arithmetic: which pixels a triangle covers, and what they get.

#include "support/cpu_work.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

using namespace skybark;
using glm::dvec2;
using glm::dvec3;
using glm::dvec4;
using glm::vec4;
using kernels::probe_vertex;

namespace {

/// Draws and looks at the pixels.
class canvas {
  public:
    canvas(std::uint32_t width, std::uint32_t height)
        : width_(width), height_(height),
          color_(
              support::expect_value(device_.create_image({width, height, image_format::rgba32f}))),
          depth_(support::expect_value(
              device_.create_image({width, height, image_format::depth32f}))) {
        draw({}, {}, {vec4(0), 1.0f});
    }

    struct clears {
        std::optional<vec4> color;
        std::optional<float> depth;
    };

    void draw(const std::vector<probe_vertex>& vertices, draw_state state, clears first = {}) {
        using B = cpu::device;
        const auto buffer = support::expect_value(make_buffer<B, probe_vertex>(device_, vertices));
        const vec4 white(1);
        const auto tints =
            support::expect_value(make_buffer<B, vec4>(device_, std::span(&white, 1)));
        draw_geometry<B> geometry;
        geometry.count = static_cast<std::uint32_t>(vertices.size());
        kernels::probe_surface kernel;
        kernel.cutoff = -1e30f;
        auto r = support::expect_value(device_.begin());
        r.draw(kernel, {view<B>(buffer), view<B>(tints)}, {}, geometry,
               draw_target<B>{&color_, &depth_, first.color, first.depth}, state);
        ASSERT_TRUE(device_.submit(r));
    }

    /// Adds `vertices` up: a colour without alpha under alpha blending, no depth test.
    void add(const std::vector<probe_vertex>& vertices) {
        draw_state state;
        state.depth_test = false;
        state.depth_write = false;
        state.blend = blend_mode::alpha;
        draw(vertices, state);
    }

    [[nodiscard]] vec4 color(std::uint32_t x, std::uint32_t y) const {
        vec4 value;
        std::memcpy(&value, color_.data() + (std::size_t{y} * width_ + x) * 16, sizeof value);
        return value;
    }
    /// How often a pixel has been covered by triangles of colour (1, 0, 0, 0): its weights add up
    /// to 1 but for a few roundings.
    [[nodiscard]] long times(std::uint32_t x, std::uint32_t y) const {
        const float sum = color(x, y).x;
        EXPECT_NEAR(sum, std::round(sum), 1e-5f);
        return std::lround(sum);
    }
    [[nodiscard]] float depth(std::uint32_t x, std::uint32_t y) const {
        float value = 0;
        std::memcpy(&value, depth_.data() + (std::size_t{y} * width_ + x) * 4, sizeof value);
        return value;
    }
    [[nodiscard]] std::uint32_t width() const { return width_; }
    [[nodiscard]] std::uint32_t height() const { return height_; }

    /// Clip coordinates of a place in pixels, y down. Exact for sides of 2^n and 1/256 pixels.
    [[nodiscard]] vec4 at(dvec2 pixel, double z = 0.5, double w = 1) const {
        return vec4(
            dvec4((pixel.x / width_ * 2 - 1) * w, (1 - pixel.y / height_ * 2) * w, z * w, w));
    }

  private:
    cpu::device device_;
    std::uint32_t width_, height_;
    cpu::image color_, depth_;
};

constexpr vec4 one(1, 0, 0, 0);

/// Whether a pixel's centre is in a triangle, in exact integers (1/256 pixel): a centre on an edge
/// counts as if it lay a touch further right, or, on a level edge, further down. That is the
/// top-left rule, said another way.
bool covers(const std::int64_t (&x)[3], const std::int64_t (&y)[3], std::int64_t px,
            std::int64_t py) {
    int positive = 0;
    int negative = 0;
    for (int i = 0; i < 3; ++i) {
        const int k = (i + 1) % 3;
        const std::int64_t dx = x[k] - x[i];
        const std::int64_t dy = y[k] - y[i];
        std::int64_t side = dx * (py - y[i]) - dy * (px - x[i]);
        if (side == 0) {
            side = dy != 0 ? -dy : dx;
        }
        positive += side > 0 ? 1 : 0;
        negative += side < 0 ? 1 : 0;
    }
    return positive == 3 || negative == 3;
}

} // namespace

TEST(raster, covers_the_pixels_that_exact_arithmetic_says) {
    support::random_source random(1);
    // Coarse grids put centres on edges and corners again and again.
    for (const std::int64_t grid : {128, 64, 1}) {
        for (int i = 0; i < 400; ++i) {
            canvas target(32, 64);
            std::int64_t x[3], y[3];
            std::vector<probe_vertex> vertices;
            for (int k = 0; k < 3; ++k) {
                // Beyond the image on every side as well.
                x[k] = static_cast<std::int64_t>(
                           random.below(static_cast<std::uint32_t>(48 * 256 / grid))) *
                           grid -
                       8 * 256;
                y[k] = static_cast<std::int64_t>(
                           random.below(static_cast<std::uint32_t>(80 * 256 / grid))) *
                           grid -
                       8 * 256;
                vertices.push_back(
                    {target.at(dvec2(static_cast<double>(x[k]), static_cast<double>(y[k])) / 256.0),
                     one});
            }
            const bool flat = (x[1] - x[0]) * (y[2] - y[0]) == (x[2] - x[0]) * (y[1] - y[0]);
            target.add(vertices);
            for (std::uint32_t py = 0; py < 64; ++py) {
                for (std::uint32_t px = 0; px < 32; ++px) {
                    const bool expected = !flat && covers(x, y, std::int64_t{px} * 256 + 128,
                                                          std::int64_t{py} * 256 + 128);
                    ASSERT_EQ(target.times(px, py), expected ? 1 : 0)
                        << px << ", " << py << " of triangle " << i << " on grid " << grid;
                }
            }
        }
    }
}

TEST(raster, rectangle_on_pixel_centres_has_its_top_and_left) {
    canvas target(16, 16);
    const dvec2 low(2.5, 4.5), high(7.5, 9.5);
    const vec4 a = target.at(low), b = target.at({high.x, low.y}), c = target.at(high),
               d = target.at({low.x, high.y});
    target.add({{a, one}, {d, one}, {c, one}, {a, one}, {c, one}, {b, one}});
    for (std::uint32_t y = 0; y < 16; ++y) {
        for (std::uint32_t x = 0; x < 16; ++x) {
            const bool inside = x >= 2 && x < 7 && y >= 4 && y < 9;
            EXPECT_EQ(target.times(x, y), inside ? 1 : 0) << x << ", " << y;
        }
    }
}

// A grid of triangles with moved corners (by less than a quarter, so that none turns over), wound
// either way, split along either diagonal, over the edges of the image: every pixel once.
TEST(raster, neighbours_neither_overlap_nor_leave_a_gap) {
    support::random_source random(2);
    for (const std::uint32_t side : {64u, 61u, 200u}) {
        canvas target(side, side);
        constexpr int cells = 37;
        std::vector<dvec2> corners;
        for (int j = 0; j <= cells; ++j) {
            for (int i = 0; i <= cells; ++i) {
                const double step = (side + 6.0) / cells;
                corners.push_back(dvec2(i, j) * step - 3.0 +
                                  0.24 * step *
                                      dvec2(random.between(-1, 1), random.between(-1, 1)));
            }
        }
        std::vector<probe_vertex> vertices;
        const auto corner = [&](int i, int j) {
            vertices.push_back(
                {target.at(corners[static_cast<std::size_t>(j * (cells + 1) + i)]), one});
        };
        for (int j = 0; j < cells; ++j) {
            for (int i = 0; i < cells; ++i) {
                if (random.below(2) == 0) {
                    corner(i, j), corner(i + 1, j), corner(i, j + 1);
                    corner(i + 1, j + 1), corner(i + 1, j), corner(i, j + 1);
                } else {
                    corner(i, j), corner(i + 1, j), corner(i + 1, j + 1);
                    corner(i, j), corner(i + 1, j + 1), corner(i, j + 1);
                }
            }
        }
        target.add(vertices);
        for (std::uint32_t y = 0; y < side; ++y) {
            for (std::uint32_t x = 0; x < side; ++x) {
                ASSERT_EQ(target.times(x, y), 1) << x << ", " << y << " of " << side;
            }
        }
    }
}

TEST(raster, varyings_are_perspective_correct) {
    support::random_source random(3);
    for (int i = 0; i < 500; ++i) {
        canvas target(64, 64);
        dvec2 p[3];
        double w[3];
        dvec4 varying[3];
        std::vector<probe_vertex> vertices;
        for (int k = 0; k < 3; ++k) {
            p[k] = {random.below(64 * 256) / 256.0, random.below(64 * 256) / 256.0};
            w[k] = std::exp2(static_cast<double>(random.below(6)) - 2); // exact to divide by
            varying[k] = {random.between(-1, 1), random.between(-1, 1), random.between(-1, 1), 1};
            vertices.push_back({target.at(p[k], 0.5, w[k]), vec4(varying[k])});
        }
        const auto cross = [](dvec2 a, dvec2 b) { return a.x * b.y - a.y * b.x; };
        const double area = cross(p[1] - p[0], p[2] - p[0]);
        if (std::abs(area) < 4) {
            continue; // the weights of slivers are ill-conditioned
        }
        target.draw(vertices, draw_state{});
        for (std::uint32_t y = 0; y < 64; ++y) {
            for (std::uint32_t x = 0; x < 64; ++x) {
                const vec4 seen = target.color(x, y);
                if (seen == vec4(0)) {
                    continue;
                }
                const dvec2 c(x + 0.5, y + 0.5);
                dvec4 sum(0);
                double of = 0;
                for (int k = 0; k < 3; ++k) {
                    const double b = cross(p[(k + 1) % 3] - c, p[(k + 2) % 3] - c) / area;
                    sum += varying[k] * b / w[k];
                    of += b / w[k];
                }
                // Screen weights carry three roundings of 1, over 1/w that differ by up to 32.
                for (int k = 0; k < 4; ++k) {
                    ASSERT_NEAR(seen[k], (sum / of)[k], 32 * 6 * 5.97e-8) << x << ", " << y;
                }
            }
        }
    }
}

// The ground: two triangles from behind the eye to far beyond the far plane. Each pixel's own ray
// meets the plane in double precision. Corners are rounded to 1/512 of a pixel, and so is the
// picture: what is seen must lie between what the pixel's surroundings of that size see.
TEST(raster, ground_through_the_near_plane_is_where_the_rays_meet_it) {
    constexpr double near = 0.1, far = 1000, focal = 1.5, eye = 1.7, extent = 5000;
    for (const double tilt : {0.0, -0.3, -1.0}) {
        canvas target(128, 96);
        const double aspect = 128.0 / 96;
        const auto clip = [&](const dvec3& world) {
            const dvec3 v = world - dvec3(0, eye, 0);
            const dvec3 camera(v.x, std::cos(tilt) * v.y + std::sin(tilt) * v.z,
                               std::cos(tilt) * v.z - std::sin(tilt) * v.y);
            const double w = -camera.z;
            return vec4(dvec4(camera.x * focal / aspect, camera.y * focal,
                              far / (far - near) * (w - near), w));
        };
        std::vector<probe_vertex> vertices;
        for (const int corner : {0, 1, 2, 2, 1, 3}) {
            const dvec3 world((corner & 1) != 0 ? extent : -extent, 0,
                              (corner & 2) != 0 ? -extent : extent);
            vertices.push_back({clip(world), vec4(dvec4(world, 1))});
        }
        target.draw(vertices, draw_state{});
        struct seen {
            dvec3 world;
            double w;
        };
        // Where the ray through a place of the picture meets the ground; w ≤ 0: nowhere.
        const auto meet = [&](dvec2 pixel) -> seen {
            const double x = (pixel.x / 128 * 2 - 1) * aspect / focal;
            const double y = (1 - pixel.y / 96 * 2) / focal;
            const dvec3 ray(x, std::cos(tilt) * y + std::sin(tilt),
                            -std::cos(tilt) + std::sin(tilt) * y);
            const double w = ray.y < 0 ? eye / -ray.y : -1;
            return {dvec3(0, eye, 0) + ray * w, w};
        };
        int covered = 0;
        for (std::uint32_t y = 0; y < 96; ++y) {
            for (std::uint32_t x = 0; x < 128; ++x) {
                const dvec2 centre(x + 0.5, y + 0.5);
                const dvec2 r(1.0 / 256);
                const seen middle = meet(centre);
                const seen nearer = meet(centre + dvec2(0, r.y));
                const seen further = meet(centre - dvec2(0, r.y));
                const vec4 color = target.color(x, y);
                if (further.w <= 0 || further.w > far * 0.99) {
                    continue; // the horizon
                }
                ++covered;
                // Three weights, each rounded twice, of corners that lie `extent` away.
                const double weights = 6 * extent * 5.97e-8;
                const double slack = 3 * (further.w - nearer.w) + weights + 1e-5 * middle.w;
                ASSERT_NEAR(color.w, 1, 1e-6f) << x << ", " << y;
                ASSERT_NEAR(color.y, 0, slack) << x << ", " << y;
                ASSERT_NEAR(color.z, middle.world.z, slack) << x << ", " << y;
                ASSERT_NEAR(color.x, middle.world.x,
                            slack * (1 + std::abs(middle.world.x) / middle.w))
                    << x << ", " << y;
                const double z = far / (far - near) * (1 - near / middle.w);
                // The corners' own z, some 5000, is rounded before anybody clips it.
                const double z_slack = far / (far - near) * near / (middle.w * middle.w) * slack +
                                       extent * 5.97e-8 / middle.w + 3 * 5.97e-8;
                ASSERT_NEAR(target.depth(x, y), z, z_slack) << x << ", " << y;
            }
        }
        EXPECT_GT(covered, 2000);
    }
}

// The same where neighbours go through the near plane: what one edge is cut to, the other is too.
TEST(raster, neighbours_that_are_clipped_neither_overlap_nor_leave_a_gap) {
    support::random_source random(6);
    for (int round = 0; round < 60; ++round) {
        canvas target(128, 128);
        const double tilt = random.between(-0.3, 0.3);
        const auto corner = [&](dvec2 place) {
            // The plane y = −1 + tilt x, looking along −z, near plane at 0.1.
            const double w = -place.y;
            return probe_vertex{vec4(dvec4(place.x, -1 + tilt * place.x, w - 0.1, w)), one};
        };
        constexpr int cells = 20;
        dvec2 places[cells + 1][cells + 1];
        for (int j = 0; j <= cells; ++j) {
            for (int i = 0; i <= cells; ++i) {
                places[j][i] = dvec2(i - cells / 2, j - cells / 2) * 5.0 +
                               1.2 * dvec2(random.between(-1, 1), random.between(-1, 1));
            }
        }
        std::vector<probe_vertex> vertices;
        for (int j = 0; j < cells; ++j) {
            for (int i = 0; i < cells; ++i) {
                for (const dvec2& p : {places[j][i], places[j][i + 1], places[j + 1][i],
                                       places[j + 1][i], places[j][i + 1], places[j + 1][i + 1]}) {
                    vertices.push_back(corner(p));
                }
            }
        }
        target.add(vertices);
        // All that looks down by more than a touch meets the plane before it ends.
        for (std::uint32_t y = 0; y < 128; ++y) {
            for (std::uint32_t x = 0; x < 128; ++x) {
                const double dx = (x + 0.5) / 64 - 1, dy = 1 - (y + 0.5) / 64;
                if (dy - tilt * dx < -0.025) {
                    ASSERT_EQ(target.times(x, y), 1) << x << ", " << y << ", " << round;
                }
            }
        }
    }
}

TEST(raster, depth_of_a_plane_parallel_to_the_screen_is_exact) {
    support::random_source random(4);
    for (const float z : {0.0f, 0.1f, 0.333333f, 0.7f, 1.0f}) {
        canvas target(64, 64);
        std::vector<probe_vertex> vertices;
        for (int i = 0; i < 300; ++i) {
            vec4 p = target.at({random.between(-90, 154), random.between(-90, 154)});
            p.z = z;
            vertices.push_back({p, one});
        }
        // Each is as near as the others, and nearer or equal passes: all of them are seen.
        draw_state state;
        state.blend = blend_mode::alpha;
        target.draw(vertices, state, {vec4(0), 1.0f});
        canvas all(64, 64);
        all.add(vertices);
        for (std::uint32_t y = 0; y < 64; ++y) {
            for (std::uint32_t x = 0; x < 64; ++x) {
                const long n = all.times(x, y);
                ASSERT_EQ(target.depth(x, y), n > 0 ? z : 1.0f);
                ASSERT_EQ(target.times(x, y), n);
            }
        }
    }
}

// Depth as rendered is linear on the screen, whatever w is.
TEST(raster, depth_of_a_slanted_plane) {
    canvas target(64, 64);
    const dvec2 p[3] = {{-20, -10}, {90, 5}, {10, 100}};
    const double w[3] = {1, 4, 2};
    const double z[3] = {0.125, 0.5, 0.875};
    std::vector<probe_vertex> vertices;
    for (int k = 0; k < 3; ++k) {
        vertices.push_back({target.at(p[k], z[k], w[k]), one});
    }
    target.draw(vertices, draw_state{});
    const auto cross = [](dvec2 a, dvec2 b) { return a.x * b.y - a.y * b.x; };
    const double area = cross(p[1] - p[0], p[2] - p[0]);
    for (std::uint32_t y = 0; y < 64; ++y) {
        for (std::uint32_t x = 0; x < 64; ++x) {
            const dvec2 c(x + 0.5, y + 0.5);
            double expected = 0;
            bool inside = true;
            for (int k = 0; k < 3; ++k) {
                const double b = cross(p[(k + 1) % 3] - c, p[(k + 2) % 3] - c) / area;
                expected += b * z[k];
                inside = inside && b > 0;
            }
            ASSERT_NEAR(target.depth(x, y), inside ? expected : 1, 5 * 5.97e-8);
        }
    }
}

TEST(raster, what_has_no_area_draws_nothing) {
    canvas target(16, 16);
    const vec4 a = target.at({2, 2}), b = target.at({9, 12}), middle = target.at({5.5, 7});
    target.add({{a, one},
                {a, one},
                {a, one},
                {a, one},
                {b, one},
                {a, one},
                {a, one},
                {b, one},
                {middle, one}});
    // Closer than 1/256 pixel to one another: gone, not a pixel too many.
    target.add({{target.at({5.5, 5.5}), one},
                {target.at({5.5005, 5.5}), one},
                {target.at({5.5, 5.5005}), one}});
    for (std::uint32_t y = 0; y < 16; ++y) {
        for (std::uint32_t x = 0; x < 16; ++x) {
            EXPECT_EQ(target.color(x, y), vec4(0));
        }
    }
}

// Anything at all in the positions: no crash, no pixel outside, nothing that is not a number.
TEST(raster, survives_any_position) {
    support::random_source random(5);
    const float infinity = std::numeric_limits<float>::infinity();
    const float most = std::numeric_limits<float>::max();
    const float values[] = {
        0,      -0.0f,   1,        -1,        0.5f,
        most,   -most,   infinity, -infinity, std::numeric_limits<float>::quiet_NaN(),
        1e-45f, -1e-45f, 1e-38f,   1e20f,     -1e20f,
        1e38f,  16,      -16,      1e-6f};
    canvas target(33, 17);
    std::vector<probe_vertex> vertices;
    for (int i = 0; i < 300'000; ++i) {
        vec4 p;
        for (int k = 0; k < 4; ++k) {
            const std::uint32_t bits = random.bits();
            float any = 0;
            std::memcpy(&any, &bits, sizeof any);
            p[k] = random.below(4) == 0 ? any : values[random.below(std::size(values))];
        }
        vertices.push_back({p, {0.5f, 0.5f, 0.5f, 1}});
    }
    target.draw(vertices, draw_state{});
    for (std::uint32_t y = 0; y < target.height(); ++y) {
        for (std::uint32_t x = 0; x < target.width(); ++x) {
            ASSERT_GE(target.depth(x, y), 0);
            ASSERT_LE(target.depth(x, y), 1);
        }
    }
}

TEST(raster, positions_that_are_not_numbers_draw_nothing) {
    const float bad_values[] = {std::numeric_limits<float>::quiet_NaN(),
                                std::numeric_limits<float>::infinity()};
    for (const float bad : bad_values) {
        for (int component = 0; component < 4; ++component) {
            canvas target(8, 8);
            std::vector<probe_vertex> vertices{
                {target.at({-1, -1}), one}, {target.at({20, -1}), one}, {target.at({-1, 20}), one}};
            vertices[1].position[component] = bad;
            target.add(vertices);
            for (std::uint32_t i = 0; i < 64; ++i) {
                ASSERT_EQ(target.color(i % 8, i / 8), vec4(0));
            }
        }
    }
}

// A triangle that clips at every plane still covers what it covers unclipped, and keeps its side.
TEST(raster, far_beyond_the_guard_band) {
    for (const bool flipped : {false, true}) {
        canvas target(64, 64);
        std::vector<probe_vertex> vertices{{{-3e4f, -3e4f, 0.5f, 1}, one},
                                           {{3e4f, -2.9e4f, 0.5f, 1}, one},
                                           {{1e2f, 3.1e4f, 0.5f, 1}, one}};
        if (flipped) {
            std::swap(vertices[1], vertices[2]);
        }
        draw_state state;
        state.cull = cull_mode::back;
        target.draw(vertices, state);
        for (std::uint32_t i = 0; i < 64 * 64; ++i) {
            ASSERT_EQ(target.times(i % 64, i / 64), flipped ? 0 : 1);
        }
    }
}

// A small triangle anywhere: in the middle of a band of rows, or across two.
TEST(raster, small_triangles_are_found_in_every_row) {
    for (std::uint32_t row = 0; row < 100; ++row) {
        canvas target(8, 100);
        const double y = row;
        target.add(
            {{target.at({1, y}), one}, {target.at({1, y + 2}), one}, {target.at({3, y}), one}});
        for (std::uint32_t i = 0; i < 100; ++i) {
            ASSERT_EQ(target.times(1, i), i == row ? 1 : 0) << row;
        }
    }
}
