// Bring your own device: the caller's VkDevice, command buffer, VkBuffer and VkImage, flat or deep.
#include "raw_vulkan.hpp"

namespace skybark::testing {
namespace {

using kernels::probe_box;
using kernels::probe_map;
using kernels::probe_slabs;
using kernels::probe_strips;
using kernels::probe_surface;
using kernels::probe_vertex;

class own_device : public ::testing::Test {
  protected:
    void SetUp() override {
        raw = std::make_unique<raw_vulkan>(log_);
        if (!raw->device) {
            if (vulkan_required()) {
                FAIL() << "no Vulkan device with validation";
            }
            GTEST_SKIP() << "no Vulkan device with validation";
        }
        gpu.emplace(must(device::create(raw->description())));
    }
    void TearDown() override {
        gpu.reset();
        raw.reset();
        EXPECT_TRUE(log_.messages.empty()) << log_.text();
    }

    /// A VkBuffer of the caller's.
    struct raw_buffer {
        VkBuffer buffer = VK_NULL_HANDLE;
        VkDeviceMemory memory = VK_NULL_HANDLE;
    };
    raw_buffer make_raw_buffer(VkDeviceSize size) {
        auto info = vulkan::make<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
        info.size = size;
        info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                     VK_BUFFER_USAGE_TRANSFER_DST_BIT;
        raw_buffer b;
        EXPECT_EQ(VK_SUCCESS, raw->call<PFN_vkCreateBuffer>("vkCreateBuffer")(raw->device, &info,
                                                                              nullptr, &b.buffer));
        VkMemoryRequirements need{};
        raw->call<PFN_vkGetBufferMemoryRequirements>("vkGetBufferMemoryRequirements")(
            raw->device, b.buffer, &need);
        b.memory = raw->memory_for(need);
        EXPECT_EQ(VK_SUCCESS, raw->call<PFN_vkBindBufferMemory>("vkBindBufferMemory")(
                                  raw->device, b.buffer, b.memory, 0));
        return b;
    }
    void destroy(const raw_buffer& b) {
        raw->call<PFN_vkDestroyBuffer>("vkDestroyBuffer")(raw->device, b.buffer, nullptr);
        raw->call<PFN_vkFreeMemory>("vkFreeMemory")(raw->device, b.memory, nullptr);
    }

