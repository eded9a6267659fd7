// Drawing: where triangles land, which way they face, what hides them, and what fragments read.
#include "support.hpp"

namespace skybark::testing {
namespace {

using kernels::probe_image;
using kernels::probe_read;
using kernels::probe_show;
using kernels::probe_surface;
using kernels::probe_vertex;
using pixels = std::vector<glm::vec4>;

constexpr std::uint32_t size = 8;
const glm::vec4 red{1, 0, 0, 1};
const glm::vec4 green{0, 1, 0, 1};
const glm::vec4 clear{0, 0, 0, 0};

class drawing : public both_ways {
  protected:
    void SetUp() override {
        both_ways::SetUp();
        if (headless_) {
            color.emplace(must(gpu().create_image({size, size, image_format::rgba32f})));
            depth.emplace(must(gpu().create_image({size, size, image_format::depth32f})));
            tints.emplace(upload(gpu(), std::vector<glm::vec4>{{1, 1, 1, 1}, {0.5f, 2, 1, 1}}));
        }
    }
    void TearDown() override {
        color.reset();
        depth.reset();
        tints.reset();
        both_ways::TearDown();
    }

    /// A square from x0, y0 to x1, y1 in clip space at depth z, counter-clockwise with y up.
    static std::vector<probe_vertex> square(float x0, float y0, float x1, float y1, float z,
                                            glm::vec4 c) {
        const glm::vec4 a{x0, y0, z, 1}, b{x1, y0, z, 1}, d{x1, y1, z, 1}, e{x0, y1, z, 1};
        return {{a, c}, {b, c}, {d, c}, {a, c}, {d, c}, {e, c}};
    }

    [[nodiscard]] draw_target<device> target(bool cleared = true) const {
        draw_target<device> t{&*color, &*depth, {}, {}};
        if (cleared) {
            t.clear_color = clear;
            t.clear_depth = 1.0f;
        }
        return t;
    }

    void draw(vulkan::recorder& r, const vulkan::buffer& vertices, draw_geometry<device> g,
              draw_state state = {}, bool cleared = true, probe_surface k = {}) {
        r.draw(k, bound<probe_surface>{view<device>(vertices), view<device>(*tints)}, {}, g,
               target(cleared), state);
    }

    pixels shown() {
        pixels p(size * size);
        must(gpu().download(*color, std::as_writable_bytes(std::span(p))));
        return p;
    }
    std::vector<float> depths() {
        std::vector<float> d(size * size);
        must(gpu().download(*depth, std::as_writable_bytes(std::span(d))));
        return d;
    }

