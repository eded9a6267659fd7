#pragma once
// Cases: draw. Expectations are hand-rasterised at pixel centres away from edges; GPUs may place a
// corner up to 1/16 pixel aside, so nothing is expected of centres nearer than 1/8 to an edge.

#include <skybark/conformance/images.hpp>
#include <skybark/kernels/probe_surface.hpp>

namespace skybark::conformance {

using vertex_list = std::vector<kernels::probe_vertex>;

inline constexpr glm::vec4 red{1, 0, 0, 1};
inline constexpr glm::vec4 green{0, 1, 0, 1};
inline constexpr glm::vec4 blue{0, 0, 1, 1};
inline constexpr glm::vec4 grey{0.25f, 0.25f, 0.25f, 0.25f};

inline void append(vertex_list& to, const vertex_list& more) {
    to.insert(to.end(), more.begin(), more.end());
}

/// An image to draw into, its depth, and the draws so far.
template <backend B>
class easel {
  public:
    easel(context<B>& c, image_description what, bool with_depth)
        : c_(c), color_(new_image(c, what)), what_(what) {
        target_.color = &color_;
        target_.clear_color = glm::vec4{0, 0, 0, 0};
        if (with_depth) {
            depth_.emplace(new_image(c, {what.width, what.height, image_format::depth32f}));
            target_.depth = &*depth_;
            target_.clear_depth = 1.0f;
        }
    }
    easel(const easel&) = delete;
    easel& operator=(const easel&) = delete;

    kernels::probe_surface kernel;
    draw_state state;

    [[nodiscard]] image_description what() const { return what_; }
    [[nodiscard]] draw_target<B>& target() { return target_; }

    /// Draws the vertices as they are; the next draw keeps what is there.
    void draw(const vertex_list& vertices) {
        draw_geometry<B> geometry;
        geometry.count = static_cast<std::uint32_t>(vertices.size());
        draw(vertices, geometry);
    }
    void draw(const vertex_list& vertices, const draw_geometry<B>& geometry) {
        const auto in = c_.put(vertices);
        const auto tints =
            c_.put(std::vector<glm::vec4>{{1, 1, 1, 1}, {0.5f, 2, 1, 1}, {1, 1, 1, 0.5f}});
        c_.run([&](auto& r) {
            r.draw(kernel, {in.view(), tints.view()}, {}, geometry, target_, state);
        });
        target_.clear_color.reset();
        target_.clear_depth.reset();
    }

    [[nodiscard]] picture color() const { return read_image(c_, color_); }
    [[nodiscard]] picture depth() const { return read_image(c_, *depth_); }

  private:
    context<B>& c_;
    typename B::image color_;
    std::optional<typename B::image> depth_;
    image_description what_;
    draw_target<B> target_;
};

/// A triangle in pixels, wound either way.
struct flat_triangle {
    glm::dvec2 a, b, c;

    /// How far inside a point lies: its distance from the nearest edge's line, negative outside.
    [[nodiscard]] double depth_inside(glm::dvec2 p) const {
        const double turn = cross(b - a, c - a) < 0 ? -1 : 1;
        const auto edge = [&](glm::dvec2 from, glm::dvec2 to) {
            const glm::dvec2 d = to - from;
            return turn * cross(d, p - from) / std::sqrt(d.x * d.x + d.y * d.y);
        };
        return std::fmin(edge(a, b), std::fmin(edge(b, c), edge(c, a)));
    }