    log log_;
    std::unique_ptr<raw_vulkan> raw;
    std::optional<device> gpu;
};

TEST_F(own_device, patterns_go_into_the_callers_command_buffer) {
    // Around ours the caller fills a buffer that we read, and copies one that we wrote.
    const std::uint32_t n = 1000;
    const raw_buffer filled = make_raw_buffer(n * 4);
    const raw_buffer copied = make_raw_buffer(n * 4);
    {
        const auto in = gpu->wrap(vulkan::foreign_buffer{filled.buffer, n * 4, {}, {}});
        const auto vectors = must(gpu->create_buffer(n * 16));
        const auto out = must(gpu->create_buffer(n * 4));
        const auto out_vectors = must(gpu->create_buffer(n * 16));
        const auto result_copy = gpu->wrap(vulkan::foreign_buffer{copied.buffer, n * 4, {}, {}});

        const VkCommandBuffer commands = raw->begin();
        raw->call<PFN_vkCmdFillBuffer>("vkCmdFillBuffer")(commands, filled.buffer, 0, n * 4, 5);
        auto recorder = must(gpu->record_into(commands));
        recorder.map(
            probe_map{2, 1, 1.0f, 0.0f},
            {view<device>(in), view<device>(vectors), view<device>(out), view<device>(out_vectors)},
            range{0, n});
        vulkan::ticket ticket = must(gpu->finish(recorder));
        const VkBufferCopy region{0, 0, n * 4};
        raw->call<PFN_vkCmdCopyBuffer>("vkCmdCopyBuffer")(commands, out.handle(), copied.buffer, 1,
                                                          &region);
        raw->submit_and_wait();
        ticket.retire();

        std::vector<std::uint32_t> expected(n);
        for (std::uint32_t i = 0; i < n; ++i) {
            expected[i] = 5 * 2 + 1 + i;
        }
        EXPECT_EQ(download<std::uint32_t>(*gpu, out, n), expected);
        EXPECT_EQ(download<std::uint32_t>(*gpu, result_copy, n), expected);
    }
    destroy(filled);
    destroy(copied);
}

TEST_F(own_device, temporaries_outlive_the_recorder) {
    // The recorder is gone before the submission, another one has been busy since, and uploads,
    // ranges, offsets and indirect arguments are still there.
    const std::uint32_t n = 20000;
    const auto counts = must(gpu->create_buffer(n * 4));
    const auto payloads = must(gpu->create_buffer(n * 16));
    const auto out = must(gpu->create_buffer(n * 96));
    const auto record = must(gpu->create_buffer(16));
    const auto length = upload(*gpu, std::vector<count_record>{{n - 1, 0, {}}});
    const auto other = must(gpu->create_buffer(n * 4));
    const VkCommandBuffer commands = raw->begin();
    vulkan::ticket ticket;
    {
        auto recorder = must(gpu->record_into(commands));
        recorder.upload(view<device>(counts), bytes_of(std::vector<std::uint32_t>(n, 1)));
        recorder.expand(probe_strips{1, 1}, {view<device>(counts), view<device>(payloads)},
                        counted<device>{view<device>(length), n},
                        {view<device>(out), view<device>(record), padding::compact});
        ticket = must(gpu->finish(recorder));
    }
    go(*gpu, [&](auto& r) {
        r.upload(view<device>(other), bytes_of(std::vector<std::uint32_t>(n, 77)));
        r.scan(view<device>(other), view<device>(record));
    });
    raw->submit_and_wait();
    const auto got = download<count_record>(*gpu, record, 1)[0];
    EXPECT_EQ(got.written, n - 1);
    EXPECT_EQ(got.required, n - 1);
    EXPECT_EQ(download<probe_strips::vertex>(*gpu, out, 3 * n)[3 * (n - 2)].place.x,
              static_cast<float>(n - 2));
}

TEST_F(own_device, layers_go_into_the_callers_command_buffer) {
    // A square in each half of the depths; the pictures that layers are drawn into are still there
    // when the recorder is gone and another one has peeled since.
    std::vector<glm::vec4> corners;
    for (const float z : {0.25f, 0.75f}) {
        const glm::vec4 a{-1, -1, z, 0}, b{1, -1, z, 0}, c{1, 1, z, 0}, d{-1, 1, z, 0};
        corners.insert(corners.end(), {a, b, c, a, c, d});
    }
    const auto in = upload(*gpu, corners);
    const auto number = must(gpu->create_buffer(64 * 4));
    const auto count = must(gpu->create_buffer(16));
    const auto far = upload(*gpu, std::vector<float>(64, 1.0f));
    const auto near = upload(*gpu, std::vector<float>(64, 1.0f));
    const auto layer = [&](const vulkan::buffer& depth) {
        return peeled_layer<device>{8, 8, view<device>(depth), view<device>(number),
                                    view<device>(count)};
    };
    const bound<kernels::probe_peel> from{view<device>(in)};
    const VkCommandBuffer commands = raw->begin();
    vulkan::ticket ticket;
    {
        auto recorder = must(gpu->record_into(commands));
        recorder.peel(kernels::probe_peel{}, from, range{0, 4}, layer(far));
        recorder.peel(kernels::probe_peel{}, from, range{0, 2}, layer(near));
        ticket = must(gpu->finish(recorder));
    }
    const auto other = upload(*gpu, std::vector<float>(64, 0.5f));
    go(*gpu, [&](auto& r) { r.peel(kernels::probe_peel{}, from, range{0, 4}, layer(other)); });
    raw->submit_and_wait();
    EXPECT_EQ(download<float>(*gpu, far, 64), std::vector<float>(64, 0.75f));
    EXPECT_EQ(download<float>(*gpu, near, 64), std::vector<float>(64, 0.25f));
    EXPECT_EQ(download<float>(*gpu, other, 64), std::vector<float>(64, 0.25f));
    EXPECT_EQ(download<count_record>(*gpu, count, 1)[0].written, 64u);
}

TEST_F(own_device, a_recorder_without_submission_leaves_nothing) {
    { auto dropped = must(gpu->begin()); }
    auto recorder = must(gpu->begin());
    must(gpu->submit(recorder));
    EXPECT_EQ(gpu->submit(recorder).error().code, error_code::bad_input);
}

TEST_F(own_device, draws_into_the_callers_image_and_leaves_it_in_the_layout_asked_for) {
    const std::uint32_t size = 4;
    auto info = vulkan::make<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = VK_FORMAT_B8G8R8A8_UNORM; // as in a swapchain
    info.extent = {size, size, 1};
    info.mipLevels = info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    VkImage image = VK_NULL_HANDLE;
    ASSERT_EQ(VK_SUCCESS,
              raw->call<PFN_vkCreateImage>("vkCreateImage")(raw->device, &info, nullptr, &image));
    VkMemoryRequirements need{};
    raw->call<PFN_vkGetImageMemoryRequirements>("vkGetImageMemoryRequirements")(raw->device, image,
                                                                                &need);
    const VkDeviceMemory memory = raw->memory_for(need);
    ASSERT_EQ(VK_SUCCESS,
              raw->call<PFN_vkBindImageMemory>("vkBindImageMemory")(raw->device, image, memory, 0));
    {
        vulkan::foreign_image foreign;
        foreign.image = image;
        foreign.description = {size, size, image_format::rgba8};
        foreign.format = info.format;
        foreign.layout_before = VK_IMAGE_LAYOUT_UNDEFINED;
        foreign.layout_after = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
        const auto target = must(gpu->wrap(foreign));
        const auto copy = must(gpu->create_buffer(size * size * 4));
        const glm::vec4 color{1, 0, 0, 1};
        const auto vertices = upload(*gpu, std::vector<probe_vertex>{{{-1, -1, 0, 1}, color},
                                                                     {{3, -1, 0, 1}, color},
                                                                     {{-1, 3, 0, 1}, color}});
        const auto tints = upload(*gpu, std::vector<glm::vec4>{{1, 1, 1, 1}});
        const VkCommandBuffer commands = raw->begin();
        auto recorder = must(gpu->record_into(commands));
        for (int twice = 0; twice < 2; ++twice) {
            recorder.draw(probe_surface{},
                          bound<probe_surface>{view<device>(vertices), view<device>(tints)}, {},
                          draw_geometry<device>{{}, 0, 3, 0, {}},
                          draw_target<device>{&target, nullptr, glm::vec4{0}, {}}, draw_state{});
        }
        const vulkan::ticket ticket = must(gpu->finish(recorder));
        VkBufferImageCopy region{};
        region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
        region.imageExtent = info.extent;
        raw->call<PFN_vkCmdCopyImageToBuffer>("vkCmdCopyImageToBuffer")(
            commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, copy.handle(), 1, &region);
        raw->submit_and_wait();
        EXPECT_EQ(download<std::uint32_t>(*gpu, copy, size * size),
                  std::vector<std::uint32_t>(size * size, 0xffff0000u)); // bytes b, g, r, a
    }
    raw->call<PFN_vkDestroyImage>("vkDestroyImage")(raw->device, image, nullptr);
    raw->call<PFN_vkFreeMemory>("vkFreeMemory")(raw->device, memory, nullptr);
}

TEST_F(own_device, adds_into_the_callers_volume_and_leaves_it_in_the_layout_asked_for) {
    auto info = vulkan::make<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
    info.imageType = VK_IMAGE_TYPE_3D;
    info.format = VK_FORMAT_R32_SINT;
    info.extent = {6, 5, 4};
    info.mipLevels = info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                 VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    VkImage image = VK_NULL_HANDLE;
    ASSERT_EQ(VK_SUCCESS,
              raw->call<PFN_vkCreateImage>("vkCreateImage")(raw->device, &info, nullptr, &image));
    VkMemoryRequirements need{};
    raw->call<PFN_vkGetImageMemoryRequirements>("vkGetImageMemoryRequirements")(raw->device, image,
                                                                                &need);
    const VkDeviceMemory memory = raw->memory_for(need);
    ASSERT_EQ(VK_SUCCESS,
              raw->call<PFN_vkBindImageMemory>("vkBindImageMemory")(raw->device, image, memory, 0));
    {
        vulkan::foreign_volume foreign;
        foreign.image = image;
        foreign.description = {6, 5, 4, volume_format::int32};
        foreign.layout_before = VK_IMAGE_LAYOUT_UNDEFINED;
        foreign.layout_after = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
        const auto sums = must(gpu->wrap(foreign));
        const auto scanned = must(gpu->create_volume({6, 5, 4, volume_format::float32}));
        const auto copy = must(gpu->create_buffer(6 * 5 * 4 * 4));
        const auto boxes =
            upload(*gpu, std::vector<probe_box>{{{0, 0, 1, 7}, {6, 5, 2, 0}}}); // 7 in layer 1
        const VkCommandBuffer commands = raw->begin();
        auto recorder = must(gpu->record_into(commands));
        for (const bool clear : {true, false}) {
            recorder.accumulate(probe_slabs{1, 0, 0, 1}, {view<device>(boxes)}, range{0, 1},
                                accumulation<device>{&sums, clear});
        }
        recorder.scan(sums, scanned,
                      volume_scan{scan_axis::y, scan_direction::descending, scan_share::whole, 1});
        const vulkan::ticket ticket = must(gpu->finish(recorder));
        VkBufferImageCopy region{};
        region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
        region.imageExtent = info.extent;
        raw->call<PFN_vkCmdCopyImageToBuffer>("vkCmdCopyImageToBuffer")(
            commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, copy.handle(), 1, &region);
        raw->submit_and_wait();
        std::vector<float> attenuation(120);
        must(gpu->download(scanned, std::as_writable_bytes(std::span(attenuation))));
        const auto sums_now = download<std::int32_t>(*gpu, copy, 120);
        for (std::size_t i = 0; i < 120; ++i) {
            const bool in_layer = i / 30 == 1;
            const auto rows_above = static_cast<float>(5 - i % 30 / 6);
            EXPECT_EQ(sums_now[i], in_layer ? 14 : 0) << i;
            EXPECT_EQ(attenuation[i], in_layer ? 14 * rows_above : 0) << i;
        }
    }
    raw->call<PFN_vkDestroyImage>("vkDestroyImage")(raw->device, image, nullptr);
    raw->call<PFN_vkFreeMemory>("vkFreeMemory")(raw->device, memory, nullptr);
}

TEST_F(own_device, has_volumes_of_float16_only_with_their_feature) {
    const auto refused = gpu->create_volume({4, 4, 4, volume_format::float16});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, error_code::unavailable);
    EXPECT_NE(refused.error().message.find("shaderStorageImageExtendedFormats"), std::string::npos);
}

TEST_F(own_device, is_refused_without_the_features_that_we_rely_on) {
    auto description = raw->description();
    description.synchronization2 = false;
    const auto refused = device::create(description);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, error_code::unavailable);
    EXPECT_NE(refused.error().message.find("synchronization2"), std::string::npos);
}

} // namespace
} // namespace skybark::testing
