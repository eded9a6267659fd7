// The null device counts what is asked of it, and has the limits that it is given.

#include <skybark/conformance/null_backend.hpp>

#include <skybark/kernels/probe_level.hpp>
#include <skybark/kernels/probe_peel.hpp>
#include <skybark/kernels/probe_rings.hpp>
#include <skybark/kernels/probe_slabs.hpp>
#include <skybark/kernels/probe_strips.hpp>
#include <skybark/kernels/probe_surface.hpp>
#include <skybark/kernels/probe_voxels.hpp>

#include <gtest/gtest.h>

namespace {

using namespace skybark;
using conformance::null_device;
using conformance::null_options;

static_assert(maps<null_device, kernels::probe_level>);
static_assert(expands<null_device, kernels::probe_strips>);
static_assert(expands_rings<null_device, kernels::probe_rings>);
static_assert(draws<null_device, kernels::probe_surface>);
static_assert(peels<null_device, kernels::probe_peel>);

TEST(null_backend, counts_objects_and_bytes) {
    null_device device;
    {
        auto a = device.create_buffer(100);
        auto b = device.create_buffer(50);
        const auto i = device.create_image({4, 4, image_format::rgba32f});
        *a = std::move(*b);
        EXPECT_EQ(device.counts().bytes_alive, 406u);
    }
    EXPECT_EQ(device.counts().buffers_alive, 0u);
    EXPECT_EQ(device.counts().images_alive, 0u);
    EXPECT_EQ(device.counts().bytes_alive, 0u);
    EXPECT_EQ(device.counts().bytes_peak, 406u);
    EXPECT_EQ(device.counts().buffers_made, 2u);
}

TEST(null_backend, has_the_limits_that_it_is_given) {
    null_device device(null_options{{1000, 16, 10, 64}, 1500, false});
    EXPECT_EQ(device.create_buffer(1001).error().code, error_code::out_of_memory);
    const auto a = device.create_buffer(1000);
    ASSERT_TRUE(a);
    EXPECT_EQ(device.create_buffer(501).error().code, error_code::out_of_memory);
    EXPECT_TRUE(device.create_buffer(500));
    EXPECT_FALSE(device.create_image({65, 1, image_format::rgba8}));
}

TEST(null_backend, keeps_what_is_uploaded_and_copied) {
    null_device device;
    const std::vector<std::uint32_t> numbers{1, 2, 3, 4};
    const auto a = make_buffer(device, std::span<const std::uint32_t>(numbers));
    const auto b = device.create_buffer(16);
    ASSERT_TRUE(
        run(device, [&](auto& r) { r.copy(view<null_device>(*a), view<null_device>(*b)); }));
    std::vector<std::uint32_t> back(4);
    ASSERT_TRUE(read_back(device, *b, std::span(back)));
    EXPECT_EQ(back, numbers);
    EXPECT_EQ(device.traffic().up, 16u);
    EXPECT_EQ(device.traffic().down, 16u);
}

TEST(null_backend, expansions_count_what_they_might_make) {
    null_device device;
    const auto in = device.create_buffer(64);
    const auto list = device.create_buffer(3 * 32 * 10);
    const auto count = device.create_buffer(16);
    ASSERT_TRUE(run(device, [&](auto& r) {
        r.expand(kernels::probe_strips{2, 3}, {view<null_device>(*in), view<null_device>(*in)},
                 range{0, 4},
                 triangle_list<null_device>{view<null_device>(*list), view<null_device>(*count),
                                            padding::compact});
    }));
    std::vector<count_record> record(1);
    ASSERT_TRUE(read_back(device, *count, std::span(record)));
    EXPECT_EQ(record[0].required, 24u);
    EXPECT_EQ(record[0].written, 10u);
    EXPECT_EQ(device.counts().expanded_elements, 4u);
    EXPECT_EQ(device.counts().submits, 1u);
}

TEST(null_backend, volumes_take_memory_and_calls_are_counted) {
    null_device device(null_options{{1000, 16, 10, 64, 4, 32}, 5000, false});
    EXPECT_EQ(device.create_volume({33, 1, 1, volume_format::int32}).error().code,
              error_code::out_of_memory);
    EXPECT_EQ(device.create_volume({32, 32, 32, volume_format::int32}).error().code,
              error_code::out_of_memory);
    {
        // Larger than the largest buffer.
        const auto a = device.create_volume({8, 8, 8, volume_format::float32});
        const auto b = device.create_volume({8, 8, 8, volume_format::float16});
        ASSERT_TRUE(a && b);
        const auto boxes = device.create_buffer(320);
        const auto words = device.create_buffer(400);
        using views = buffer_view<null_device>;
        ASSERT_TRUE(run(device, [&](auto& r) {
            r.accumulate(kernels::probe_slabs{6, 0, 0, 1}, {view<null_device>(*boxes)}, range{2, 7},
                         accumulation<null_device>{&*a, true, {}, {}});
            r.scan(*a, *b, volume_scan{});
            r.scan(views{&*words, 0, 80}, views{&*words, 80, 16});
            r.sort(views{&*words, 0, 80}, views{&*words, 80, 80});
            r.map_voxels(kernels::probe_voxels{},
                         {view<null_device>(*boxes), view<null_device>(*words)},
                         {{&*a, &*a}, {&*b, &*b}}, glm::uvec3(2, 3, 4));
        }));
        EXPECT_EQ(device.counts().bytes_alive, 2048u + 1024u + 720u);
        EXPECT_EQ(device.counts().volumes_alive, 2u);
    }
    const auto counts = device.counts();
    EXPECT_EQ(counts.volumes_made, 2u);
    EXPECT_EQ(counts.volumes_alive, 0u);
    EXPECT_EQ(counts.bytes_alive, 0u);
    EXPECT_EQ(counts.accumulates, 1u);
    EXPECT_EQ(counts.accumulated_elements, 7u);
    EXPECT_EQ(counts.slabs, 42u);
    EXPECT_EQ(counts.volume_scans, 1u);
    EXPECT_EQ(counts.voxels_scanned, 512u);
    EXPECT_EQ(counts.words_scanned, 20u);
    EXPECT_EQ(counts.sorted_pairs, 20u);
    EXPECT_EQ(counts.mapped_voxels, 24u);
    EXPECT_EQ(counts.largest_view, 400u);
}

TEST(null_backend, counts_layers_and_bundles) {
    null_device device;
    const auto corners = device.create_buffer(16 * 3 * 10);
    const auto layer = device.create_buffer(4096);
    const auto records = device.create_buffer(48 * 20);
    using views = buffer_view<null_device>;
    ASSERT_TRUE(run(device, [&](auto& r) {
        r.peel(kernels::probe_peel{}, {view<null_device>(*corners)}, range{3, 7},
               peeled_layer<null_device>{
                   20, 10, views{&*layer, 0, 800}, views{&*layer, 800, 800}, {&*layer, 1600, 16}});
        r.resolve(ray_bundle{}, bundle_work<null_device>{view<null_device>(*records),
                                                         {},
                                                         views{&*layer, 0, 320},
                                                         views{&*layer, 320, 160}});
    }));
    const auto counts = device.counts();
    EXPECT_EQ(counts.peels, 1u);
    EXPECT_EQ(counts.peeled_triangles, 7u);
    EXPECT_EQ(counts.peeled_pixels, 200u);
    EXPECT_EQ(counts.resolves, 1u);
    EXPECT_EQ(counts.resolved_samples, 10u);
    EXPECT_EQ(counts.resolved_triangles, 20u);
    EXPECT_EQ(counts.largest_view, 960u);
}

TEST(null_backend, can_be_lost) {
    null_device device;
    const auto a = device.create_buffer(16);
    device.lose();
    EXPECT_EQ(device.create_buffer(16).error().code, error_code::device_lost);
    EXPECT_EQ(device.begin().error().code, error_code::device_lost);
    EXPECT_EQ(device.upload(*a, 0, std::vector<std::byte>(4)).error().code,
              error_code::device_lost);
}

} // namespace
