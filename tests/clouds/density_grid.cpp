// The attenuation volume of a density grid, against line integrals in closed form.
#include "support/cloud_sums.hpp"
#include "support/devices.hpp"

#include <skybark/clouds/attenuation_volume.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace {

using namespace skybark;
using namespace skybark::clouds;
using support::middle_of;

constexpr glm::uvec3 grid_size(48, 40, 56);
const density_box where{{-2, -1, -3}, {2, 3, 3}, 0.8f, 1.0f};

std::vector<float> densities(const std::function<double(glm::dvec3)>& density) {
    std::vector<float> values;
    const glm::dvec3 step = glm::dvec3(where.high - where.low) / glm::dvec3(grid_size);
    for (std::uint32_t z = 0; z < grid_size.z; ++z) {
        for (std::uint32_t y = 0; y < grid_size.y; ++y) {
            for (std::uint32_t x = 0; x < grid_size.x; ++x) {
                const glm::dvec3 at = glm::dvec3(where.low) + (glm::dvec3(x, y, z) + 0.5) * step;
                values.push_back(static_cast<float>(density(at)));
            }
        }
    }
    return values;
}

/// The attenuation of `values` (float32, or the bits of float16) under a sun.
template <class B, class T>
std::vector<float> lit(B& device, const std::vector<T>& values, const light_box& box,
                       const attenuation_options& options, float albedo = 1) {
    auto density =
        device.create_volume({grid_size.x, grid_size.y, grid_size.z,
                              sizeof(T) == 2 ? volume_format::float16 : volume_format::float32});
    density_box in = where;
    in.albedo = albedo;
    auto volume = attenuation_volume<B>::create(device, box.voxels, options);
    if (!density || !volume || !volume->prepare_for_grids(device) ||
        !device.upload(*density, std::as_bytes(std::span(values))) ||
        !run(device, [&](auto& recorder) { volume->relight(recorder, *density, in, box); })) {
        ADD_FAILURE() << "the grid was not lit";
        return {};
    }
    std::vector<float> found(std::size_t{box.voxels.x} * box.voxels.y * box.voxels.z);
    if (!device.download(volume->volume(), std::as_writable_bytes(std::span(found)))) {
        ADD_FAILURE() << "no download";
    }
    return found;
}

light_box box_for(glm::vec3 sun, glm::uvec3 voxels) { return *fit_light_box(where, sun, voxels); }

class grid_attenuation : public testing::TestWithParam<const char*> {};

TEST_P(grid_attenuation, of_a_gaussian_is_an_error_function) {
    support::with_device(GetParam(), [](auto& device) {
        const glm::dvec3 centre(0, 1, 0);
        const double sigma = 0.5;
        const auto values = densities([&](glm::dvec3 p) {
            return std::exp(-glm::dot(p - centre, p - centre) / (2 * sigma * sigma));
        });
        for (const glm::vec3 sun : {glm::vec3(0, 1, 0), glm::vec3(0.5f, 0.6f, -0.4f)}) {
            const light_box box = box_for(sun, glm::uvec3(48));
            attenuation_options options;
            options.light = attenuation_light::extinction;
            const auto found = lit(device, values, box, options);
            ASSERT_EQ(found.size(), 48u * 48 * 48);
            const glm::dvec3 towards = glm::normalize(glm::dvec3(sun));
            double worst = 0;
            for (std::uint32_t z = 0; z < 48; z += 3) {
                for (std::uint32_t y = 0; y < 48; y += 3) {
                    for (std::uint32_t x = 0; x < 48; x += 3) {
                        const glm::dvec3 at = middle_of(box.grid, glm::dvec3(x, y, z) + 0.5);
                        const double b = glm::dot(centre - at, towards);
                        const glm::dvec3 across = centre - at - b * towards;
                        const double exact =
                            0.8 * sigma * std::sqrt(std::numbers::pi / 2) *
                            std::exp(-glm::dot(across, across) / (2 * sigma * sigma)) *
                            std::erfc(-b / (std::numbers::sqrt2 * sigma));
                        worst =
                            std::max(worst, std::abs(exact - double(found[(z * 48 + y) * 48 + x])));
                    }
                }
            }
            // Trilinear densities of step s see a Gaussian that is wider by s²/6 and less, the
            // light's voxels add h²/24: with s = 0.107 and h up to 0.2 of sigma 0.5, 1.5 % of the
            // depth of 1.003 at most.
            EXPECT_LE(worst, 0.015);
        }
    });
}

