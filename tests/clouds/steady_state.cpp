// What a relit frame costs besides the work: no memory, no bytes across, no misuse of the contract.
#include "support/allocations.hpp"
#include "support/cloud_sums.hpp"
#include "support/devices.hpp"

#include <skybark/conformance/null_backend.hpp>
#include <skybark/core/validated.hpp>

namespace {

using namespace skybark;
using namespace skybark::clouds;
using namespace skybark::support;

constexpr glm::vec3 slanting{0.4f, 0.7f, -0.3f};

std::vector<attenuation_options> ways() {
    std::vector<attenuation_options> found;
    for (const auto profile : {attenuation_profile::step, attenuation_profile::erf}) {
        found.push_back(with(attenuation_method::impulse_scan, profile));
        found.push_back(with(attenuation_method::shadow_polygons, profile));
        found.back().policy = padding::degenerate;
        found.back().list_bytes = 1 << 16;
        found.push_back(with(attenuation_method::shadow_polygons, profile));
        found.back().polygons = polygon_source::stage;
    }
    return found;
}

TEST(relit_frame, allocates_nothing_on_the_host) {
    if (!SKYBARK_TEST_COUNTS_ALLOCATIONS) {
        GTEST_SKIP() << "Allocations are the sanitizer's here.";
    }
    cpu::device device;
    const auto particles = ball(500, 0.05f, 0.2f, 0.5f, 1);
    const auto buffer = make_buffer<cpu::device, cloud_particle>(device, std::span(particles));
    ASSERT_TRUE(buffer);
    for (const attenuation_options& way : ways()) {
        auto volume = attenuation_volume<cpu::device>::create(device, glm::uvec3(24), way);
        ASSERT_TRUE(volume);
        std::uint64_t counts[3];
        for (std::uint64_t& count : counts) {
            auto recorder = device.begin();
            ASSERT_TRUE(recorder);
            const std::uint64_t before = allocations;
            const auto box = fit_light_box(particles, slanting, glm::uvec3(24));
            volume->relight(*recorder, view<cpu::device>(*buffer), 500, *box);
            count = allocations - before;
            ASSERT_TRUE(device.submit(*recorder));
        }
        EXPECT_EQ(counts[2], 0u);
    }
}

TEST(relit_frame, sends_parameters_alone) {
    for (const char* name : {"cpu", "opengl", "vulkan"}) {
        support::with_device(name, [](auto& device) {
            using B = std::remove_reference_t<decltype(device)>;
            const auto particles = ball(500, 0.05f, 0.2f, 0.5f, 2);
            const auto buffer = make_buffer<B, cloud_particle>(device, std::span(particles));
            ASSERT_TRUE(buffer);
            for (const attenuation_options& way : ways()) {
                auto volume = attenuation_volume<B>::create(device, glm::uvec3(24), way);
                const auto box = fit_light_box(particles, slanting, glm::uvec3(24));
                ASSERT_TRUE(volume && box);
                const device_traffic before = device.traffic();
                ASSERT_TRUE(run(device, [&](auto& recorder) {
                    volume->relight(recorder, view<B>(*buffer), 500, *box);
                }));
                // Kernels' parameters; the particles would be 16,000 bytes.
                EXPECT_LT(device.traffic().up - before.up, 4096u);
                EXPECT_EQ(device.traffic().down, before.down);
            }
        });
    }
}

TEST(relit_frame, makes_no_objects) {
    conformance::null_device device;
    using B = conformance::null_device;
    const auto particles = ball(500, 0.05f, 0.2f, 0.5f, 3);
    const auto buffer = make_buffer<B, cloud_particle>(device, std::span(particles));
    ASSERT_TRUE(buffer);
    for (const attenuation_options& way : ways()) {
        auto volume = attenuation_volume<B>::create(device, glm::uvec3(24), way);
        const auto box = fit_light_box(particles, slanting, glm::uvec3(24));
        ASSERT_TRUE(volume && box);
        const conformance::null_counts before = device.counts();
        ASSERT_TRUE(run(device, [&](auto& recorder) {
            volume->relight(recorder, view<B>(*buffer), 500, *box);
        }));
        const conformance::null_counts after = device.counts();
        EXPECT_EQ(after.buffers_made, before.buffers_made);
        EXPECT_EQ(after.volumes_made, before.volumes_made);
        EXPECT_EQ(after.bytes_alive, before.bytes_alive);
        EXPECT_GT(after.accumulates, before.accumulates);
    }
}

TEST(relit_frame, keeps_to_the_contract) {
    cpu::device inner;
    using B = validated<cpu::device>;
    std::string misuse;
    B device(inner, [&](std::string_view sentence) { misuse = sentence; });
    const auto particles = ball(500, 0.05f, 0.2f, 0.5f, 4);
    const auto buffer = make_buffer<B, cloud_particle>(device, std::span(particles));
    ASSERT_TRUE(buffer);
    for (const attenuation_options& way : ways()) {
        auto volume = attenuation_volume<B>::create(device, glm::uvec3(24), way);
        const auto box = fit_light_box(particles, slanting, glm::uvec3(24));
        ASSERT_TRUE(volume && box);
        for (const std::uint32_t count : {500u, 0u}) {
            ASSERT_TRUE(run(device, [&](auto& recorder) {
                volume->relight(recorder, view<B>(*buffer), count, *box);
            }));
            EXPECT_EQ(misuse, "");
        }
        std::vector<float> values(24 * 24 * 24);
        ASSERT_TRUE(device.download(volume->volume(), std::as_writable_bytes(std::span(values))));
        EXPECT_EQ(*std::max_element(values.begin(), values.end()), 0.0f); // of no particles
    }
}

} // namespace
