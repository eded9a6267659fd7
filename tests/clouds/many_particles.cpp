// More particles than a kernel can be given at once.

#include "support/cloud_sums.hpp"
#include "support/devices.hpp"

#include <skybark/core/validated.hpp>

#include <string>

namespace {

using namespace skybark;
using namespace skybark::clouds;
using namespace skybark::support;

using plain = cpu::device;
using checked = validated<plain>;

/// The volume of 1,000 particles on a device that takes `most` at once, and what was misused.
std::vector<float> lit(std::uint64_t most, const attenuation_options& options,
                       std::string& misuse) {
    const auto particles = ball(1000, 0.05f, 0.2f, 0.5f, 3);
    cpu::device_options limits;
    limits.limits.max_elements = most;
    plain inner(limits);
    checked device(inner, [&](std::string_view sentence) { misuse = sentence; });
    const auto box = fit_light_box(particles, {0.4f, 0.7f, -0.3f}, glm::uvec3(24)).value();
    auto volume = attenuation_volume<checked>::create(device, box.voxels, options);
    const auto sent = make_buffer<checked, cloud_particle>(device, std::span(particles));
    std::vector<float> values(24 * 24 * 24);
    if (!volume || !sent) {
        ADD_FAILURE() << (volume ? sent.error() : volume.error()).message;
        return values;
    }
    EXPECT_TRUE(
        run(device, [&](auto& to) { volume->relight(to, view<checked>(*sent), 1000, box); }));
    EXPECT_TRUE(device.download(volume->volume(), std::as_writable_bytes(std::span(values))));
    return values;
}

TEST(many_particles, go_through_in_parts_and_make_the_same_bits) {
    attenuation_options stage = with(attenuation_method::shadow_polygons, attenuation_profile::erf);
    stage.polygons = polygon_source::stage;
    for (const attenuation_options& way :
         {with(attenuation_method::impulse_scan, attenuation_profile::erf), stage}) {
        std::string misuse;
        const auto expected = lit(1 << 20, way, misuse);
        EXPECT_GT(*std::max_element(expected.begin(), expected.end()), 1.0f);
        for (const std::uint64_t most : {999u, 300u, 128u}) {
            EXPECT_EQ(lit(most, way, misuse), expected) << most;
            EXPECT_EQ(misuse, "") << most;
        }
    }
}

/// 134 MiB of them, where a view may have 128 on some devices.
TEST(many_particles, of_a_buffer_longer_than_a_view_slow) {
    constexpr std::uint32_t count = 4'400'000;
    const auto particles = ball(count, 0.001f, 0.002f, 0.05f, 5);
    const auto box = fit_light_box(particles, {0.4f, 0.7f, -0.3f}, glm::uvec3(48)).value();
    std::vector<float> expected;
    for (const char* name : {"cpu", "opengl", "vulkan"}) {
        with_device(name, [&](auto& device) {
            using B = std::remove_reference_t<decltype(device)>;
            auto volume = attenuation_volume<B>::create(device, box.voxels);
            const auto sent = make_buffer<B, cloud_particle>(device, std::span(particles));
            ASSERT_TRUE(volume && sent);
            ASSERT_TRUE(
                run(device, [&](auto& to) { volume->relight(to, view<B>(*sent), count, box); }));
            std::vector<float> values(48 * 48 * 48);
            ASSERT_TRUE(
                device.download(volume->volume(), std::as_writable_bytes(std::span(values))));
            if (expected.empty()) {
                expected = values;
                EXPECT_GT(*std::max_element(values.begin(), values.end()), 0.1f);
            }
            double worst = 0;
            for (std::size_t i = 0; i < values.size(); ++i) {
                worst = std::max(worst, std::abs(double{values[i]} - double{expected[i]}));
            }
            EXPECT_LE(worst, 1e-4) << name; // asked for
        });
    }
}

} // namespace