TEST_P(grid_attenuation, of_an_even_box_grows_with_depth) {
    support::with_device(GetParam(), [](auto& device) {
        const auto values = densities([](glm::dvec3) { return 0.5; });
        const light_box box = box_for({0, 1, 0}, glm::uvec3(32));
        attenuation_options options;
        options.light = attenuation_light::continuum;
        options.forward = 0.25f;
        const auto found = lit(device, values, box, options);
        ASSERT_EQ(found.size(), 32u * 32 * 32);
        for (std::uint32_t y = 0; y < 32; ++y) {
            const glm::dvec3 at = middle_of(box.grid, glm::dvec3(16, y, 16) + 0.5);
            const double depth = std::clamp(3 - at.y, 0.0, 4.0) * 0.5 * 0.8 * 0.75;
            // The voxel that holds an edge is half in, half out, to the samples in it.
            const double voxel = double(box.grid.voxel.y) * 0.5 * 0.8 * 0.75;
            EXPECT_NEAR(double(found[(16 * 32 + y) * 32 + 16]), depth, 0.5 * voxel + 1e-5) << y;
        }
        EXPECT_EQ(found[(16 * 32 + 31) * 32 + 16], 0.0f);
        EXPECT_EQ(found[16 * 32 * 32], 0.0f); // beside it
    });
}

// All of the light that is taken out, or what of it does not go on forward: 1 - a f.
TEST_P(grid_attenuation, keeps_what_its_albedo_scatters_forward) {
    support::with_device(GetParam(), [](auto& device) {
        const auto values = densities([](glm::dvec3) { return 0.5; });
        const light_box box = box_for({0, 1, 0}, glm::uvec3(16));
        attenuation_options options;
        options.forward = 0.5f;
        for (const auto& [light, kept] : {std::pair{attenuation_light::extinction, 1.0},
                                          std::pair{attenuation_light::continuum, 1 - 0.6 * 0.5}}) {
            options.light = light;
            const auto found = lit(device, values, box, options, 0.6f);
            ASSERT_EQ(found.size(), 16u * 16 * 16);
            // Below the whole box, but for the samples in which its two faces lie.
            EXPECT_NEAR(double(found[8 * 16 * 16 + 8]), 4 * 0.5 * 0.8 * kept,
                        0.25 * double(box.grid.voxel.y) * 0.5 * 0.8);
        }
    });
}

// What the backends' samplers and kernels make of any grid, with samples that lie anywhere.
TEST_P(grid_attenuation, is_that_of_the_cpu) {
    support::with_device(GetParam(), [](auto& device) {
        std::mt19937 random(41);
        std::uniform_real_distribution<double> some(0, 2);
        const auto values = densities([&](glm::dvec3) { return some(random); });
        attenuation_options options;
        options.light = attenuation_light::extinction;
        cpu::device reference;
        for (const std::uint32_t side : {18u, 41u}) {
            const light_box box = box_for({0.5f, 0.6f, -0.4f}, glm::uvec3(side));
            const auto expected = lit(reference, values, box, options);
            const auto found = lit(device, values, box, options);
            ASSERT_EQ(found.size(), expected.size());
            double worst = 0;
            for (std::size_t i = 0; i < found.size(); ++i) {
                worst = std::max(worst, std::abs(double(found[i]) - double(expected[i])));
            }
            EXPECT_LE(worst, 1e-4) << side; // asked for
            EXPECT_GT(*std::max_element(found.begin(), found.end()), 2) << side;
        }
    });
}

// Densities that alternate from voxel to voxel across the light, in voxels of the light that are
// five times as wide: the columns are even. One sample for each would be off by half of it; four in
// a row leave the fourth's share.
TEST_P(grid_attenuation, of_voxels_finer_than_the_lights_is_their_mean) {
    support::with_device(GetParam(), [](auto& device) {
        const auto values = densities(
            [](glm::dvec3 p) { return std::fmod(std::floor((p.x + 2) * 12), 2.0) < 0.5 ? 1 : 0; });
        const light_box box = box_for({0, 1, 0}, glm::uvec3(12));
        attenuation_options options;
        options.light = attenuation_light::extinction;
        const auto found = lit(device, values, box, options);
        ASSERT_EQ(found.size(), 12u * 12 * 12);
        double off = 0;
        for (std::uint32_t x = 2; x < 10; ++x) {
            const double depth = 4 * 0.8 * 0.5;
            off += std::abs(double(found[6 * 12 * 12 + x]) / depth - 1) / 8;
        }
        EXPECT_LE(off, 0.2);
    });
}

TEST_P(grid_attenuation, takes_half_floats) {
    support::with_device(GetParam(), [](auto& device) {
        // 0, ¼, ½ and 1 are whole in both formats.
        const float numbers[] = {0, 0.25f, 0.5f, 1};
        const std::uint16_t bits[] = {0, 0x3400, 0x3800, 0x3c00};
        std::mt19937 random(42);
        std::vector<float> floats;
        std::vector<std::uint16_t> halves;
        for (std::size_t i = 0; i < std::size_t{grid_size.x} * grid_size.y * grid_size.z; ++i) {
            const std::size_t k = random() % 4;
            floats.push_back(numbers[k]);
            halves.push_back(bits[k]);
        }
        const light_box box = box_for({0.5f, 0.6f, -0.4f}, glm::uvec3(20));
        const auto expected = lit(device, floats, box, {});
        const auto found = lit(device, halves, box, {});
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
            ASSERT_NEAR(found[i], expected[i], 1e-5f) << i;
        }
    });
}

INSTANTIATE_TEST_SUITE_P(backends, grid_attenuation, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& backend) { return std::string(backend.param); });

} // namespace