  private:
    [[nodiscard]] static double cross(glm::dvec2 u, glm::dvec2 v) { return u.x * v.y - u.y * v.x; }
};

inline constexpr double edge_slack = 0.125;

template <backend B>
void draw_clear(context<B>& c, image_format format) {
    easel<B> e(c, {37, 21, format}, true);
    e.target().clear_color = glm::vec4{0.2f, 0.4f, 0.6f, 0.8f};
    e.target().clear_depth = 0.625f;
    e.draw({});
    comparison check = c.compare("channels after a clear");
    for (const glm::vec4& pixel : e.color().pixels) {
        check.close_to(pixel, {0.2f, 0.4f, 0.6f, 0.8f}, format == image_format::rgba8 ? 0.003 : 0);
    }
    for (const glm::vec4& pixel : e.depth().pixels) {
        check.same(pixel.x, 0.625);
    }
}

template <backend B>
void draw_keeps(context<B>& c) {
    easel<B> e(c, {16, 16, image_format::rgba8}, false);
    e.draw(rectangle(e.what(), 0, 0, 16, 16, 0.5, blue));
    e.draw(rectangle(e.what(), 4, 4, 8, 8, 0.5, red));
    comparison check = c.compare("channels");
    const picture seen = e.color();
    for (std::uint32_t y = 0; y < 16; ++y) {
        for (std::uint32_t x = 0; x < 16; ++x) {
            const bool inside = x >= 4 && x < 8 && y >= 4 && y < 8;
            check.same(seen.at(x, y), inside ? red : blue);
        }
    }
}

template <backend B>
void draw_places(context<B>& c) {
    easel<B> e(c, {40, 24, image_format::rgba32f}, false);
    e.kernel.show = kernels::probe_show::place;
    auto corners = rectangle(e.what(), 0, 0, 20, 24, 0.5, red);
    auto back = rectangle(e.what(), 20, 0, 40, 24, 0.5, red);
    std::reverse(back.begin(), back.end());
    append(corners, back);
    e.draw(corners);
    const picture seen = e.color();
    comparison check = c.compare("pixel x, pixel y, front, 1");
    for (std::uint32_t y = 0; y < 24; ++y) {
        for (std::uint32_t x = 0; x < 40; ++x) {
            check.same(seen.at(x, y), {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f,
                                       x < 20 ? 1.0f : 0.0f, 1.0f});
        }
    }
}

template <backend B>
void draw_orientation(context<B>& c) {
    easel<B> e(c, {40, 24, image_format::rgba8}, false);
    // In clip space: y up, so the upper left of the picture is (-1, 1).
    e.draw({{{-1, 1, 0, 1}, red}, {{-1, 0.5f, 0, 1}, red}, {{-0.5f, 1, 0, 1}, red}});
    const picture seen = e.color();
    comparison check = c.compare("channels at the four corners");
    check.same(seen.at(0, 0), red);
    check.same(seen.at(39, 0), {0, 0, 0, 0});
    check.same(seen.at(0, 23), {0, 0, 0, 0});
    check.same(seen.at(39, 23), {0, 0, 0, 0});
}

/// Random triangles against where their edges are.
template <backend B>
void draw_shapes(context<B>& c) {
    for (int shape = 0; shape < 20; ++shape) {
        easel<B> e(c, {50, 30, image_format::rgba8}, false);
        const auto random = [&](double size) {
            return (c.below(1000) / 1000.0 * 1.4 - 0.2) * size;
        };
        const flat_triangle t{
            {random(50), random(30)}, {random(50), random(30)}, {random(50), random(30)}};
        vertex_list corners;
        for (const glm::dvec2 p : {t.a, t.b, t.c}) {
            corners.push_back(vertex_at(e.what(), p.x, p.y, 0.5, green));
        }
        e.draw(corners);
        const picture seen = e.color();
        comparison check = c.compare("channels of a triangle");
        for (std::uint32_t y = 0; y < 30; ++y) {
            for (std::uint32_t x = 0; x < 50; ++x) {
                const double inside = t.depth_inside({x + 0.5, y + 0.5});
                if (std::fabs(inside) > edge_slack) {
                    check.same(seen.at(x, y), inside > 0 ? green : glm::vec4(0));
                }
            }
        }
    }
}

/// A mesh that covers the whole image, its corners on pixel centres, pixel corners and between:
/// with additive blending each pixel must be counted once.
template <backend B>
void draw_shared_edges(context<B>& c, double jitter) {
    easel<B> e(c, {64, 64, image_format::rgba32f}, false);
    e.state.blend = blend_mode::alpha;
    constexpr int cells = 16;
    std::vector<glm::dvec2> grid;
    for (int y = 0; y <= cells; ++y) {
        for (int x = 0; x <= cells; ++x) {
            const bool border = x == 0 || y == 0 || x == cells || y == cells;
            const glm::dvec2 moved{c.below(257) / 256.0, c.below(257) / 256.0};
            const glm::dvec2 at(4.0 * x, 4.0 * y);
            grid.push_back(border ? glm::dvec2{x * 4.5 - 4, y * 4.5 - 4}
                                  : at + (jitter > 0 ? moved * jitter : glm::dvec2{0.5, 0.5}));
        }
    }
    const glm::vec4 once{1, 0, 0, 0};
    vertex_list corners;
    const auto add = [&](int x, int y) {
        const glm::dvec2 p = grid[static_cast<std::size_t>(y * (cells + 1) + x)];
        corners.push_back(vertex_at(e.what(), p.x, p.y, 0.5, once));
    };
    for (int y = 0; y < cells; ++y) {
        for (int x = 0; x < cells; ++x) {
            const bool flip = (x + y) % 2 == 0;
            add(x, y);
            add(x, y + 1);
            add(x + 1, flip ? y + 1 : y);
            add(x, flip ? y : y + 1);
            add(x + 1, y + 1);
            add(x + 1, y);
        }
    }
    e.draw(corners);
    comparison check = c.compare("times that a pixel is covered");
    for (const glm::vec4& pixel : e.color().pixels) {
        check.close_to(pixel.x, 1, 1e-5);
    }
}

template <backend B>
void draw_depth_order(context<B>& c) {
    easel<B> e(c, {24, 24, image_format::rgba8}, true);
    vertex_list all = rectangle(e.what(), 0, 0, 24, 24, 0.5, red);
    append(all, rectangle(e.what(), 0, 0, 8, 24, 0.75, green)); // behind
    append(all, rectangle(e.what(), 8, 0, 16, 24, 0.25, blue)); // before
    append(all, rectangle(e.what(), 16, 0, 24, 24, 0.5, grey)); // equal passes
    e.draw(all);
    const picture seen = e.color();
    const picture depth = e.depth();
    comparison check = c.compare("channels and depths");
    const double tolerance = 0.003;
    for (std::uint32_t y = 0; y < 24; ++y) {
        for (std::uint32_t x = 0; x < 24; ++x) {
            check.close_to(seen.at(x, y), x < 8 ? red : x < 16 ? blue : grey, tolerance);
            check.close_to(depth.at(x, y).x, x >= 8 && x < 16 ? 0.25 : 0.5, 1e-6);
        }
    }
}

template <backend B>
void draw_without_depth_test(context<B>& c) {
    easel<B> e(c, {16, 16, image_format::rgba8}, true);
    e.state.depth_test = false;
    vertex_list all = rectangle(e.what(), 0, 0, 16, 16, 0.25, red);
    append(all, rectangle(e.what(), 0, 0, 16, 16, 0.75, green));
    e.draw(all);
    comparison check = c.compare("channels");
    for (const glm::vec4& pixel : e.color().pixels) {
        check.same(pixel, green);
    }
}

template <backend B>
void draw_without_depth_write(context<B>& c) {
    easel<B> e(c, {16, 16, image_format::rgba8}, true);
    e.state.depth_write = false;
    vertex_list all = rectangle(e.what(), 0, 0, 16, 16, 0.25, red);
    append(all, rectangle(e.what(), 0, 0, 16, 16, 0.75, green));
    e.draw(all);
    comparison check = c.compare("channels and depths");
    for (const glm::vec4& pixel : e.color().pixels) {
        check.same(pixel, green);
    }
    for (const glm::vec4& pixel : e.depth().pixels) {
        check.same(pixel.x, 1);
    }
}

template <backend B>
void draw_depth_plane(context<B>& c, bool depth_only) {
    easel<B> e(c, {32, 32, image_format::rgba8}, true);
    if (depth_only) {
        e.target().color = nullptr;
        e.target().clear_color.reset();
    }
    auto all = rectangle(e.what(), 0, 0, 32, 32, 0, red);
    for (kernels::probe_vertex& v : all) { // z = 1/2 + x/4 + y/8 in clip space
        v.position.z = 0.5f + v.position.x / 4 + v.position.y / 8;
    }
    e.draw(all);
    const picture depth = e.depth();
    comparison check = c.compare("depths");
    for (std::uint32_t y = 0; y < 32; ++y) {
        for (std::uint32_t x = 0; x < 32; ++x) {
            const double clip_x = (x + 0.5) / 16 - 1;
            const double clip_y = 1 - (y + 0.5) / 16;
            check.close_to(depth.at(x, y).x, 0.5 + clip_x / 4 + clip_y / 8, 1e-6);
        }
    }
}

template <backend B>
void draw_culling(context<B>& c, cull_mode cull) {
    easel<B> e(c, {16, 16, image_format::rgba8}, false);
    e.state.cull = cull;
    auto all = rectangle(e.what(), 0, 0, 8, 16, 0.5, red);
    auto back = rectangle(e.what(), 8, 0, 16, 16, 0.5, green);
    std::reverse(back.begin(), back.end());
    append(all, back);
    e.draw(all);
    const picture seen = e.color();
    comparison check = c.compare("channels");
    for (std::uint32_t y = 0; y < 16; ++y) {
        for (std::uint32_t x = 0; x < 16; ++x) {
            const bool culled = x >= 8 && cull == cull_mode::back;
            check.same(seen.at(x, y), culled ? glm::vec4(0) : x < 8 ? red : green);
        }
    }
}

/// What lies before z = 0, behind z = w or behind the camera is cut away.
template <backend B>
void draw_clipping(context<B>& c) {
    easel<B> e(c, {32, 32, image_format::rgba8}, true);
    auto all = rectangle(e.what(), 0, 0, 32, 32, 0, red);
    for (kernels::probe_vertex& v : all) { // z = 1/2 + x: inside for x from -1/2 to 1/2
        v.position.z = 0.5f + v.position.x;
    }
    e.draw(all);
    const picture seen = e.color();
    comparison check = c.compare("channels");
    for (std::uint32_t y = 0; y < 32; ++y) {
        for (std::uint32_t x = 0; x < 32; ++x) {
            check.same(seen.at(x, y), x >= 8 && x < 24 ? red : glm::vec4(0));
        }
    }
}

template <backend B>
void draw_behind_the_camera(context<B>& c) {
    easel<B> e(c, {32, 32, image_format::rgba8}, false);
    // A strip of floor, y = -1, from 8 before the camera to 8 behind it: x = ±1, w = distance.
    const auto floor = [&](float x, float w) {
        return kernels::probe_vertex{{x, -1, w * 0.5f, w}, green};
    };
    const auto a = floor(-4, 8), b = floor(-4, -8), d = floor(4, -8), f = floor(4, 8);
    e.draw({a, b, d, a, d, f});
    const picture seen = e.color();
    comparison check = c.compare("channels");
    for (std::uint32_t y = 0; y < 32; ++y) {
        for (std::uint32_t x = 0; x < 32; ++x) {
            // The pixel sees the floor at distance w = -1 / y, where x · w lies within ±4.
            const double clip_y = 1 - (y + 0.5) / 16;
            const double clip_x = (x + 0.5) / 16 - 1;
            const double w = -1 / clip_y;
            const double side = 4 / w - std::fabs(clip_x);
            if (clip_y > 0 || w > 9) {
                check.same(seen.at(x, y), glm::vec4(0));
            } else if (w < 7.5 && std::fabs(side) > 0.02) {
                check.same(seen.at(x, y), side > 0 ? green : glm::vec4(0));
            }
        }
    }
}

/// Varyings are interpolated in space, not on the screen.
template <backend B>
void draw_perspective(context<B>& c) {
    easel<B> e(c, {32, 32, image_format::rgba32f}, false);
    const auto corner = [&](double x, double y, double w, float s) {
        return vertex_at(e.what(), x, y, 0.5, {s, 1 - s, s, 1}, w);
    };
    const auto a = corner(0, 0, 1, 0), b = corner(0, 32, 1, 0);
    const auto d = corner(32, 32, 8, 1), f = corner(32, 0, 8, 1);
    e.draw({a, b, d, a, d, f});
    const picture seen = e.color();
    comparison check = c.compare("channels");
    for (std::uint32_t y = 0; y < 32; ++y) {
        for (std::uint32_t x = 0; x < 32; ++x) {
            const double t = (x + 0.5) / 32;
            const auto s = static_cast<float>((t / 8) / ((1 - t) + t / 8));
            check.close_to(seen.at(x, y), {s, 1 - s, s, 1}, 1e-3);
        }
    }
}

template <backend B>
void draw_blending(context<B>& c, image_format format) {
    easel<B> e(c, {16, 16, format}, false);
    e.state.blend = blend_mode::alpha;
    e.target().clear_color = glm::vec4{0.2f, 0.4f, 0.6f, 0.5f};
    const glm::vec4 layers[] = {
        {0.3f, 0, 0.1f, 0.4f}, {0, 0.5f, 0.05f, 0.6f}, {0.1f, 0.1f, 0.1f, 0}};
    vertex_list all;
    glm::dvec4 expected{0.2, 0.4, 0.6, 0.5};
    for (const glm::vec4& layer : layers) {
        append(all, rectangle(e.what(), 0, 0, 16, 16, 0.5, layer));
        expected = glm::dvec4(layer) + (1 - double{layer.w}) * expected;
    }
    e.draw(all);
    const double tolerance = format == image_format::rgba8 ? 3.0 / 255 : 1e-6;
    comparison check = c.compare("channels");
    for (const glm::vec4& pixel : e.color().pixels) {
        for (int k = 0; k < 4; ++k) {
            check.close_to(double{pixel[k]}, expected[k], tolerance);
        }
    }
}

/// 600 layers, drawn back to front as smoke is: thin ones on the left, on the right some that hide
/// what lies behind them. A wall stands among them in the lower half.
template <backend B>
void draw_blending_many_layers(context<B>& c) {
    constexpr std::uint32_t layers = 600;
    constexpr double wall = 0.4003;
    easel<B> e(c, {16, 16, image_format::rgba32f}, true);
    e.target().clear_color = glm::vec4{0.2f, 0.4f, 0.6f, 0.5f};
    e.draw(rectangle(e.what(), 0, 8, 16, 16, wall, {0.3f, 0.2f, 0.1f, 1}));
    const picture before = e.color();
    e.state.blend = blend_mode::alpha;
    e.state.depth_write = false;
    vertex_list all;
    std::vector<glm::dvec4> expected;
    for (const glm::vec4& pixel : before.pixels) {
        expected.emplace_back(pixel);
    }
    for (std::uint32_t i = 0; i < layers; ++i) {
        const double depth = 0.9 - 0.8 * i / layers;
        const bool thick = i % 7 == 0;
        const auto from = static_cast<std::uint32_t>(thick ? 8 : 0);
        const float alpha = thick ? 0.6f : 0.004f;
        const float shade = alpha * static_cast<float>(c.below(256)) / 255;
        const glm::vec4 layer{shade, 0.5f * shade, alpha - shade, alpha};
        append(all, rectangle(e.what(), from, 0, 16, 16, depth, layer));
        for (std::uint32_t k = 0; k < 256; ++k) {
            const bool behind = k / 16 >= 8 && depth > wall;
            if (k % 16 >= from && !behind) {
                expected[k] = glm::dvec4(layer) + (1 - double{layer.w}) * expected[k];
            }
        }
    }
    e.draw(all);
    const picture seen = e.color();
    comparison check = c.compare("channels");
    for (std::size_t i = 0; i < seen.pixels.size(); ++i) {
        for (int k = 0; k < 4; ++k) {
            // 600 roundings of 6e-8, and what may be left out.
            check.close_to(double{seen.pixels[i][k]}, expected[i][k], 4e-5 + 1.0 / 65536);
        }
    }
}

/// One layer on rgba8: within one step of exact.
template <backend B>
void draw_blending_one_layer(context<B>& c) {
    easel<B> e(c, {16, 16, image_format::rgba8}, false);
    e.draw(rectangle(e.what(), 0, 0, 16, 16, 0.5, {0.2f, 0.4f, 0.6f, 1}));
    e.state.blend = blend_mode::alpha;
    e.draw(rectangle(e.what(), 0, 0, 16, 16, 0.5, {0.1f, 0.2f, 0, 0.25f}));
    comparison check = c.compare("channels");
    for (const glm::vec4& pixel : e.color().pixels) {
        check.close_to(pixel, {0.25f, 0.5f, 0.45f, 1}, 1.001 / 255);
    }
}

template <backend B>
void draw_discard(context<B>& c) {
    easel<B> e(c, {32, 8, image_format::rgba32f}, true);
    e.kernel.cutoff = 0.5f;
    auto all = rectangle(e.what(), 0, 0, 32, 8, 0.25, red);
    for (kernels::probe_vertex& v : all) { // alpha runs from 0 at the left to 1
        v.color.w = (v.position.x + 1) / 2;
    }
    e.draw(all);
    const picture seen = e.color();
    const picture depth = e.depth();
    comparison check = c.compare("red and depth");
    for (std::uint32_t y = 0; y < 8; ++y) {
        for (std::uint32_t x = 0; x < 32; ++x) {
            check.same(seen.at(x, y).x, x >= 16 ? 1 : 0);
            check.close_to(depth.at(x, y).x, x >= 16 ? 0.25 : 1, 1e-6);
        }
    }
}

template <backend B>
void draw_fragment_buffer(context<B>& c) {
    easel<B> e(c, {8, 8, image_format::rgba32f}, false);
    e.kernel.tint = 1;
    e.draw(rectangle(e.what(), 0, 0, 8, 8, 0.5, {0.5f, 0.25f, 3, 1}));
    comparison check = c.compare("channels");
    for (const glm::vec4& pixel : e.color().pixels) {
        check.close_to(pixel, {0.25f, 0.5f, 3, 1}, 1e-6);
    }
}

template <backend B>
void draw_values(context<B>& c, image_format format) {
    const glm::vec4 values[] = {{0, 1, 0.5f, 0.25f}, {-1, 2, 100, 1}, {0.002f, 0.998f, 0.2f, 1}};
    for (const glm::vec4& value : values) {
        easel<B> e(c, {4, 4, format}, false);
        e.draw(rectangle(e.what(), 0, 0, 4, 4, 0.5, value));
        comparison check = c.compare("channels");
        for (const glm::vec4& pixel : e.color().pixels) {
            for (int k = 0; k < 4; ++k) {
                const double unit = std::fmin(1, std::fmax(0, double{value[k]}));
                const bool bytes = format == image_format::rgba8;
                check.close_to(double{pixel[k]}, bytes ? unit : double{value[k]},
                               bytes ? 0.6 / 255 : 1e-4);
            }
        }
    }
}

/// Triangles of zeros, as padding::degenerate makes them, cover nothing.
template <backend B>
void draw_degenerate(context<B>& c) {
    easel<B> e(c, {16, 16, image_format::rgba8}, true);
    vertex_list all(30);
    const auto p = vertex_at(e.what(), 3, 3, 0.5, red);
    const auto q = vertex_at(e.what(), 9, 11, 0.5, red);
    append(all, {p, p, p, p, q, p, p, q, q});
    append(all, rectangle(e.what(), 0, 0, 4, 4, 0.5, blue));
    append(all, vertex_list(3));
    e.draw(all);
    const picture seen = e.color();
    comparison check = c.compare("channels");
    for (std::uint32_t y = 0; y < 16; ++y) {
        for (std::uint32_t x = 0; x < 16; ++x) {
            check.same(seen.at(x, y), x < 4 && y < 4 ? blue : glm::vec4(0));
        }
    }
}

/// The last of many triangles over each other wins.
template <backend B>
void draw_order(context<B>& c) {
    easel<B> e(c, {33, 17, image_format::rgba32f}, false);
    vertex_list all;
    for (int i = 0; i < 1000; ++i) {
        append(all, rectangle(e.what(), 0, 0, 33, 17, 0.5, {static_cast<float>(i), 0, 0, 1}));
    }
    e.draw(all);
    comparison check = c.compare("red");
    for (const glm::vec4& pixel : e.color().pixels) {
        check.close_to(pixel.x, 999, 1e-3);
    }
}

/// More triangles than a loop or a dispatch of 65,535 takes: one for each pixel.
template <backend B>
void draw_many(context<B>& c) {
    easel<B> e(c, {320, 256, image_format::rgba32f}, false);
    vertex_list all;
    for (std::uint32_t y = 0; y < 256; ++y) {
        for (std::uint32_t x = 0; x < 320; ++x) {
            const glm::vec4 color{static_cast<float>(x), static_cast<float>(y), 0, 1};
            all.push_back(vertex_at(e.what(), x + 0.1, y + 0.1, 0.5, color));
            all.push_back(vertex_at(e.what(), x + 0.1, y + 1.3, 0.5, color));
            all.push_back(vertex_at(e.what(), x + 1.3, y + 0.1, 0.5, color));
        }
    }
    e.draw(all);
    const picture seen = e.color();
    comparison check = c.compare("channels");
    for (std::uint32_t y = 0; y < 256; ++y) {
        for (std::uint32_t x = 0; x < 320; ++x) {
            check.close_to(seen.at(x, y), {static_cast<float>(x), static_cast<float>(y), 0, 1},
                           1e-3);
        }
    }
}

/// Cells of a grid of 8 × 8, 2 pixels each; cell n has its six vertices at 6 n.
[[nodiscard]] inline vertex_list numbered_cells(image_description what) {
    vertex_list all;
    for (int n = 0; n < 64; ++n) {
        const double x = n % 8 * 2;
        const double y = n / 8 * 2;
        append(all, rectangle(what, x, y, x + 2, y + 2, 0.5, {static_cast<float>(n + 1), 0, 0, 1}));
    }
    return all;
}

/// Cells [first, first + count) are drawn and no others.
template <backend B>
void expect_cells(const context<B>& c, const picture& seen, std::uint32_t first,
                  std::uint32_t count) {
    comparison check = c.compare("red of numbered cells");
    for (std::uint32_t y = 0; y < 16; ++y) {
        for (std::uint32_t x = 0; x < 16; ++x) {
            const std::uint32_t n = y / 2 * 8 + x / 2;
            check.close_to(seen.at(x, y).x, n - first < count ? n + 1 : 0, 1e-4);
        }
    }
}

inline constexpr image_description cell_picture{16, 16, image_format::rgba32f};

template <backend B>
void draw_part(context<B>& c) {
    easel<B> e(c, cell_picture, false);
    draw_geometry<B> geometry;
    geometry.first = 6 * 5;
    geometry.count = 6 * 20;
    e.draw(numbered_cells(cell_picture), geometry);
    expect_cells(c, e.color(), 5, 20);
}

template <backend B>
void draw_base_vertex(context<B>& c) {
    easel<B> e(c, cell_picture, false);
    draw_geometry<B> geometry;
    geometry.first = 6 * 5;
    geometry.count = 6 * 20;
    geometry.base_vertex = 6 * 7;
    e.draw(numbered_cells(cell_picture), geometry);
    expect_cells(c, e.color(), 12, 20);
}

/// Indices backwards, cell by cell: what is drawn is the cells of indices [first, first + count).
template <backend B>
void draw_indexed(context<B>& c, std::uint32_t base_cell, bool by_length) {
    easel<B> e(c, cell_picture, false);
    std::vector<std::uint32_t> numbers(64 * 6);
    for (std::uint32_t i = 0; i < numbers.size(); ++i) {
        numbers[i] = (std::max(63 - i / 6, base_cell) - base_cell) * 6 + i % 6;
    }
    const auto indices = c.put(numbers);
    const auto length = c.put_count(2 * 20);
    draw_geometry<B> geometry;
    geometry.indices = indices.view();
    geometry.first = 6 * 10;
    geometry.count = by_length ? 0 : 6 * 20;
    geometry.base_vertex = base_cell * 6;
    if (by_length) {
        geometry.length = length.view();
    }
    e.draw(numbered_cells(cell_picture), geometry);
    expect_cells(c, e.color(), 34, 20); // cells 63 − 10 − 19 … 63 − 10
}

template <backend B>
void draw_by_length(context<B>& c, std::uint32_t cells_drawn, std::uint32_t first_cell) {
    easel<B> e(c, cell_picture, false);
    const auto length = c.put_count(2 * cells_drawn);
    draw_geometry<B> geometry;
    geometry.first = 6 * first_cell;
    geometry.length = length.view();
    e.draw(numbered_cells(cell_picture), geometry);
    expect_cells(c, e.color(), first_cell, cells_drawn);
}

template <backend B>
void draw_two_recorders(context<B>& c) {
    const image_description what{8, 8, image_format::rgba8};
    const auto a = new_image(c, what);
    const auto b = new_image(c, what);
    const auto reds = c.put(rectangle(what, 0, 0, 8, 8, 0.5, red));
    const auto greens = c.put(rectangle(what, 0, 0, 8, 8, 0.5, green));
    const auto tints = c.put(std::vector<glm::vec4>{{1, 1, 1, 1}});
    auto first = c.begin();
    auto second = c.begin();
    const auto draw = [&](auto& r, const auto& vertices, const auto& image) {
        draw_geometry<B> geometry;
        geometry.count = 6;
        draw_target<B> target;
        target.color = &image;
        target.clear_color = blue;
        r.draw(kernels::probe_surface{}, {vertices.view(), tints.view()}, {}, geometry, target,
               draw_state{});
    };
    draw(second, reds, b);
    draw(first, greens, a);
    draw(second, greens, b);
    draw(first, reds, a);
    c.submit(second);
    c.submit(first);
    comparison check = c.compare("channels");
    for (const auto& [image, color] : {std::pair{&a, red}, std::pair{&b, green}}) {
        for (const glm::vec4& pixel : read_image(c, *image).pixels) {
            check.same(pixel, color);
        }
    }
}

template <backend B>
void add_draw_cases(cases<B>& to) {
    if constexpr (draws<B, kernels::probe_surface>) {
        using C = context<B>;
        const auto add = [&](std::string name, std::function<void(C&)> body) {
            to.push_back({"draw", std::move(name), std::move(body)});
        };
        add("clear_rgba8", [](C& c) { draw_clear(c, image_format::rgba8); });
        add("clear_rgba32f", [](C& c) { draw_clear(c, image_format::rgba32f); });
        add("keeps_what_is_there", draw_keeps<B>);
        add("places", draw_places<B>);
        add("orientation", draw_orientation<B>);
        add("shapes", draw_shapes<B>);
        add("shared_edges_on_centres", [](C& c) { draw_shared_edges(c, 0); });
        add("shared_edges", [](C& c) { draw_shared_edges(c, 1.5); });
        add("depth_order", draw_depth_order<B>);
        add("without_depth_test", draw_without_depth_test<B>);
        add("without_depth_write", draw_without_depth_write<B>);
        add("depth_plane", [](C& c) { draw_depth_plane(c, false); });
        add("depth_only", [](C& c) { draw_depth_plane(c, true); });
        add("cull_none", [](C& c) { draw_culling(c, cull_mode::none); });
        add("cull_back", [](C& c) { draw_culling(c, cull_mode::back); });
        add("clipping", draw_clipping<B>);
        add("behind_the_camera", draw_behind_the_camera<B>);
        add("perspective", draw_perspective<B>);
        add("blend_rgba8", [](C& c) { draw_blending(c, image_format::rgba8); });
        add("blend_rgba32f", [](C& c) { draw_blending(c, image_format::rgba32f); });
        add("blend_one_layer", draw_blending_one_layer<B>);
        add("blend_many_layers", draw_blending_many_layers<B>);
        add("discard", draw_discard<B>);
        add("fragment_buffer", draw_fragment_buffer<B>);
        add("values_rgba8", [](C& c) { draw_values(c, image_format::rgba8); });
        add("values_rgba32f", [](C& c) { draw_values(c, image_format::rgba32f); });
        add("degenerate", draw_degenerate<B>);
        add("order", draw_order<B>);
        add("many", draw_many<B>);
        add("part", draw_part<B>);
        add("base_vertex", draw_base_vertex<B>);
        add("indexed", [](C& c) { draw_indexed(c, 0, false); });
        add("indexed_base_vertex", [](C& c) { draw_indexed(c, 34, false); });
        add("indexed_by_length", [](C& c) { draw_indexed(c, 0, true); });
        add("by_length", [](C& c) { draw_by_length(c, 20, 5); });
        add("by_length_of_nothing", [](C& c) { draw_by_length(c, 0, 0); });
        add("by_length_of_all", [](C& c) { draw_by_length(c, 64, 0); });
        add("two_recorders", draw_two_recorders<B>);
    }
}

} // namespace skybark::conformance
