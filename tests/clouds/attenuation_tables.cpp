// The tables of docs/clouds.md: what profiles, cuts, rounding and one light value a particle cost.
#include "support/cloud_sums.hpp"

#include <skybark/clouds/harris.hpp>
#include <skybark/cpu/cpu.hpp>

#include <cstdio>

namespace {

using namespace skybark;
using namespace skybark::clouds;
using namespace skybark::support;

constexpr glm::vec3 slanting{0.4f, 0.7f, -0.3f};

TEST(attenuation_tables, profiles) {
    cpu::device device;
    const auto particles = blobs(11);
    std::printf("profile  volume  mean |dT|   bias of the mean T\n");
    for (const auto profile : {attenuation_profile::step, attenuation_profile::erf}) {
        for (const std::uint32_t side : {32u, 64u, 128u, 256u}) {
            const glm::uvec3 voxels(side);
            const auto box = fit_light_box(particles, slanting, voxels);
            const auto values = cold(device, particles, slanting, voxels,
                                     with(attenuation_method::impulse_scan, profile));
            ASSERT_TRUE(box && !values.empty());
            const auto errors = errors_of(values, *box, particles, slanting, 1000, 12);
            std::printf("%-7s  %3u^3   %.5f     %+.4f\n",
                        profile == attenuation_profile::erf ? "erf" : "step", side, errors.mean,
                        errors.bias);
            if (profile == attenuation_profile::step) {
                EXPECT_LT(errors.bias, -0.2); // each pays for itself in full: much too dark
            }
        }
    }
}

TEST(attenuation_tables, cuts) {
    // The paper's product: a depth of 10 in n parts, f = 0.1074. In double precision
    // (e^−10/n + f 10/n)^n.
    cpu::device device;
    std::printf("parts  product      exact        continuum\n");
    for (const int n : {1, 2, 10, 100, 1000}) {
        cloud_particle part;
        part.radius = 1;
        part.optical_depth = 10.0f / static_cast<float>(n);
        const std::vector<cloud_particle> parts(static_cast<std::size_t>(n), part);
        const glm::uvec3 voxels(32, 8, 32);
        double light[2];
        for (const int product : {0, 1}) {
            const auto values =
                cold(device, parts, slanting, voxels,
                     with(attenuation_method::impulse_scan, attenuation_profile::erf,
                          product != 0 ? attenuation_light::product : attenuation_light::continuum,
                          0.1074f));
            ASSERT_FALSE(values.empty());
            // The column that is nearest to the axis: the largest depth of the continuum.
            const auto box = fit_light_box(parts, slanting, voxels);
            const glm::vec3 axis = shared::cells_of(box->grid, glm::vec3(0));
            light[product] =
                std::exp(-double(values[index_of(voxels, static_cast<std::uint32_t>(axis.x), 0,
                                                 static_cast<std::uint32_t>(axis.z))]));
        }
        const double each = 10.0 / n;
        const double exact = std::pow(std::exp(-each) + 0.1074 * each, n);
        std::printf("%5d  %.4e   %.4e   %.4e\n", n, light[1], exact, light[0]);
        // The column's middle is up to half a voxel off the axis: 10 (1 − e^{−½ (0.14)²}) of depth.
        EXPECT_NEAR(std::log(light[1]), std::log(exact), 0.3);
        EXPECT_NEAR(std::log(light[0]), -10 * (1 - 0.1074), 0.3);
    }
}

TEST(attenuation_tables, harris) {
    // One light value a particle, read at its centre from a light buffer that has every particle
    // in front of it in full, against the product form at the same place.
    cpu::device device;
    std::printf("particles  radius  mean light (Harris)  (volume)  mean |difference|\n");
    for (const float radius : {0.06f, 0.12f, 0.24f}) {
        // Equally deep on the whole, the more particles the smaller they are.
        const auto count = static_cast<std::uint32_t>(57.6f / (radius * radius));
        const auto particles = ball(count, radius, radius, 0.3f, 14);
        const glm::uvec3 voxels(128);
        const auto box = fit_light_box(particles, slanting, voxels);
        const auto values = cold(device, particles, slanting, voxels,
                                 with(attenuation_method::impulse_scan, attenuation_profile::erf,
                                      attenuation_light::product, 1.0f / 12.566f));
        auto harris =
            harris_light<cpu::device>::create(device, 128, 128, count, {3.0f, 1.0f / 12.566f});
        auto buffer = make_buffer<cpu::device, cloud_particle>(device, std::span(particles));
        ASSERT_TRUE(box && harris && buffer && !values.empty());
        ASSERT_TRUE(harris->relight(view<cpu::device>(*buffer), count, *box));
        double mean_harris = 0;
        double mean_volume = 0;
        double difference = 0;
        for (std::size_t i = 0; i < particles.size(); ++i) {
            const glm::dvec3 cells(shared::cells_of(box->grid, particles[i].position));
            const double light = std::exp(-sampled(values, voxels, cells));
            mean_volume += light / count;
            mean_harris += double(harris->lights()[i]) / count;
            difference += std::abs(light - double(harris->lights()[i])) / count;
        }
        std::printf("%9u  %.2f    %.4f               %.4f    %.4f\n", count, double(radius),
                    mean_harris, mean_volume, difference);
        EXPECT_LT(difference, 0.1);
        EXPECT_GT(difference, 0.001);
    }
}

} // namespace
