// Where contexts come from, and several of them in one process.

#include "caller.hpp"

namespace skybark::opengl::tests {
namespace {

using kernels::probe_map;
using kernels::probe_rings;
using kernels::probe_strips;

/// One pattern of each stage of the pipeline, with results that only a device at work gives: under
/// EGL without a surface, a draw without a framebuffer fails and writes nothing.
void expect_works(gpu& device, std::uint32_t seed) {
    const std::vector<std::uint32_t> numbers{seed, 2, 1, 0};
    const std::vector<glm::vec4> payloads(4, glm::vec4(1, 2, 3, 4));
    auto in = make_buffer<gpu, std::uint32_t>(device, numbers);
    auto vectors = make_buffer<gpu, glm::vec4>(device, payloads);
    auto out = device.create_buffer(4096);
    auto list = device.create_buffer(4096);
    auto rings = device.create_buffer(4096);
    auto count = device.create_buffer(16);
    auto target = device.create_image({4, 4, image_format::rgba8});
    ASSERT_TRUE(in && vectors && out && list && rings && count && target);
    const auto done = run(device, [&](recorder& r) {
        r.map(probe_map{2, 0, 1, 0},
              {view<gpu>(*in), view<gpu>(*vectors), view<gpu>(*out), view<gpu>(*list)},
              range{0, 1});
        r.expand(probe_strips{1, 3}, {view<gpu>(*in), view<gpu>(*vectors)}, range{1, 3},
                 {view<gpu>(*list), view<gpu>(*count), padding::compact});
        r.expand_rings(probe_rings{5}, {view<gpu>(*vectors)}, range{0, 4}, view<gpu>(*rings));
        r.draw(kernels::probe_surface{}, {view<gpu>(*list), view<gpu>(*vectors)}, {}, {},
               {&*target, nullptr, glm::vec4(0, 1, 0, 1), {}}, {});
    });
    ASSERT_TRUE(done) << done.error().message;
    std::uint32_t doubled = 0;
    ASSERT_TRUE((read_back<gpu, std::uint32_t>(device, *out, std::span(&doubled, 1))));
    EXPECT_EQ(doubled, 2 * seed);
    count_record counted;
    ASSERT_TRUE((read_back<gpu, count_record>(device, *count, std::span(&counted, 1))));
    EXPECT_EQ(counted.written, 3u);
    EXPECT_EQ(counted.required, 3u);
    glm::vec4 last;
    ASSERT_TRUE((read_back<gpu, glm::vec4>(device, *rings, std::span(&last, 1), 19)));
    EXPECT_EQ(last, glm::vec4(3, 4, 1, 2));
    std::array<std::uint32_t, 16> pixels{};
    ASSERT_TRUE(device.download(*target, std::as_writable_bytes(std::span(pixels))));
    EXPECT_EQ(pixels[15], 0xff00ff00u);
}

class context_test : public testing::Test {
  protected:
    void TearDown() override { EXPECT_EQ(log->serious, std::vector<std::string>{}); }
    [[nodiscard]] headless_options options(headless_kind kind) {
        return {kind, message_log::sink(log)};
    }
    void expect_kind(headless_kind kind) {
        auto made = headless::create(options(kind));
        if (!made) {
            ASSERT_FALSE(required()) << made.error().message;
            GTEST_SKIP() << made.error().message;
        }
        expect_works(made->device(), 21);
    }
    std::shared_ptr<message_log> log = std::make_shared<message_log>();
};

TEST_F(context_test, egl_without_a_surface) { expect_kind(headless_kind::egl); }
TEST_F(context_test, osmesa) { expect_kind(headless_kind::osmesa); }
TEST_F(context_test, whichever_there_is) { expect_kind(headless_kind::any); }

TEST_F(context_test, a_hidden_glfw_window) {
    if (std::getenv("DISPLAY") == nullptr && std::getenv("SKYBARK_REQUIRE_GLFW") == nullptr) {
        GTEST_SKIP() << "DISPLAY is not set.";
    }
    auto made = create_headless_glfw(options(headless_kind::any));
    ASSERT_TRUE(made) << made.error().message;
    expect_works(made->device(), 22);
    auto egl = headless::create(options(headless_kind::egl));
    auto osmesa = headless::create(options(headless_kind::osmesa));
    ASSERT_TRUE(egl && osmesa);
    for (std::uint32_t i = 0; i < 3; ++i) {
        expect_works(made->device(), 30 + i);
        expect_works(egl->device(), 40 + i);
        expect_works(made->device(), 50 + i);
        expect_works(osmesa->device(), 60 + i);
    }
}

TEST_F(context_test, the_callers_own) {
    caller_context caller;
    if (!caller.current()) {
        ASSERT_FALSE(required());
        GTEST_SKIP() << "There is no EGL with OpenGL 4.5.";
    }
    auto made = gpu::create(caller.describe());
    ASSERT_TRUE(made) << made.error().message;
    expect_works(*made, 23);
}

TEST_F(context_test, egl_and_osmesa_take_turns_in_one_thread) {
    auto egl = headless::create(options(headless_kind::egl));
    auto osmesa = headless::create(options(headless_kind::osmesa));
    if (!egl || !osmesa) {
        ASSERT_FALSE(required());
        GTEST_SKIP() << "EGL or OSMesa is missing.";
    }
    // Without a word, ...
    for (std::uint32_t i = 0; i < 4; ++i) {
        expect_works(egl->device(), 100 + i);
        expect_works(osmesa->device(), 200 + i);
    }
    // ... in the middle of what a recorder does, ...
    auto first = egl->device().create_buffer(16);
    auto second = osmesa->device().create_buffer(16);
    ASSERT_TRUE(first && second);
    auto one = egl->device().begin();
    auto two = osmesa->device().begin();
    ASSERT_TRUE(one && two);
    for (std::uint32_t i = 0; i < 4; ++i) {
        const std::uint32_t a = i + 1;
        const std::uint32_t b = i + 10;
        one->upload(view<gpu, std::uint32_t>(*first, i, 1), std::as_bytes(std::span(&a, 1)));
        two->upload(view<gpu, std::uint32_t>(*second, i, 1), std::as_bytes(std::span(&b, 1)));
    }
    EXPECT_TRUE(egl->device().submit(*one));
    EXPECT_TRUE(osmesa->device().submit(*two));
    std::array<std::uint32_t, 4> a{};
    std::array<std::uint32_t, 4> b{};
    EXPECT_TRUE((read_back<gpu, std::uint32_t>(egl->device(), *first, a)));
    EXPECT_TRUE((read_back<gpu, std::uint32_t>(osmesa->device(), *second, b)));
    EXPECT_EQ(a, (std::array<std::uint32_t, 4>{1, 2, 3, 4}));
    EXPECT_EQ(b, (std::array<std::uint32_t, 4>{10, 11, 12, 13}));
    // ... and with the contexts released and made current by hand.
    EXPECT_TRUE(egl->make_current());
    EXPECT_TRUE(osmesa->make_current());
    osmesa->release();
    osmesa->release();
    EXPECT_TRUE(egl->make_current());
    expect_works(egl->device(), 300);
}

TEST_F(context_test, two_of_a_kind_do_not_mix_up_their_objects) {
    auto first = headless::create(options(headless_kind::any));
    auto second = headless::create(options(headless_kind::any));
    if (!first || !second) {
        ASSERT_FALSE(required());
        GTEST_SKIP() << "There is no OpenGL.";
    }
    {
        auto a = first->device().create_buffer(16);
        auto b = second->device().create_buffer(16);
        ASSERT_TRUE(a && b);
        const std::uint32_t seven = 7;
        ASSERT_TRUE(first->device().upload(*a, 0, std::as_bytes(std::span(&seven, 1))));
        std::uint32_t got = 1;
        ASSERT_TRUE((read_back<gpu, std::uint32_t>(second->device(), *b, std::span(&got, 1))));
        EXPECT_EQ(got, 0u);
    } // a is deleted while the second context is current
    expect_works(first->device(), 1);
    expect_works(second->device(), 2);
}

TEST_F(context_test, a_device_taken_out_keeps_its_context) {
    auto made = headless::create(options(headless_kind::any));
    if (!made) {
        ASSERT_FALSE(required()) << made.error().message;
        GTEST_SKIP() << made.error().message;
    }
    std::unique_ptr<gpu> device;
    {
        headless owner = std::move(*made);
        device = std::make_unique<gpu>(std::move(owner).device());
    }
    made = fail(error_code::unavailable, "gone");
    expect_works(*device, 9);
}

TEST(shared_library, that_is_missing_is_unavailable_in_a_sentence) {
    const auto missing = detail::shared_library::open("libskybark_missing.so.9");
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, error_code::unavailable);
    EXPECT_NE(missing.error().message.find("libskybark_missing.so.9"), std::string::npos);
}

} // namespace
} // namespace skybark::opengl::tests
