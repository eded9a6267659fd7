// Memory: what is allocated, when, and what happens when there is none.

#include "support/allocations.hpp"
#include "support/cpu_work.hpp"

#include <gtest/gtest.h>

using namespace skybark;
using support::allocations;

TEST(cpu_device, steady_state_allocates_nothing) {
    if (!SKYBARK_TEST_COUNTS_ALLOCATIONS) {
        GTEST_SKIP() << "Allocations are the sanitizer's here.";
    }
    for (const std::uint32_t threads : {1u, 3u}) {
        cpu::device_options options;
        options.threads = threads;
        cpu::device device(options);
        support::cpu_work work(device);
        work.run();
        work.run();
        const std::uint64_t before = allocations;
        work.run();
        EXPECT_EQ(allocations - before, 0u) << threads;
    }
}

TEST(cpu_device, counting_sees_an_allocation) {
    if (!SKYBARK_TEST_COUNTS_ALLOCATIONS) {
        GTEST_SKIP() << "Allocations are the sanitizer's here.";
    }
    const std::uint64_t before = allocations;
    ::operator delete(::operator new(1000)); // a new expression may be left out by the compiler
    EXPECT_EQ(allocations - before, 1u);
}

TEST(cpu_device, buffer_beyond_memory_is_an_error) {
    if (!SKYBARK_TEST_COUNTS_ALLOCATIONS) {
        GTEST_SKIP() << "A sanitizer ends the program.";
    }
    cpu::device device;
    const auto huge = device.create_buffer(std::uint64_t{1} << 46);
    ASSERT_FALSE(huge);
    EXPECT_EQ(huge.error().code, error_code::out_of_memory);
    EXPECT_EQ(huge.error().message,
              "The cpu backend could not allocate a buffer of 70368744177664 bytes.");
}

// So large that adding an alignment would wrap around.
TEST(cpu_device, buffer_beyond_its_limits_is_an_error) {
    cpu::device device;
    for (const std::uint64_t bytes : {~std::uint64_t{0}, ~std::uint64_t{0} - 63}) {
        const auto impossible = device.create_buffer(bytes);
        ASSERT_FALSE(impossible);
        EXPECT_EQ(impossible.error().code, error_code::out_of_memory);
    }
}

TEST(cpu_device, limits_of_the_callers_are_kept) {
    cpu::device_options options;
    options.limits.max_buffer_bytes = 1000;
    options.limits.max_image_size = 64;
    cpu::device device(options);
    EXPECT_EQ(device.limits().max_buffer_bytes, 1000u);
    EXPECT_TRUE(device.create_buffer(1000));
    EXPECT_FALSE(device.create_buffer(1001));
    EXPECT_TRUE(device.create_image({64, 64, image_format::rgba8}));
    for (const image_description what : {image_description{65, 64, image_format::rgba8},
                                         image_description{64, 65, image_format::rgba8},
                                         image_description{0, 1, image_format::rgba8},
                                         image_description{1, 0, image_format::rgba8}}) {
        const auto image = device.create_image(what);
        ASSERT_FALSE(image);
        EXPECT_EQ(image.error().code, error_code::out_of_memory);
        EXPECT_NE(image.error().message.find("1 to 64"), std::string::npos);
    }
}

TEST(cpu_device, memory_is_aligned_and_zero) {
    cpu::device device;
    for (const std::uint64_t bytes : {0u, 1u, 15u, 64u, 100'000u}) {
        const auto buffer = support::expect_value(device.create_buffer(bytes));
        EXPECT_EQ(buffer.size_bytes(), bytes);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(buffer.data()) % cpu::memory_alignment, 0u);
        for (std::uint64_t i = 0; i < bytes; ++i) {
            ASSERT_EQ(buffer.data()[i], std::byte{0});
        }
    }
}

TEST(cpu_device, buffer_keeps_its_memory_when_it_moves) {
    cpu::device device;
    auto buffer = support::expect_value(device.create_buffer(64));
    buffer.data()[5] = std::byte{42};
    const cpu::buffer moved = std::move(buffer);
    EXPECT_EQ(moved.size_bytes(), 64u);
    EXPECT_EQ(moved.data()[5], std::byte{42});
}

TEST(cpu_device, callers_memory_can_be_a_buffer_and_an_image) {
    cpu::device device;
    alignas(16) float floats[4 * 40];
    for (float& f : floats) {
        f = -1;
    }
    const auto memory = std::as_writable_bytes(std::span(floats));
    const cpu::buffer guarded = cpu::buffer::wrap(memory.subspan(16, 16 * 38));
    const std::vector<glm::vec4> payload(12, glm::vec4(1, 2, 3, 4));
    const auto payloads =
        support::expect_value(make_buffer<cpu::device, glm::vec4>(device, payload));
    auto r = support::expect_value(device.begin());
    // Room for 38 vertices: twelve elements of three, and nothing past them.
    r.expand_rings(kernels::probe_rings{3}, {view<cpu::device>(payloads)}, range{0, 12},
                   view<cpu::device>(guarded));
    ASSERT_TRUE(device.submit(r));
    EXPECT_EQ(floats[3], -1);
    for (int i = 0; i < 36; ++i) {
        EXPECT_EQ(floats[4 + 4 * i], static_cast<float>(i / 3));
        EXPECT_EQ(floats[4 + 4 * i + 1], static_cast<float>(i % 3));
    }
    for (int i = 4 * 37; i < 4 * 40; ++i) {
        EXPECT_EQ(floats[i], -1);
    }

    const cpu::image image =
        cpu::image::wrap(memory.subspan(64, 64), {4, 4, image_format::depth32f});
    EXPECT_EQ(image.size_bytes(), 64u);
    draw_geometry<cpu::device> nothing;
    const draw_target<cpu::device> target{nullptr, &image, {}, 0.75f};
    auto clearing = support::expect_value(device.begin());
    clearing.draw(kernels::probe_surface{}, {buffer_view<cpu::device>{}, {}}, {}, nothing, target,
                  draw_state{});
    ASSERT_TRUE(device.submit(clearing));
    EXPECT_EQ(floats[15], 1.0f * 2); // vertex 2 of element 0 … y of the third vertex's neighbour
    for (int i = 16; i < 32; ++i) {
        EXPECT_EQ(floats[i], 0.75f);
    }
}

TEST(cpu_device, bytes_that_cross_are_counted) {
    cpu::device device;
    const auto buffer = support::expect_value(device.create_buffer(100));
    std::vector<std::byte> bytes(60, std::byte{7});
    ASSERT_TRUE(device.upload(buffer, 40, bytes));
    ASSERT_TRUE(device.download(buffer, 50, std::span(bytes).first(30)));
    EXPECT_EQ(device.traffic().up, 60u);
    EXPECT_EQ(device.traffic().down, 30u);
    auto r = support::expect_value(device.begin());
    r.upload(view<cpu::device>(buffer), std::span<const std::byte>(bytes).first(10));
    ASSERT_TRUE(device.submit(r));
    EXPECT_EQ(device.traffic().up, 70u);
    EXPECT_EQ(buffer.data()[0], std::byte{7});
    EXPECT_EQ(buffer.data()[10], std::byte{0});
}
