// cloud_billboards whose outlines noise eats into: what it may take, and that it takes no light.

#include "support/devices.hpp"

#include <picture/daylight.hpp>
#include <skybark/clouds/cloud_billboards.hpp>
#include <skybark/clouds/cumulus.hpp>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

using namespace skybark;
using namespace skybark::clouds;
using glm::vec3;
using glm::vec4;

namespace {

constexpr std::uint32_t side = 96;

/// From 100 m before the origin; no sun, and light of (2, 3, 4) from everywhere.
kernels::scene_record even_light() {
    kernels::scene_record scene{};
    const vec3 eye(0, 0, 100);
    scene.to_clip = glm::perspectiveRH_ZO(glm::radians(40.0f), 1.0f, 0.1f, 10000.0f) *
                    glm::lookAtRH(eye, vec3(0), vec3(0, 1, 0));
    scene.from_clip = glm::inverse(scene.to_clip);
    scene.camera = vec4(eye, 0);
    scene.sky = picture::daylight({0, 1, 0}, 2.5);
    scene.sky.sunlight = vec4(0);
    scene.ambient[0] = vec4(2, 3, 4, 0);
    return scene;
}

/// Particles over `background`, their attenuation 0 everywhere.
template <volume_backend B>
std::vector<vec4> draw(B& device, std::span<const cloud_particle> particles,
                       const cloud_lighting& lighting, vec4 background) {
    const std::vector<float> nothing(64, 0.0f);
    auto clear = *device.create_volume({4, 4, 4, volume_format::float32});
    EXPECT_TRUE(device.upload(clear, std::as_bytes(std::span(nothing))));
    const auto count = static_cast<std::uint32_t>(particles.size());
    const auto scene = even_light();
    auto on_device = *make_buffer<B, cloud_particle>(device, particles);
    auto scenes = *make_buffer<B, kernels::scene_record>(device, std::span(&scene, 1));
    auto puffs = *cloud_billboards<B>::create(device, count);
    auto color = *device.create_image({side, side, image_format::rgba32f});
    auto depth = *device.create_image({side, side, image_format::depth32f});
    const auto done = run(device, [&](typename B::recorder& r) {
        puffs.record(r, view<B>(on_device), count, vec3(scene.camera), view<B>(scenes),
                     {lighting, &clear, &clear, nullptr, {}}, {&color, &depth, background, 1.0f});
    });
    EXPECT_TRUE(done) << done.error().message;
    std::vector<vec4> pixels(side * side);
    EXPECT_TRUE(device.download(color, std::as_writable_bytes(std::span(pixels))));
    return pixels;
}

cloud_lighting sky_alone(float torn, float grain) {
    light_box box;
    box.grid.row_x = vec4(1, 0, 0, 0);
    box.grid.row_y = vec4(0, 1, 0, 0);
    box.grid.row_z = vec4(0, 0, 1, 0);
    box.grid.voxel = vec4(1, 1, 1, 0x1p-22f);
    const auto phase = phase_function::isotropic();
    cloud_lighting lighting = single_scattering({}, box, phase);
    add_sky(lighting, {}, box, phase);
    add_tears(lighting, torn, grain);
    return lighting;
}

class torn_outlines : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(on, torn_outlines, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& one) { return std::string(one.param); });

/// Noise n, 0 to 1, leaves (b − tn) / (1 − tn) of a Gaussian body b; depths are τ of that.
TEST_P(torn_outlines, lose_their_rims_and_keep_their_middles) {
    support::with_device(GetParam(), [](auto& device) {
        const cloud_particle p{{0, 0, 0}, 30, 6, 1};
        const auto whole = draw(device, {&p, 1}, sky_alone(0, 8), vec4(0));
        const double torn = 0.6;
        const auto rest = draw(device, {&p, 1}, sky_alone(0.6f, 8), vec4(0));
        int kept = 0;
        int eaten = 0;
        int other = 0;
        for (std::size_t i = 0; i < whole.size(); ++i) {
            const double before = double{whole[i].a};
            const double after = double{rest[i].a};
            const double body = -std::log1p(-before) / 6;
            const double least = std::max(body - torn, 0.0) / (1 - torn);
            ASSERT_LE(after, before + 1e-5) << i;
            ASSERT_GE(after, 1 - std::exp(-6 * least) - 1e-4) << i;
            kept += before > 0.995 && after > 0.985 ? 1 : 0;
            eaten += before > 0.1 && after == 0 ? 1 : 0;
            other += before > 0.1 && after > 0 && after < 0.9 * before ? 1 : 0;
        }
        EXPECT_GT(kept, 100);
        EXPECT_GT(eaten, 200);
        EXPECT_GT(other, 200);
    });
}

TEST_P(torn_outlines, vanish_in_light_from_everywhere) {
    support::with_device(GetParam(), [](auto& device) {
        std::vector<cloud_particle> cloud;
        for (int i = 0; i < 12; ++i) {
            const auto at = static_cast<float>(i);
            cloud.push_back({{3 * at - 18, 2 * std::fmod(at, 5.0f) - 4, at - 6}, 12, 2, 1});
        }
        for (const vec4& pixel : draw(device, cloud, sky_alone(0.6f, 8), vec4(2, 3, 4, 1))) {
            // Twelve compositings, each of them rounded.
            ASSERT_NEAR(pixel.r, 2, 2e-5);
            ASSERT_NEAR(pixel.g, 3, 3e-5);
            ASSERT_NEAR(pixel.b, 4, 4e-5);
        }
    });
}

TEST_P(torn_outlines, are_those_of_the_cpu) {
    support::with_device(GetParam(), [](auto& device) {
        cumulus_options options;
        options.particles = 300;
        options.base = {0, -20, 0};
        options.width = 60;
        options.thickness = 40;
        options.extinction = 2;
        const auto cloud = cumulus_cloud(options);
        cpu::device cpu;
        const auto expected = draw(cpu, cloud, sky_alone(0.6f, 5), vec4(0));
        const auto actual = draw(device, cloud, sky_alone(0.6f, 5), vec4(0));
        double sum = 0;
        double seen = 0;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            sum += std::abs(double{actual[i].a} - double{expected[i].a});
            seen += double{expected[i].a};
        }
        const auto pixels = static_cast<double>(expected.size());
        EXPECT_GT(seen / pixels, 0.1);
        // 1/255 on average is what pictures may differ by: a tenth of that.
        EXPECT_LT(sum / pixels, 0.1 / 255);
    });
}

} // namespace
