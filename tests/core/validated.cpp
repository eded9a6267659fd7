// validated<B> says what is wrong, with the values, and does not pass the call on.

#include <skybark/core/validated.hpp>

#include <skybark/conformance/null_backend.hpp>
#include <skybark/kernels/hermite_branch.hpp>
#include <skybark/kernels/probe_image.hpp>
#include <skybark/kernels/probe_level.hpp>
#include <skybark/kernels/probe_map.hpp>
#include <skybark/kernels/probe_peel.hpp>
#include <skybark/kernels/probe_rings.hpp>
#include <skybark/kernels/probe_slabs.hpp>
#include <skybark/kernels/probe_strips.hpp>
#include <skybark/kernels/probe_volume.hpp>
#include <skybark/kernels/probe_volume_draw.hpp>
#include <skybark/kernels/probe_voxels.hpp>

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
static_assert(volume_backend<checked> && scans<checked> && sorts<checked>);
static_assert(accumulates<checked, kernels::probe_slabs>);
static_assert(maps_grids<checked, kernels::probe_volume>);
static_assert(maps_voxels<checked, kernels::probe_voxels>);
static_assert(draws_volumes<checked, kernels::probe_volume_draw>);
static_assert(peels<checked, kernels::probe_peel> && resolves_bundles<checked>);
// What the wrapped device does not have is not there.
static_assert(!fuses_accumulate_scan<null_device, kernels::probe_slabs>);
static_assert(!fuses_accumulate_scan<checked, kernels::probe_slabs>);
static_assert(!draws_volumes<checked, kernels::probe_image>);
static_assert(!draws<checked, kernels::probe_volume_draw>);

class validation : public testing::Test {
  protected:
    null_device inner{conformance::null_options{{1 << 20, 16, 1000, 512, 4, 64}, 1 << 24, true}};
    std::vector<std::string> said;
    checked device{inner, [this](std::string_view sentence) { said.emplace_back(sentence); }};

