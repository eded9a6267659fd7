// draw: which way is up, what is in front, what is blended, what is read.

#include "support.hpp"

namespace skybark::opengl::tests {
namespace {

using kernels::probe_image;
using kernels::probe_read;
using kernels::probe_show;
using kernels::probe_surface;
using kernels::probe_vertex;

constexpr std::uint32_t side = 8;

/// Two triangles that wind counter-clockwise seen with y up.
std::vector<probe_vertex> rectangle(float left, float bottom, float right, float top, float z,
                                    glm::vec4 color) {
    const probe_vertex a{{left, bottom, z, 1}, color};
    const probe_vertex b{{right, bottom, z, 1}, color};
    const probe_vertex c{{right, top, z, 1}, color};
    const probe_vertex d{{left, top, z, 1}, color};
    return {a, b, c, a, c, d};
}

constexpr glm::vec4 red{1, 0, 0, 1};
constexpr glm::vec4 green{0, 1, 0, 1};
constexpr glm::vec4 blue{0, 0, 1, 1};

class draw_test : public device_test {
  protected:
    void SetUp() override {
        device_test::SetUp();
        if (owner) {
            color = *device().create_image({side, side, image_format::rgba32f});
            depth = *device().create_image({side, side, image_format::depth32f});
            tints = make(std::vector<glm::vec4>{glm::vec4(1), glm::vec4(1, 1, 1, 0.5f)});
        }
    }
    void TearDown() override {
        color = {};
        depth = {};
        tints = {};
        device_test::TearDown();
    }

    void draw(const std::vector<probe_vertex>& vertices, draw_state state = {},
              const probe_surface& kernel = {}, bool clear = true) {
        draw_geometry<gpu> geometry;
        geometry.count = static_cast<std::uint32_t>(vertices.size());
        draw(vertices, geometry, state, kernel, clear);
    }
    void draw(const std::vector<probe_vertex>& vertices, const draw_geometry<gpu>& geometry,
              draw_state state = {}, const probe_surface& kernel = {}, bool clear = true) {
        const buffer b = make(vertices);
        draw_target<gpu> target{&color, &depth, {}, {}};
        if (clear) {
            target.clear_color = glm::vec4(0);
            target.clear_depth = 1.0f;
        }
        run([&](recorder& r) {
            r.draw(kernel, {view<gpu>(b), view<gpu>(tints)}, {}, geometry, target, state);
        });
    }
    [[nodiscard]] std::vector<glm::vec4> pixels() {
        std::vector<glm::vec4> got(side * side);
        EXPECT_TRUE(device().download(color, std::as_writable_bytes(std::span(got))));
        return got;
    }
    [[nodiscard]] std::vector<float> depths() {
        std::vector<float> got(side * side);
        EXPECT_TRUE(device().download(depth, std::as_writable_bytes(std::span(got))));
        return got;
    }
    /// Whether the pixels that `inside(x, y)` names are `value`, and the others transparent.
    template <class Inside>
    void expect_pixels(glm::vec4 value, Inside&& inside) {
        const auto got = pixels();
        for (std::uint32_t y = 0; y < side; ++y) {
            for (std::uint32_t x = 0; x < side; ++x) {
                ASSERT_EQ(got[y * side + x], inside(x, y) ? value : glm::vec4(0))
                    << "at " << x << ", " << y;
            }
        }
    }