    std::optional<vulkan::image> color, depth;
    std::optional<vulkan::buffer> tints;
};
INSTANTIATE_TEST_SUITE_P(vulkan, drawing, ::testing::Bool(), way_name);

const glm::vec4& at(const pixels& p, std::uint32_t x, std::uint32_t y) { return p[y * size + x]; }

TEST_P(drawing, y_is_up_and_row_0_is_the_top) {
    // The upper right quarter of clip space.
    const auto v = upload(gpu(), square(0, 0, 1, 1, 0.5f, red));
    go(gpu(), [&](auto& r) { draw(r, v, {{}, 0, 6, 0, {}}); });
    const pixels p = shown();
    const std::vector<float> d = depths();
    for (std::uint32_t y = 0; y < size; ++y) {
        for (std::uint32_t x = 0; x < size; ++x) {
            const bool inside = x >= size / 2 && y < size / 2;
            EXPECT_EQ(at(p, x, y), inside ? red : clear) << x << " " << y;
            EXPECT_EQ(d[y * size + x], inside ? 0.5f : 1.0f) << x << " " << y;
        }
    }
}

TEST_P(drawing, fragments_know_their_pixel_and_their_side) {
    auto both = square(-1, -1, 0, 1, 0, red);
    auto back = square(0, -1, 1, 1, 0, red);
    std::swap(back[0], back[1]);
    std::swap(back[3], back[4]);
    both.insert(both.end(), back.begin(), back.end());
    const auto v = upload(gpu(), both);
    const probe_surface k{probe_show::place, 0, 0};
    go(gpu(), [&](auto& r) { draw(r, v, {{}, 0, 12, 0, {}}, {}, true, k); });
    const pixels p = shown();
    for (std::uint32_t y = 0; y < size; ++y) {
        for (std::uint32_t x = 0; x < size; ++x) {
            EXPECT_EQ(at(p, x, y),
                      (glm::vec4{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f,
                                 x < size / 2 ? 1.0f : 0.0f, 1.0f}));
        }
    }
}

TEST_P(drawing, culling_leaves_out_what_winds_clockwise) {
    auto front = square(-1, -1, 1, 1, 0, red);
    const auto v = upload(gpu(), front);
    std::swap(front[0], front[1]);
    std::swap(front[3], front[4]);
    const auto w = upload(gpu(), front);
    draw_state state;
    state.cull = cull_mode::back;
    go(gpu(), [&](auto& r) { draw(r, v, {{}, 0, 6, 0, {}}, state); });
    EXPECT_EQ(shown(), pixels(size * size, red));
    go(gpu(), [&](auto& r) { draw(r, w, {{}, 0, 6, 0, {}}, state); });
    EXPECT_EQ(shown(), pixels(size * size, clear));
    state.cull = cull_mode::none;
    go(gpu(), [&](auto& r) { draw(r, w, {{}, 0, 6, 0, {}}, state); });
    EXPECT_EQ(shown(), pixels(size * size, red));
}

TEST_P(drawing, nearer_or_equal_passes_the_depth_test) {
    const auto middle = upload(gpu(), square(-1, -1, 1, 1, 0.5f, red));
    const auto again = [&](float z, draw_state state) {
        const auto v = upload(gpu(), square(-1, -1, 1, 1, z, green));
        go(gpu(), [&](auto& r) {
            draw(r, middle, {{}, 0, 6, 0, {}});
            draw(r, v, {{}, 0, 6, 0, {}}, state, false);
        });
        return std::pair{shown()[0], depths()[0]};
    };
    EXPECT_EQ(again(0.25f, {}), std::pair(green, 0.25f));
    EXPECT_EQ(again(0.5f, {}), std::pair(green, 0.5f));
    EXPECT_EQ(again(0.75f, {}), std::pair(red, 0.5f));
    draw_state no_test;
    no_test.depth_test = false;
    EXPECT_EQ(again(0.75f, no_test), std::pair(green, 0.75f));
    no_test.depth_write = false;
    EXPECT_EQ(again(0.75f, no_test), std::pair(green, 0.5f));
    draw_state no_write;
    no_write.depth_write = false;
    EXPECT_EQ(again(0.25f, no_write), std::pair(green, 0.5f));
}

TEST_P(drawing, blending_is_premultiplied) {
    const auto under = upload(gpu(), square(-1, -1, 1, 1, 0.5f, {0.5f, 0.25f, 1, 1}));
    const auto over = upload(gpu(), square(-1, -1, 1, 1, 0.5f, {0.25f, 0, 0, 0.5f}));
    draw_state state;
    state.blend = blend_mode::alpha;
    go(gpu(), [&](auto& r) {
        draw(r, under, {{}, 0, 6, 0, {}});
        draw(r, over, {{}, 0, 6, 0, {}}, state, false);
    });
    EXPECT_EQ(shown()[0], (glm::vec4{0.5f, 0.125f, 0.5f, 1}));
}

TEST_P(drawing, fragments_read_buffers_and_may_be_discarded) {
    auto v = square(-1, -1, 0, 1, 0, {1, 0.25f, 0.5f, 1});
    const auto thin = square(0, -1, 1, 1, 0, {1, 1, 1, 0.25f});
    v.insert(v.end(), thin.begin(), thin.end());
    const auto b = upload(gpu(), v);
    const probe_surface k{probe_show::color, 1, 0.5f};
    go(gpu(), [&](auto& r) { draw(r, b, {{}, 0, 12, 0, {}}, {}, true, k); });
    const pixels p = shown();
    EXPECT_EQ(at(p, 0, 0), (glm::vec4{0.5f, 0.5f, 0.5f, 1}));
    EXPECT_EQ(at(p, size - 1, 0), clear);
    EXPECT_EQ(depths()[size - 1], 1.0f); // nor has it written its depth
}

/// Four squares, one a quarter of the image, as a list and as indices.
struct quarters {
    std::vector<probe_vertex> list;
    std::vector<std::uint32_t> indices;

