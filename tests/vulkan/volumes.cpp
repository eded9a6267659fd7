// Volumes where Vulkan has edges of its own: transfers in pieces, sizes that cannot be had, and
// slabs whose loops a software rasteriser would end. What volumes mean is in the conformance suite.
#include "support.hpp"

namespace skybark::testing {
namespace {

using kernels::probe_box;
using kernels::probe_slabs;

class volumes : public both_ways {};
INSTANTIATE_TEST_SUITE_P(vulkan, volumes, ::testing::Bool(), way_name);

TEST_P(volumes, go_up_and_down_in_layers_and_in_rows) {
    for (const volume_description what :
         {volume_description{1024, 512, 21, volume_format::int32}, // 2 MiB a layer
          volume_description{2048, 4096, 2, volume_format::int32}, // 32 MiB a layer
          volume_description{1, 1, 1, volume_format::float16},
          volume_description{3, 5, 7, volume_format::float16}}) {
        if (std::max({what.width, what.height, what.depth}) > gpu().limits().max_volume_size) {
            continue;
        }
        const auto volume = must(gpu().create_volume(what));
        noise random;
        std::vector<std::uint16_t> sent(what.size_bytes() / 2);
        for (std::uint16_t& half : sent) {
            half = static_cast<std::uint16_t>(random() & 0x3bffu); // a number below 1
        }
        const device_traffic before = gpu().traffic();
        must(gpu().upload(volume, bytes_of(sent)));
        std::vector<std::uint16_t> back(sent.size());
        must(gpu().download(volume, std::as_writable_bytes(std::span(back))));
        EXPECT_TRUE(back == sent) << what.width << " x " << what.height << " x " << what.depth;
        EXPECT_EQ(gpu().traffic().up - before.up, what.size_bytes());
        EXPECT_EQ(gpu().traffic().down - before.down, what.size_bytes());
    }
}

TEST_P(volumes, sizes_that_cannot_be_had_are_named) {
    const std::uint32_t most = gpu().limits().max_volume_size;
    ASSERT_GE(most, 256u); // what Vulkan promises
    for (const volume_description what :
         {volume_description{0, 1, 1, volume_format::float32},
          volume_description{1, 1, most + 1, volume_format::float32},
          volume_description{~0u, ~0u, ~0u, volume_format::int32},
          volume_description{most, most, most, volume_format::float32}}) {
        const auto refused = gpu().create_volume(what);
        ASSERT_FALSE(refused) << what.width;
        EXPECT_EQ(refused.error().code, error_code::out_of_memory);
        EXPECT_NE(refused.error().message.find(std::to_string(what.width) + " x "),
                  std::string::npos)
            << refused.error().message;
    }
}

/// One box all over a volume, with a slab a layer: what is added to (x, y, z), and how often, must
/// be there however long a software rasteriser's loops would be.
void expect_whole_slabs(device& gpu, glm::uvec3 size) {
    const auto sums = must(gpu.create_volume({size.x, size.y, size.z, volume_format::int32}));
    const glm::ivec3 end(size);
    // Slab s begins s columns later and ends s rows earlier; all reach over the sides by more.
    const std::vector<probe_box> boxes{{{-end.z, -3, 0, 5}, {end.x + 2, end.y + end.z, end.z, 1}},
                                       {{-end.z, -3, 0, 5}, {end.x + 2, end.y + end.z, end.z, 1}}};
    const auto in = upload(gpu, boxes);
    const probe_slabs kernel{size.z, 2, -7, 1};
    go(gpu, [&](auto& r) {
        r.accumulate(kernel, {view<device>(in)}, range{0, 2}, accumulation<device>{&sums, true});
    });
    std::vector<std::int32_t> got(std::size_t{size.x} * size.y * size.z);
    must(gpu.download(sums, std::as_writable_bytes(std::span(got))));
    std::size_t wrong = 0;
    std::size_t at = 0;
    for (int z = 0; z < end.z; ++z) {
        for (int y = 0; y < end.y; ++y) {
            for (int x = 0; x < end.x; ++x) {
                wrong += got[at++] != 2 * (5 + 2 * x - 7 * z + y);
            }
        }
    }
    EXPECT_EQ(wrong, 0u) << size.x << " x " << size.y << " x " << size.z;
}

TEST_P(volumes, slabs_as_large_as_the_volume_are_added_whole) {
    expect_whole_slabs(gpu(), {160, 160, 60}); // 60 slabs of 25,760 voxels and turns
    expect_whole_slabs(gpu(), {700, 300, 3});
    expect_whole_slabs(gpu(), {256, 2048, 1}); // a slab of 524,544
}

} // namespace
} // namespace skybark::testing