    [[nodiscard]] checked::buffer buffer(std::uint64_t bytes) {
        return std::move(*device.create_buffer(bytes));
    }
    [[nodiscard]] checked::image image(std::uint32_t width, std::uint32_t height,
                                       image_format format = image_format::rgba8) {
        return std::move(*device.create_image({width, height, format}));
    }
    [[nodiscard]] checked::volume volume(volume_format format, std::uint32_t width = 4) {
        return std::move(*device.create_volume({width, 3, 2, format}));
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

TEST_F(validation, volume_bytes) {
    EXPECT_FALSE(device.create_volume({2, 0, 2, volume_format::int32}));
    expect_said({"create_volume", "2 x 0 x 2"});
    auto v = volume(volume_format::float16);
    EXPECT_FALSE(device.upload(v, std::vector<std::byte>(96)));
    expect_said({"upload", "4 x 3 x 2", "float16", "48", "96"});
    std::vector<std::byte> out(47);
    EXPECT_FALSE(device.download(v, out));
    expect_said({"download", "48", "47"});
    const auto moved = std::move(v);
    EXPECT_FALSE(device.upload(v, std::vector<std::byte>(48))); // NOLINT
    expect_said({"moved from"});
    checked other(inner, [](std::string_view) {});
    EXPECT_FALSE(other.upload(moved, std::vector<std::byte>(48)));
    EXPECT_NE(other.last_misuse().find("another device"), std::string::npos);
    EXPECT_EQ(inner.counts().uploads + inner.counts().downloads, 0u);
    EXPECT_TRUE(device.upload(moved, std::vector<std::byte>(48)));
    EXPECT_EQ(inner.counts().volumes_alive, 1u);
}

TEST_F(validation, volume_scans) {
    const auto whole = volume(volume_format::int32);
    const auto sums = volume(volume_format::int32);
    const auto floats = volume(volume_format::float32);
    const auto halves = volume(volume_format::float16);
    const auto wide = volume(volume_format::float32, 5);
    checked other(inner, [](std::string_view) {});
    const auto foreign = std::move(*other.create_volume({4, 3, 2, volume_format::float32}));
    auto r = device.begin();
    r->scan(whole, whole, volume_scan{});
    expect_said({"scan", "the source is also the destination"});
    r->scan(whole, wide, volume_scan{});
    expect_said({"4 x 3 x 2", "5 x 3 x 2"});
    r->scan(halves, floats, volume_scan{});
    expect_said({"the source", "float16"});
    r->scan(floats, sums, volume_scan{});
    expect_said({"float32", "int32"});
    volume_scan how;
    how.scale = 0.5f;
    r->scan(whole, sums, how);
    expect_said({"whole numbers", "0.5"});
    how = {};
    how.share = scan_share::half;
    r->scan(whole, sums, how);
    expect_said({"whole numbers", "halves"});
    r->scan(whole, foreign, volume_scan{});
    expect_said({"the destination", "another device"});
    EXPECT_EQ(inner.counts().volume_scans, 0u);
    r->scan(whole, sums, volume_scan{});
    r->scan(whole, floats, how);
    r->scan(floats, halves, how);
    EXPECT_TRUE(said.empty());
    EXPECT_EQ(inner.counts().volume_scans, 3u);
}

TEST_F(validation, volume_gone_before_submit) {
    const auto whole = volume(volume_format::int32);
    auto r = device.begin();
    {
        const auto floats = volume(volume_format::float32);
        r->scan(whole, floats, volume_scan{});
    }
    EXPECT_FALSE(device.submit(*r));
    expect_said({"volume", "gone", "outlive"});
}

TEST_F(validation, accumulations) {
    const auto b = buffer(1024);
    const auto whole = volume(volume_format::int32);
    const auto floats = volume(volume_format::float32);
    auto r = device.begin();
    const auto add = [&](std::uint32_t slabs, range elements, const checked::volume* into) {
        r->accumulate(kernels::probe_slabs{slabs, 0, 0, 1}, {view<checked>(b)}, elements,
                      accumulation<checked>{into, true, {}, {}});
    };
    add(4, {0, 5}, nullptr);
    expect_said({"accumulate", "the volume to add to", "not given"});
    add(4, {0, 5}, &floats);
    expect_said({"float32"});
    add(0xffffffff, {0, 5}, &whole);
    expect_said({"4294967295 slabs", "cannot be meant"});
    add(4, {0, 1001}, &whole);
    expect_said({"1001 elements"});
    r->accumulate(kernels::probe_slabs{}, {view<checked>(b)}, counted<checked>{{&b, 0, 8}, 5},
                  accumulation<checked>{&whole, true, {}, {}});
    expect_said({"accumulate over a count", "8 bytes", "count_record"});
    EXPECT_EQ(inner.counts().accumulates, 0u);
    add(4, {0, 5}, &whole);
    r->accumulate(kernels::probe_slabs{}, {view<checked>(b)}, counted<checked>{{&b, 0, 16}, 5},
                  accumulation<checked>{&whole, true, {}, {}});
    EXPECT_TRUE(said.empty());
    EXPECT_EQ(inner.counts().accumulates, 2u);
    EXPECT_EQ(inner.counts().slabs, 40u);
}

TEST_F(validation, scans_and_sorts_of_words) {
    const auto b = buffer(1024);
    const auto c = buffer(8192);
    auto r = device.begin();
    const buffer_view<checked> keys{&b, 0, 256};
    const buffer_view<checked> values{&b, 256, 256};
    const buffer_view<checked> apart{&b, 512, 16};
    r->scan(keys, {&b, 128, 16});
    expect_said({"scan of words", "the words and the total overlap"});
    r->scan(keys, {&b, 512, 0});
    expect_said({"the total is empty"});
    r->scan(view<checked>(c), apart);
    expect_said({"2048 elements", "1000"});
    r->sort(keys, {&b, 256, 128});
    expect_said({"sort", "64 keys", "32 values"});
    r->sort(keys, {&b, 128, 256});
    expect_said({"the keys and the values overlap"});
    r->sort(keys, {});
    expect_said({"the values", "names no buffer"});
    r->sort(keys, values, {apart, 65});
    expect_said({"65", "64 pairs"});
    r->sort(keys, values, {{&b, 496, 16}, 64});
    expect_said({"the values and the count overlap"});
    r->sort(keys, values, {{&b, 512, 8}, 64});
    expect_said({"count_record"});
    r->sort(keys, values, 64u);
    expect_said({"sort", "64 bits", "32"});
    r->sort(keys, values, {apart, 64}, 33);
    expect_said({"sort of a count", "33 bits"});
    EXPECT_EQ(inner.counts().sorts + inner.counts().word_scans, 0u);
    r->scan(keys, apart);
    r->sort(keys, values);
    r->sort(keys, values, {apart, 64});
    r->sort(keys, values, 32u);
    r->sort(keys, values, {apart, 64}, 0);
    EXPECT_TRUE(said.empty());
    EXPECT_EQ(inner.counts().sorts, 4u);
    EXPECT_EQ(inner.counts().words_scanned, 64u);
}

TEST_F(validation, volumes_of_kernels) {
    const auto b = buffer(1024);
    const auto v = view<checked>(b);
    const buffer_view<checked> half_of_it{&b, 512, 512};
    const auto whole = volume(volume_format::int32);
    const auto floats = volume(volume_format::float32);
    const auto halves = volume(volume_format::float16);
    const auto target = volume(volume_format::float32);
    const auto second = volume(volume_format::float32);
    auto r = device.begin();
    const auto map = [&](std::array<const checked::volume*, 2> read, const checked::volume* write) {
        r->map(kernels::probe_volume{}, {v, half_of_it, buffer_view<checked>{&b, 0, 512}},
               volume_bindings<checked, kernels::probe_volume>{read, {write}}, range{0, 1});
    };
    map({&floats, nullptr}, &target);
    expect_said({"map with volumes", "volume 1 is not given"});
    map({&whole, &floats}, &target);
    expect_said({"volume 0", "int32"});
    map({&floats, &halves}, &halves);
    expect_said({"target volume 0", "float16"});
    map({&halves, &floats}, &floats);
    expect_said({"target volume 0 is also volume 1"});
    map({&floats, &floats}, &target);
    EXPECT_TRUE(said.empty());
    EXPECT_EQ(inner.counts().maps, 1u);

    const auto voxels = [&](const checked::volume* write, glm::uvec3 extent) {
        r->map_voxels(
            kernels::probe_voxels{}, {v, v},
            volume_bindings<checked, kernels::probe_voxels>{{&floats, &halves}, {&target, write}},
            extent);
    };
    voxels(&target, glm::uvec3(1));
    expect_said({"map_voxels", "target volume 0 and target volume 1 are one volume"});
    voxels(&second, glm::uvec3(65, 1, 1));
    expect_said({"65 x 1 x 1", "64"});
    voxels(&second, glm::uvec3(4, 3, 2));
    EXPECT_TRUE(said.empty());
    EXPECT_EQ(inner.counts().mapped_voxels, 24u);

    const auto color = image(8, 8);
    const auto texture = image(2, 2);
    draw_target<checked> to;
    to.color = &color;
    const auto draw = [&](const checked::volume* first, const checked::image* source) {
        r->draw(kernels::probe_volume_draw{}, {v}, {{{source}}},
                volume_bindings<checked, kernels::probe_volume_draw>{{first, &halves}, {}},
                draw_geometry<checked>{}, to, draw_state{});
    };
    draw(&whole, &texture);
    expect_said({"draw with volumes", "volume 0", "int32"});
    draw(&floats, &color);
    expect_said({"image 0 is also drawn into"});
    draw(&floats, &texture);
    EXPECT_TRUE(said.empty());
    EXPECT_EQ(inner.counts().draws, 1u);
}

TEST_F(validation, peels) {
    const auto corners = buffer(4800);
    const auto b = buffer(8192);
    auto r = device.begin();
    const peeled_layer<checked> right{8, 5, {&b, 0, 160}, {&b, 160, 160}, {&b, 320, 16}};
    const auto peel = [&](range triangles, const peeled_layer<checked>& layer) {
        r->peel(kernels::probe_peel{}, {view<checked>(corners)}, triangles, layer);
    };
    /// The right call with one thing changed.
    const auto with = [&](auto peeled_layer<checked>::*member, auto value) {
        peeled_layer<checked> layer = right;
        layer.*member = value;
        peel({0, 100}, layer);
    };
    using layer = peeled_layer<checked>;
    using view = buffer_view<checked>;
    with(&layer::width, 0u);
    expect_said({"peel", "0 x 5", "no pixels"});
    with(&layer::height, 513u);
    expect_said({"8 x 513", "512"});
    with(&layer::height, 126u);
    expect_said({"8 x 126", "1000"});
    with(&layer::width, 9u);
    expect_said({"the depths", "160 bytes", "9 x 5", "180"});
    with(&layer::depth, view{});
    expect_said({"the depths", "names no buffer"});
    with(&layer::triangle, view{&b, 160, 156});
    expect_said({"the triangles' numbers", "156 bytes", "160"});
    with(&layer::triangle, view{&b, 0, 160});
    expect_said({"the depths and the triangles' numbers overlap"});
    with(&layer::count, view{&b, 320, 8});
    expect_said({"the count", "8 bytes", "count_record", "16"});
    with(&layer::count, view{&b, 304, 16});
    expect_said({"the triangles' numbers and the count overlap"});
    with(&layer::depth, view{&corners, 0, 160});
    expect_said({"buffer 0 and the depths overlap"});
    peel({0, 1001}, right);
    expect_said({"1001 elements", "1000"});
    peel({1431655765, 1}, right);
    expect_said({"1431655765", "beyond 32 bits"});
    EXPECT_EQ(inner.counts().peels, 0u);
    peel({0, 100}, right);
    peel({1431655764, 1}, right);
    EXPECT_TRUE(said.empty());
    EXPECT_EQ(inner.counts().peels, 2u);
}

TEST_F(validation, bundles) {
    const auto triangles = buffer(480);
    const auto samples = buffer(320);
    const auto hits = buffer(320);
    auto r = device.begin();
    const bundle_work<checked> right{
        view<checked>(triangles), {}, view<checked>(samples), {&hits, 0, 160}};
    ray_bundle bundle;
    bundle.direction.w = 4;
    const auto with = [&](auto bundle_work<checked>::*member, buffer_view<checked> value) {
        bundle_work<checked> work = right;
        work.*member = value;
        r->resolve(bundle, work);
    };
    using work = bundle_work<checked>;
    with(&work::triangles, {});
    expect_said({"resolve", "the triangles", "names no buffer"});
    with(&work::triangles, {&triangles, 0, 464});
    expect_said({"the triangles", "464 bytes", "whole", "48"});
    with(&work::samples, {&samples, 0, 304});
    expect_said({"the samples", "304 bytes", "32"});
    with(&work::hits, {&hits, 0, 152});
    expect_said({"the hits", "152 bytes", "16"});
    with(&work::hits, {&hits, 0, 144});
    expect_said({"10 samples", "9 hits"});
    with(&work::hits, {&triangles, 0, 160});
    expect_said({"the triangles and the hits overlap"});
    with(&work::hits, {&samples, 160, 160});
    expect_said({"the samples and the hits overlap"});
    with(&work::alpha, {&hits, 144, 32});
    expect_said({"the alpha maps and the hits overlap"});
    with(&work::alpha, {&hits, 304, 32});
    expect_said({"the alpha maps", "outside its buffer"});
    const auto many = buffer(48048);
    with(&work::triangles, view<checked>(many));
    expect_said({"1001 triangles", "1000"});
    const auto with_axis = [&](auto change) {
        ray_bundle wrong = bundle;
        change(wrong);
        r->resolve(wrong, right);
    };
    with_axis([](ray_bundle& wrong) { wrong.right.x = 0.5f; });
    expect_said({"right", "unit vector", "0.5"});
    with_axis([](ray_bundle& wrong) { wrong.direction.z = std::nanf(""); });
    expect_said({"direction", "unit vector", "nan"});
    with_axis([](ray_bundle& wrong) { wrong.right.w = -1; });
    expect_said({"lifts", "-1.0"});
    with_axis([](ray_bundle& wrong) { wrong.direction.w = 0; });
    expect_said({"cells", "0.0"});
    EXPECT_EQ(inner.counts().resolves, 0u);
    r->resolve(bundle, right);
    with(&work::alpha, {&hits, 160, 160});
    with(&work::hits, view<checked>(hits));
    EXPECT_TRUE(said.empty());
    EXPECT_EQ(inner.counts().resolves, 3u);
    EXPECT_EQ(inner.counts().resolved_samples, 30u);
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