    quarters() {
        for (int i = 0; i < 4; ++i) {
            const auto x = static_cast<float>(i % 2 - 1);
            const auto y = static_cast<float>(i / 2 - 1);
            for (const probe_vertex& v : drawing_square(x, y)) {
                indices.push_back(static_cast<std::uint32_t>(list.size()));
                list.push_back(v);
            }
        }
    }
    static std::vector<probe_vertex> drawing_square(float x, float y) {
        const glm::vec4 a{x, y, 0, 1}, b{x + 1, y, 0, 1}, d{x + 1, y + 1, 0, 1}, e{x, y + 1, 0, 1};
        return {{a, red}, {b, red}, {d, red}, {a, red}, {d, red}, {e, red}};
    }
    /// Which of the quarters are shown, lower left first.
    static std::array<bool, 4> seen(const pixels& p) {
        return {at(p, 0, size - 1) == red, at(p, size - 1, size - 1) == red, at(p, 0, 0) == red,
                at(p, size - 1, 0) == red};
    }
};
using four = std::array<bool, 4>;

TEST_P(drawing, first_count_and_base_vertex_choose_what_is_drawn) {
    const quarters q;
    const auto v = upload(gpu(), q.list);
    const auto i = upload(gpu(), q.indices);
    const auto seen = [&](draw_geometry<device> g) {
        go(gpu(), [&](auto& r) { draw(r, v, g); });
        return quarters::seen(shown());
    };
    const auto indices = view<device>(i);
    EXPECT_EQ(seen({{}, 6, 6, 0, {}}), (four{false, true, false, false}));
    EXPECT_EQ(seen({{}, 6, 6, 12, {}}), (four{false, false, false, true}));
    EXPECT_EQ(seen({indices, 6, 12, 0, {}}), (four{false, true, true, false}));
    EXPECT_EQ(seen({indices, 0, 6, 12, {}}), (four{false, false, true, false}));
    EXPECT_EQ(seen({{}, 0, 0, 0, {}}), (four{}));
}

TEST_P(drawing, the_device_may_say_how_much_is_drawn) {
    const quarters q;
    const auto v = upload(gpu(), q.list);
    const auto i = upload(gpu(), q.indices);
    const auto seen = [&](std::uint32_t triangles, draw_geometry<device> g) {
        const auto length = upload(gpu(), std::vector<count_record>{{triangles, 1000, {}}});
        g.length = view<device>(length);
        go(gpu(), [&](auto& r) { draw(r, v, g); });
        return quarters::seen(shown());
    };
    const auto indices = view<device>(i);
    EXPECT_EQ(seen(0, {}), (four{}));
    EXPECT_EQ(seen(2, {}), (four{true, false, false, false}));
    EXPECT_EQ(seen(6, {}), (four{true, true, true, false}));
    EXPECT_EQ(seen(2, {{}, 6, 0, 6, {}}), (four{false, false, true, false}));
    EXPECT_EQ(seen(4, {indices, 6, 0, 0, {}}), (four{false, true, true, false}));
    EXPECT_EQ(seen(2, {indices, 6, 0, 6, {}}), (four{false, false, true, false}));
    EXPECT_EQ(seen(1000000, {indices, 12, 0, 0, {}}), (four{false, false, true, true}));
}

TEST_P(drawing, depth_alone_can_be_drawn_and_read_later) {
    const auto v = upload(gpu(), square(-1, -1, 0, 1, 0.25f, red));
    const auto all = upload(gpu(), square(-1, -1, 1, 1, 0, red));
    const auto other = must(gpu().create_image({1, 1, image_format::rgba8}));
    const bound<probe_image> b{view<device>(all)};
    go(gpu(), [&](auto& r) {
        draw_target<device> shadow{nullptr, &*depth, {}, 1.0f};
        r.draw(probe_surface{}, bound<probe_surface>{view<device>(v), view<device>(*tints)}, {},
               draw_geometry<device>{{}, 0, 6, 0, {}}, shadow, draw_state{});
        draw_target<device> picture{&*color, nullptr, clear, {}};
        r.draw(probe_image{probe_read::fetch, 0, 0}, b,
               image_bindings<device, probe_image>{
                   sampled_image<device>{&*depth, filter_mode::nearest, wrap_mode::clamp},
                   sampled_image<device>{&other, filter_mode::nearest, wrap_mode::clamp}},
               draw_geometry<device>{{}, 0, 6, 0, {}}, picture, draw_state{});
    });
    const pixels p = shown();
    EXPECT_EQ(at(p, 0, 0).x, 0.25f);
    EXPECT_EQ(at(p, size - 1, 0).x, 1.0f);
}

TEST_P(drawing, images_are_read_with_the_filter_and_wrap_asked_for) {
    const auto source = must(gpu().create_image({2, 1, image_format::rgba32f}));
    const auto bytes = must(gpu().create_image({1, 2, image_format::rgba8}));
    must(gpu().upload(source, bytes_of(pixels{{1, 0, 0, 1}, {0, 1, 0, 1}})));
    must(gpu().upload(bytes, bytes_of(std::vector<std::uint32_t>{0xff0000ffu, 0xff00ff00u})));
    const auto read = [&](probe_read how, float u, float v, filter_mode f, wrap_mode w) {
        const auto all = upload(gpu(), square(-1, -1, 1, 1, 0, {u, v, 0, 0}));
        go(gpu(), [&](auto& r) {
            draw_target<device> picture{&*color, nullptr, clear, {}};
            r.draw(probe_image{how, 0, 0}, bound<probe_image>{view<device>(all)},
                   image_bindings<device, probe_image>{sampled_image<device>{&source, f, w},
                                                       sampled_image<device>{&bytes, f, w}},
                   draw_geometry<device>{{}, 0, 6, 0, {}}, picture, draw_state{});
        });
        return shown()[0];
    };
    using enum probe_read;
    using enum filter_mode;
    using enum wrap_mode;
    EXPECT_EQ(read(fetch, 0, 0, nearest, clamp), red);
    EXPECT_EQ(read(fetch_second, 0, 0, nearest, clamp), red);
    EXPECT_EQ(read(size, 0, 0, nearest, clamp), (glm::vec4{2, 1, 1, 2}));
    EXPECT_EQ(read(sample, 0.75f, 0.5f, nearest, clamp), green);
    EXPECT_EQ(read(sample, 0.5f, 0.5f, linear, clamp), (glm::vec4{0.5f, 0.5f, 0, 1}));
    EXPECT_EQ(read(sample, 2.0f, 0.5f, linear, clamp), green);
    EXPECT_EQ(read(sample, 2.0f, 0.5f, linear, repeat), (glm::vec4{0.5f, 0.5f, 0, 1}));
    EXPECT_EQ(read(sample, 1.25f, 0.5f, nearest, repeat), red);
    EXPECT_EQ(read(sample_second, 0.5f, 0.75f, nearest, clamp), green); // row 0 has v = 0
}

TEST_P(drawing, images_keep_their_rows_through_upload_and_download) {
    for (const image_format format :
         {image_format::rgba8, image_format::rgba32f, image_format::depth32f}) {
        const auto image = must(gpu().create_image({17, 5, format}));
        std::vector<float> in(17 * 5 * bytes_per_pixel(format) / 4);
        noise random;
        for (float& f : in) {
            f = random.unit();
        }
        must(gpu().upload(image, bytes_of(in)));
        std::vector<float> out(in.size());
        must(gpu().download(image, std::as_writable_bytes(std::span(out))));
        EXPECT_EQ(out, in);
    }
    const auto tall = must(gpu().create_image({1030, 1100, image_format::rgba32f})); // in pieces
    std::vector<std::uint32_t> in(1030 * 1100 * 4);
    for (std::size_t i = 0; i < in.size(); ++i) {
        in[i] = static_cast<std::uint32_t>(i);
    }
    must(gpu().upload(tall, bytes_of(in)));
    std::vector<std::uint32_t> out(in.size());
    must(gpu().download(tall, std::as_writable_bytes(std::span(out))));
    EXPECT_TRUE(out == in);
}

TEST_P(drawing, an_expansion_is_drawn_without_the_host) {
    // Two strips have a triangle each, and so two triangles of the quarters are drawn.
    const kernels::probe_strips k{2, 1};
    const auto counts = upload(gpu(), std::vector<std::uint32_t>{1, 1, 0, 0});
    const auto payloads = upload(gpu(), std::vector<glm::vec4>(2));
    const auto list = must(gpu().create_buffer(4 * 96));
    const auto count = must(gpu().create_buffer(16));
    const quarters q;
    const auto v = upload(gpu(), q.list);
    go(gpu(), [&](auto& r) {
        r.expand(k, {view<device>(counts), view<device>(payloads)}, range{0, 2},
                 {view<device>(list), view<device>(count), padding::compact});
        draw(r, v, {{}, 0, 0, 0, view<device>(count)});
    });
    EXPECT_EQ(quarters::seen(shown()), (four{true, false, false, false}));
}

} // namespace
} // namespace skybark::testing