    image color;
    image depth;
    buffer tints;
};

TEST_F(draw_test, row_0_is_the_top) {
    draw(rectangle(-1, 0, 0, 1, 0.5f, red));
    expect_pixels(red, [](auto x, auto y) { return x < 4 && y < 4; });
}

TEST_F(draw_test, fragments_know_their_pixel_and_their_side) {
    probe_surface place;
    place.show = probe_show::place;
    draw(rectangle(-1, -1, 1, 1, 0.5f, red), {}, place);
    auto got = pixels();
    for (std::uint32_t i = 0; i < side * side; ++i) {
        EXPECT_EQ(got[i], glm::vec4(static_cast<float>(i % side) + 0.5f,
                                    static_cast<float>(i / side) + 0.5f, 1, 1));
    }
    draw(rectangle(1, -1, -1, 1, 0.5f, red), {}, place);
    got = pixels();
    EXPECT_EQ(got[0], glm::vec4(0.5f, 0.5f, 0, 1));
}

TEST_F(draw_test, backs_are_culled_where_asked) {
    const auto back = rectangle(1, -1, -1, 1, 0.5f, red);
    draw_state state;
    draw(back, state);
    expect_pixels(red, [](auto, auto) { return true; });
    state.cull = cull_mode::back;
    draw(back, state);
    expect_pixels(red, [](auto, auto) { return false; });
    draw(rectangle(-1, -1, 1, 1, 0.5f, red), state);
    expect_pixels(red, [](auto, auto) { return true; });
}

TEST_F(draw_test, nearer_or_equal_passes) {
    draw(rectangle(-1, -1, 1, 1, 0.5f, red));
    EXPECT_EQ(depths(), std::vector<float>(side * side, 0.5f));
    draw(rectangle(-1, -1, 1, 1, 0.75f, green), {}, {}, false);
    expect_pixels(red, [](auto, auto) { return true; });
    draw(rectangle(-1, -1, 1, 1, 0.5f, green), {}, {}, false);
    expect_pixels(green, [](auto, auto) { return true; });
    draw_state state;
    state.depth_write = false;
    draw(rectangle(-1, -1, 1, 1, 0.25f, blue), state, {}, false);
    expect_pixels(blue, [](auto, auto) { return true; });
    EXPECT_EQ(depths(), std::vector<float>(side * side, 0.5f));
    state.depth_test = false;
    draw(rectangle(-1, -1, 1, 1, 0.9f, red), state, {}, false);
    expect_pixels(red, [](auto, auto) { return true; });
    EXPECT_EQ(depths(), std::vector<float>(side * side, 0.5f));
}

TEST_F(draw_test, depth_runs_from_0_to_1_and_is_clipped_there) {
    draw(rectangle(-1, -1, 1, 1, 0.0f, red));
    EXPECT_EQ(depths()[0], 0.0f);
    draw(rectangle(-1, -1, 1, 1, 1.0f, red));
    EXPECT_EQ(depths()[0], 1.0f);
    expect_pixels(red, [](auto, auto) { return true; });
    draw(rectangle(-1, -1, 1, 1, -0.25f, red));
    expect_pixels(red, [](auto, auto) { return false; });
    draw(rectangle(-1, -1, 1, 1, 1.25f, red));
    expect_pixels(red, [](auto, auto) { return false; });
}

TEST_F(draw_test, blends_premultiplied) {
    draw_state state;
    draw(rectangle(-1, -1, 1, 1, 0.5f, {0.5f, 0.25f, 0, 1}), state);
    state.blend = blend_mode::alpha;
    draw(rectangle(-1, -1, 1, 1, 0.5f, {0.25f, 0, 0.5f, 0.5f}), state, {}, false);
    expect_pixels({0.5f, 0.125f, 0.5f, 1.0f}, [](auto, auto) { return true; });
}

TEST_F(draw_test, discards_fragments) {
    probe_surface kernel;
    kernel.tint = 1;
    kernel.cutoff = 0.75f;
    draw(rectangle(-1, -1, 1, 1, 0.5f, red), {}, kernel);
    expect_pixels(red, [](auto, auto) { return false; });
    EXPECT_EQ(depths()[0], 1.0f);
}

TEST_F(draw_test, a_part_of_the_vertices) {
    auto vertices = rectangle(-1, -1, 0, 1, 0.5f, red);
    const auto more = rectangle(0, -1, 1, 1, 0.5f, green);
    vertices.insert(vertices.end(), more.begin(), more.end());
    draw_geometry<gpu> geometry;
    geometry.first = 4;
    geometry.base_vertex = 2;
    geometry.count = 6;
    draw(vertices, geometry);
    expect_pixels(green, [](auto x, auto) { return x >= 4; });
    // A clear happens even where nothing is drawn.
    geometry.count = 0;
    draw(vertices, geometry);
    expect_pixels(green, [](auto, auto) { return false; });
}

TEST_F(draw_test, indices_count_from_the_view_and_the_base_vertex) {
    auto vertices = rectangle(-1, -1, 0, 1, 0.5f, red);
    const auto more = rectangle(0, -1, 1, 1, 0.5f, green);
    vertices.insert(vertices.end(), more.begin(), more.end());
    // Four words before the view, two before `first`; the highest index is no restart.
    const buffer indices =
        make(std::vector<std::uint32_t>{9, 9, 9, 9, 9, 9, 0, 1, 2, 3, 4, 5, 0xffffffff, 0, 0});
    draw_geometry<gpu> geometry;
    geometry.indices = {&indices, 16, 44};
    geometry.first = 2;
    geometry.count = 6;
    geometry.base_vertex = 6;
    draw(vertices, geometry);
    expect_pixels(green, [](auto x, auto) { return x >= 4; });
}

TEST_F(draw_test, the_devices_own_length_replaces_the_count) {
    std::vector<probe_vertex> vertices(7, {{9, 9, 9, 1}, blue});
    for (std::uint32_t i = 0; i < 4; ++i) {
        const float x = -1 + 0.5f * static_cast<float>(i);
        const auto more = rectangle(x, -1, x + 0.5f, 1, 0.5f, red);
        vertices.insert(vertices.end(), more.begin(), more.end());
    }
    std::vector<std::uint32_t> index_values(6, 12345);
    for (std::uint32_t i = 0; i < 24; ++i) {
        index_values.push_back(i);
    }
    const buffer indices = make(index_values);
    for (const std::uint32_t written : {0u, 2u, 6u, 8u}) {
        SCOPED_TRACE(written);
        const buffer count = make(std::vector<count_record>{{9, 9, {9, 9}}, {written, 0, {0, 0}}});
        draw_geometry<gpu> geometry;
        geometry.length = view<gpu, count_record>(count, 1, 1);
        geometry.first = 3;
        geometry.base_vertex = 4;
        draw(vertices, geometry);
        expect_pixels(red, [&](auto x, auto) { return x < written; });
        geometry.indices = {&indices, 16, 26 * 4};
        geometry.first = 2;
        geometry.base_vertex = 7;
        draw(vertices, geometry);
        expect_pixels(red, [&](auto x, auto) { return x < written; });
    }
    // More triangles than the view holds: what lies behind it is left alone.
    const buffer count = make(std::vector<count_record>{{8, 0, {0, 0}}});
    draw_geometry<gpu> geometry;
    geometry.length = view<gpu>(count);
    geometry.indices = {&indices, 16, (2 + 12) * 4};
    geometry.first = 2;
    geometry.base_vertex = 7;
    draw(vertices, geometry);
    expect_pixels(red, [](auto x, auto) { return x < 4; });
}

TEST_F(draw_test, into_depth_alone_which_is_red_when_read) {
    const buffer near = make(rectangle(-1, 0, 1, 1, 0.25f, red));
    auto whole = rectangle(-1, -1, 1, 1, 0.5f, red);
    const buffer screen = make(whole);
    draw_geometry<gpu> geometry;
    geometry.count = 6;
    probe_image kernel;
    kernel.read = probe_read::fetch;
    run([&](recorder& r) {
        r.draw(probe_surface{}, {view<gpu>(near), view<gpu>(tints)}, {}, geometry,
               {nullptr, &depth, {}, 1.0f}, {});
        r.draw(kernel, {view<gpu>(screen)},
               {sampled_image<gpu>{&depth}, sampled_image<gpu>{&depth}}, geometry,
               {&color, nullptr, glm::vec4(0), {}}, {});
    });
    const auto got = pixels();
    EXPECT_EQ(got[0].x, 0.25f);
    EXPECT_EQ(got[side * side - 1].x, 1.0f);
}

TEST_F(draw_test, images_are_sampled_as_asked) {
    auto source = device().create_image({2, 2, image_format::rgba32f});
    auto other = device().create_image({3, 5, image_format::rgba8});
    ASSERT_TRUE(source && other);
    const std::vector<glm::vec4> texels{{0, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0, 1}, {1, 1, 0, 1}};
    ASSERT_TRUE(device().upload(*source, std::as_bytes(std::span(texels))));
    draw_geometry<gpu> geometry;
    geometry.count = 6;
    const auto sampled = [&](glm::vec2 uv, filter_mode filter, wrap_mode wrap, probe_read read,
                             bool swapped = false) {
        const buffer screen = make(rectangle(-1, -1, 1, 1, 0.5f, {uv.x, uv.y, 0, 0}));
        probe_image kernel;
        kernel.read = read;
        const sampled_image<gpu> first{&*source, filter, wrap};
        const sampled_image<gpu> second{&*other, filter, wrap};
        run([&](recorder& r) {
            r.draw(kernel, {view<gpu>(screen)},
                   {swapped ? second : first, swapped ? first : second}, geometry,
                   {&color, nullptr, glm::vec4(0), {}}, {});
        });
        return pixels()[0];
    };
    using enum filter_mode;
    using enum wrap_mode;
    EXPECT_EQ(sampled({}, nearest, clamp, probe_read::size), glm::vec4(2, 2, 3, 5));
    EXPECT_EQ(sampled({0.25f, 0.75f}, nearest, clamp, probe_read::sample), texels[2]);
    EXPECT_EQ(sampled({0.25f, 0.75f}, nearest, clamp, probe_read::sample_second, true), texels[2]);
    EXPECT_EQ(sampled({0.5f, 0.5f}, linear, clamp, probe_read::sample),
              glm::vec4(0.5f, 0.5f, 0, 1));
    EXPECT_EQ(sampled({1.25f, 0.25f}, nearest, clamp, probe_read::sample), texels[1]);
    EXPECT_EQ(sampled({1.25f, 0.25f}, nearest, repeat, probe_read::sample), texels[0]);
    EXPECT_EQ(sampled({1.0f, 0.25f}, linear, repeat, probe_read::sample), glm::vec4(0.5f, 0, 0, 1));
    EXPECT_EQ(sampled({1.0f, 0.25f}, linear, clamp, probe_read::sample), texels[1]);
}

TEST_F(draw_test, a_target_that_is_gone_is_not_drawn_into) {
    const auto screen = rectangle(-1, -1, 1, 1, 0.5f, red);
    const buffer b = make(screen);
    draw_geometry<gpu> geometry;
    geometry.count = 6;
    for (std::uint32_t i = 1; i < 5; ++i) { // a driver may use the last name again
        auto target = device().create_image({i, i, image_format::rgba8});
        ASSERT_TRUE(target);
        // A recorder that is never submitted leaves the target attached.
        auto r = device().begin();
        ASSERT_TRUE(r);
        r->draw(probe_surface{}, {view<gpu>(b), view<gpu>(tints)}, {}, geometry,
                {&*target, nullptr, glm::vec4(0), {}}, {});
        std::vector<std::uint32_t> got(i * i);
        ASSERT_TRUE(device().download(*target, std::as_writable_bytes(std::span(got))));
        EXPECT_EQ(got, std::vector<std::uint32_t>(i * i, 0xff0000ff));
    }
}

} // namespace
} // namespace skybark::opengl::tests
