// Multiple scattering in wide, flat clouds, whose voxels are many times as wide as high: after its
// few cycles it has to be where many cycles end.

#include "support/devices.hpp"

#include <skybark/clouds/cumulus.hpp>
#include <skybark/clouds/multiple_scattering.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace {

using namespace skybark;
using namespace skybark::clouds;

struct lit_field {
    std::vector<float> fluence;
    light_box box;
};

/// The fluence in a field of cumulus that is ten times as wide as high. `shaped`: the voxels' shape
/// is told.
template <class B>
lit_field lit(B& device, glm::vec3 to_sun, glm::uvec3 voxels, bool shaped, std::uint32_t cycles) {
    cumulus_field_options field;
    field.clouds = 12;
    field.extent = 6000;
    field.particles_per_cloud = 150;
    const std::vector<cloud_particle> cloud = cumulus_field(field);
    const auto phase = phase_function::henyey_greenstein(0.85);
    lit_field made{{}, fit_light_box(cloud, to_sun, voxels).value()};
    multiple_scattering_options options;
    options.medium = medium_of(phase, 1);
    options.cycles = cycles;
    if (shaped) {
        options.voxel = glm::vec3(made.box.grid.voxel);
    }
    auto sun = attenuation_volume<B>::create(device, voxels, light_of(phase)).value();
    auto diffuse = multiple_scattering<B>::create(device, voxels, options).value();
    const auto particles = make_buffer<B, cloud_particle>(device, std::span(cloud)).value();
    EXPECT_TRUE(run(device, [&](auto& to) {
        sun.relight(to, view<B>(particles), static_cast<std::uint32_t>(cloud.size()), made.box);
        diffuse.solve(to, sun);
    }));
    const glm::uvec3 size = diffuse.size();
    made.fluence.resize(std::size_t{size.x} * size.y * size.z);
    EXPECT_TRUE(
        device.download(diffuse.fluence(), std::as_writable_bytes(std::span(made.fluence))));
    return made;
}

/// The mean difference over the mean.
double difference(const std::vector<float>& found, const std::vector<float>& expected) {
    double off = 0;
    double all = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        off += std::abs(double{found[i]} - double{expected[i]});
        all += double{expected[i]};
    }
    return off / all;
}

/// Where the iteration ends does not depend on which grids it goes through. 1 % is what three
/// cycles leave between cubes.
TEST(flat_voxels, need_no_more_cycles_than_cubes) {
    cpu::device device;
    for (const glm::vec3 to_sun : {glm::vec3(0, 1, 0), glm::vec3(1, 0, 0)}) {
        const glm::uvec3 voxels(72, 64, 80);
        const auto exact = lit(device, to_sun, voxels, true, 40);
        const float thick = std::min(exact.box.grid.voxel.y, exact.box.grid.voxel.z);
        ASSERT_GT(exact.box.grid.voxel.x, 4 * thick);
        EXPECT_LT(difference(lit(device, to_sun, voxels, true, 3).fluence, exact.fluence), 0.01);
        EXPECT_LT(difference(lit(device, to_sun, voxels, false, 64).fluence, exact.fluence), 0.01);
        // What the shape is good for.
        EXPECT_GT(difference(lit(device, to_sun, voxels, false, 3).fluence, exact.fluence), 0.03);
    }
}

class flat_voxels_on : public testing::TestWithParam<const char*> {};

TEST_P(flat_voxels_on, gives_the_fluence_of_the_cpu) {
    cpu::device cpu;
    const glm::uvec3 voxels(33, 29, 40);
    const auto expected = lit(cpu, {0, 1, 0}, voxels, true, 3).fluence;
    support::with_device(GetParam(), [&](auto& device) {
        const auto found = lit(device, {0, 1, 0}, voxels, true, 3).fluence;
        const float most = *std::max_element(expected.begin(), expected.end());
        ASSERT_GT(most, 0.5f);
        // Quotients may be rounded differently (2.5 ulp) in the steps of 3 cycles and those on the
        // way up, less than 60 on the finest grid, with weights of up to 3.12.
        for (std::size_t i = 0; i < found.size(); ++i) {
            ASSERT_NEAR(found[i], expected[i], 60 * 2.5 * 0x1p-23 * 3.12 * double{most}) << i;
        }
    });
}

INSTANTIATE_TEST_SUITE_P(backends, flat_voxels_on, testing::Values("cpu", "opengl", "vulkan"));

TEST(flat_voxels, have_sides) {
    cpu::device device;
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    for (const float side : {0.0f, -1.0f, nan, std::numeric_limits<float>::infinity()}) {
        multiple_scattering_options options;
        options.voxel.y = side;
        const auto made = multiple_scattering<cpu::device>::create(device, glm::uvec3(16), options);
        ASSERT_FALSE(made);
        EXPECT_NE(made.error().message.find("sides from 1e-9 to 1e9"), std::string::npos);
    }
    // However long: it ends, and takes no more than twice the memory.
    multiple_scattering_options options;
    const auto cubes = multiple_scattering<cpu::device>::create(device, glm::uvec3(32), options);
    options.voxel = {1e9f, 1e-9f, 1};
    const auto needles = multiple_scattering<cpu::device>::create(device, glm::uvec3(32), options);
    ASSERT_TRUE(cubes && needles);
    EXPECT_LT(needles->bytes(), 2 * cubes->bytes());
}

} // namespace
