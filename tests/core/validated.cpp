// validated<B> says what is wrong, with the values, and does not pass the call on.

#include <skybark/core/validated.hpp>

#include <skybark/conformance/null_backend.hpp>
#include <skybark/kernels/hermite_branch.hpp>
#include <skybark/kernels/probe_image.hpp>
#include <skybark/kernels/probe_level.hpp>
#include <skybark/kernels/probe_map.hpp>
#include <skybark/kernels/probe_rings.hpp>
#include <skybark/kernels/probe_strips.hpp>

#include <gtest/gtest.h>

namespace {

using namespace skybark;
using conformance::null_device;
using checked = validated<null_device>;

static_assert(backend<checked>);
static_assert(maps<checked, kernels::probe_map>);
static_assert(expands<checked, kernels::probe_strips>);
static_assert(expands_rings<checked, kernels::probe_rings>);
static_assert(draws<checked, kernels::probe_image>);

class validation : public testing::Test {
  protected:
    null_device inner{conformance::null_options{{1 << 20, 16, 1000, 512}, 1 << 24, true}};
    std::vector<std::string> said;
    checked device{inner, [this](std::string_view sentence) { said.emplace_back(sentence); }};

    [[nodiscard]] checked::buffer buffer(std::uint64_t bytes) {
        return std::move(*device.create_buffer(bytes));
    }
    [[nodiscard]] checked::image image(std::uint32_t width, std::uint32_t height,
                                       image_format format = image_format::rgba8) {
        return std::move(*device.create_image({width, height, format}));
    }
    /// One sentence has been said since the last time, and it has all of these in it.
    void expect_said(std::initializer_list<const char*> parts) {
        ASSERT_EQ(said.size(), 1u);
        for (const char* part : parts) {
            EXPECT_NE(said[0].find(part), std::string::npos)
                << '"' << part << "\" is missing in: " << said[0];
        }
        EXPECT_EQ(said[0].back(), '.');
        EXPECT_EQ(said[0], device.last_misuse());
        said.clear();
    }
};

TEST_F(validation, right_calls_pass) {
    const auto b = buffer(1024);
    ASSERT_TRUE(device.upload(b, 0, std::vector<std::byte>(1024)));
    ASSERT_TRUE(run(device, [&](auto& r) {
        const kernels::probe_rings kernel{4};
        r.expand_rings(kernel, {buffer_view<checked>{&b, 0, 64}}, range{0, 4},
                       buffer_view<checked>{&b, 256, 256});
        r.map(kernels::probe_level{}, {view<checked>(b), view<checked>(b), view<checked>(b)},
              range{0, 4});
    }));
    EXPECT_TRUE(said.empty());
    EXPECT_EQ(inner.counts().ring_expands, 1u);
    EXPECT_EQ(inner.counts().maps, 1u);
}

TEST_F(validation, upload_outside) {
    const auto b = buffer(100);
    EXPECT_FALSE(device.upload(b, 96, std::vector<std::byte>(8)));
    expect_said({"upload", "8 bytes", "offset 96", "100 bytes"});
    EXPECT_FALSE(device.upload(b, ~std::uint64_t{0}, std::vector<std::byte>(8)));
    expect_said({"outside"});
    std::vector<std::byte> out(101);
    EXPECT_FALSE(device.download(b, 0, out));
    expect_said({"download", "101 bytes"});
    EXPECT_EQ(inner.counts().uploads + inner.counts().downloads, 0u);
}

TEST_F(validation, image_bytes) {
    const auto i = image(4, 3);
    EXPECT_FALSE(device.upload(i, std::vector<std::byte>(47)));
    expect_said({"4 x 3", "48", "47"});
    EXPECT_FALSE(device.create_image({0, 3, image_format::rgba8}));
    expect_said({"0 x 3"});
}

TEST_F(validation, views) {
    const auto b = buffer(1024);
    const auto map = [&](buffer_view<checked> first) {
        auto r = device.begin();
        r->map(kernels::probe_level{}, {first, view<checked>(b), view<checked>(b)}, range{0, 1});
    };
    map({});
    expect_said({"map", "buffer 0", "names no buffer"});
    map({&b, 1008, 32});
    expect_said({"buffer 0", "32 bytes", "1008", "1024"});
    map({&b, 8, 32});
    expect_said({"starts at byte 8", "16"});
    map({&b, 16, 30});
    expect_said({"30 bytes", "words"});
    EXPECT_EQ(inner.counts().maps, 0u);
}

TEST_F(validation, wrong_device) {
    checked other(inner, [](std::string_view) {});
    const auto b = std::move(*other.create_buffer(64));
    auto r = device.begin();
    r->copy(view<checked>(b), view<checked>(b));
    expect_said({"another device"});
    EXPECT_FALSE(other.submit(*r));
    EXPECT_NE(other.last_misuse().find("another device"), std::string::npos);
}

TEST_F(validation, moved_from) {
    auto b = buffer(64);
    const auto c = std::move(b);
    auto r = device.begin();
    r->copy(buffer_view<checked>{&b, 0, 16}, buffer_view<checked>{&c, 0, 16}); // NOLINT
    expect_said({"moved from"});
    const auto s = std::move(*r);
    EXPECT_FALSE(device.submit(*r)); // NOLINT
    expect_said({"moved from"});
}

TEST_F(validation, copies) {
    const auto b = buffer(64);
    auto r = device.begin();
    r->copy({&b, 0, 32}, {&b, 16, 32});
    expect_said({"overlap", "0", "16"});
    r->copy({&b, 0, 32}, {&b, 32, 16});
    expect_said({"32 bytes", "16"});
    r->upload({&b, 0, 32}, std::vector<std::byte>(33));
    expect_said({"33 bytes", "32"});
}

TEST_F(validation, submitted_twice_and_used_after) {
    const auto b = buffer(64);
    auto r = device.begin();
    ASSERT_TRUE(device.submit(*r));
    EXPECT_FALSE(device.submit(*r));
    expect_said({"submitted before"});
    r->copy({&b, 0, 16}, {&b, 16, 16});
    expect_said({"submitted already"});
    EXPECT_EQ(inner.counts().submits, 1u);
}

TEST_F(validation, gone_before_submit) {
    auto r = device.begin();
    {
        const auto b = buffer(64);
        r->copy({&b, 0, 16}, {&b, 16, 16});
    }
    EXPECT_FALSE(device.submit(*r));
    expect_said({"gone", "outlive"});
}

TEST_F(validation, elements_and_levels) {
    const auto b = buffer(1024);
    const auto v = view<checked>(b);
    auto r = device.begin();
    r->map(kernels::probe_level{}, {v, v, v}, range{0, 1001});
    expect_said({"1001 elements", "1000"});
    r->map(kernels::probe_level{}, {v, v, v}, range{0xffffffff, 2});
    expect_said({"4294967295", "32 bits"});
    const range overlapping[] = {{0, 10}, {9, 5}};
    r->map(kernels::probe_level{}, {v, v, v}, std::span<const range>(overlapping));
    expect_said({"range 1", "9"});
    const range turning[] = {{0, 10}, {10, 5}, {0, 5}};
    r->map(kernels::probe_level{}, {v, v, v}, std::span<const range>(turning));
    expect_said({"range 2", "turns back"});
    const range downwards[] = {{10, 5}, {0, 10}};
    r->map(kernels::probe_level{}, {v, v, v}, std::span<const range>(downwards));
    EXPECT_TRUE(said.empty());
    r->map(kernels::probe_level{}, {v, v, v}, counted<checked>{{&b, 0, 8}, 5});
    expect_said({"8 bytes", "count_record"});
}

TEST_F(validation, outputs_overlap) {
    const auto b = buffer(4096);
    const auto v = view<checked>(b);
    auto r = device.begin();
    r->map(kernels::probe_map{}, {v, v, v, v}, range{0, 1});
    expect_said({"buffer 2 and buffer 3 overlap"});
    const kernels::probe_strips strips{1, 2};
    const buffer_view<checked> in{&b, 0, 512};
    const buffer_view<checked> list{&b, 1024, 1024};
    const buffer_view<checked> count{&b, 512, 16};
    r->expand(strips, {in, in}, range{0, 4}, triangle_list<checked>{v, count, {}});
    expect_said({"the vertices", "overlap"});
    r->expand(strips, {in, list}, range{0, 4}, triangle_list<checked>{list, count, {}});
    expect_said({"buffer 1 and the vertices overlap"});
    r->expand(strips, {in, in}, range{0, 4}, triangle_list<checked>{list, {&b, 0, 16}, {}});
    expect_said({"buffer 0 and the count overlap"});
    r->expand(strips, {in, in}, range{0, 4}, triangle_list<checked>{list, count, {}});
    EXPECT_TRUE(said.empty());
}

TEST_F(validation, kernel_parameters) {
    const auto b = buffer(65536);
    const buffer_view<checked> in{&b, 0, 1024};
    const buffer_view<checked> list{&b, 1024, 1024};
    const buffer_view<checked> count{&b, 2048, 16};
    auto r = device.begin();
    r->expand(kernels::probe_strips{0, 5}, {in, in}, range{0, 4},
              triangle_list<checked>{list, count, {}});
    expect_said({"0 strips of 5"});
    r->expand(kernels::probe_strips{1 << 15, 1 << 15}, {in, in}, range{0, 4},
              triangle_list<checked>{list, count, {}});
    expect_said({"4 elements", "1073741824", "chunks"});
    r->expand_rings(kernels::probe_rings{1}, {in}, range{0, 4}, list);
    expect_said({"1 vertices", "4294967295 triangles"});
    r->expand_rings(kernels::probe_rings{65}, {in}, range{0, 1}, list);
    expect_said({"1 elements of 65", "1040 bytes", "1024"});
    r->expand_rings(kernels::hermite_branch{2, 0, kernels::branch_frame::slerp}, {in, in, in},
                    range{0, 1}, {&b, 2048, 1024});
    expect_said({"0 vertices", "cannot be meant"});
}

TEST_F(validation, draws) {
    const auto b = buffer(1024);
    const auto color = image(8, 8);
    const auto small = image(8, 4, image_format::depth32f);
    const auto depth = image(8, 8, image_format::depth32f);
    const auto texture = image(2, 2);
    auto r = device.begin();
    const auto draw = [&](draw_target<checked> target, draw_geometry<checked> geometry,
                          const checked::image* second) {
        r->draw(kernels::probe_image{}, {view<checked>(b)}, {{{&texture}, {second}}}, geometry,
                target, draw_state{});
    };
    draw_geometry<checked> three;
    three.count = 3;
    draw_target<checked> to;
    draw(to, three, &texture);
    expect_said({"nothing to draw into"});
    to.color = &depth;
    draw(to, three, &texture);
    expect_said({"colour target", "depth32f"});
    to.color = &color;
    to.depth = &color;
    draw(to, three, &texture);
    expect_said({"depth target", "depth32f"});
    to.depth = &small;
    draw(to, three, &texture);
    expect_said({"8 x 8", "8 x 4"});
    to.depth = nullptr;
    to.clear_depth = 1.0f;
    draw(to, three, &texture);
    expect_said({"no depth target"});
    to.depth = &depth;
    to.clear_depth = 1.5f;
    draw(to, three, &texture);
    expect_said({"1.5"});
    to.clear_depth = 1.0f;
    draw(to, three, nullptr);
    expect_said({"image 1 is not given"});
    draw(to, three, &color);
    expect_said({"image 1 is also drawn into"});
    three.count = 4;
    draw(to, three, &texture);
    expect_said({"4 vertices", "triangles"});
    three.count = 3;
    three.first = 254;
    three.indices = view<checked>(b);
    draw(to, three, &texture);
    expect_said({"indices up to 257", "256"});
    EXPECT_EQ(inner.counts().draws, 0u);
    three.first = 0;
    draw(to, three, &texture);
    EXPECT_TRUE(said.empty());
    EXPECT_EQ(inner.counts().draws, 1u);
}

using validation_death = validation;

TEST_F(validation_death, aborts_without_a_handler) {
    EXPECT_DEATH(
        {
            checked strict(inner);
            const auto b = strict.create_buffer(16);
            (void)strict.upload(*b, 16, std::vector<std::byte>(4));
        },
        "");
}

} // namespace
