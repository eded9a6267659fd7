// Harris's light pass: against the recurrence in double precision, and against the product form,
// with which it must agree on the axis of particles that stand in line with the sun.
#include "support/devices.hpp"

#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/harris.hpp>

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace {

using namespace skybark;
using namespace skybark::clouds;

constexpr glm::vec3 slanting{0.4f, 0.7f, -0.3f};
constexpr std::uint32_t side = 64;

light_box box_of_four_metres() {
    cloud_bounds bounds;
    bounds.low = glm::vec3(-2);
    bounds.high = glm::vec3(2);
    bounds.largest_radius = 0.3f;
    return *fit_light_box(bounds, slanting, glm::uvec3(side));
}

/// Particles one above the other towards the sun, in a shuffled order, on the middle of a column;
/// none reaches into the next one.
std::vector<cloud_particle> in_line(const light_box& box) {
    const float heights[] = {40.2f, 12.7f, 30.1f, 20.9f, 50.3f};
    std::vector<cloud_particle> particles;
    for (const float height : heights) {
        cloud_particle p;
        p.position = shared::place_of(box.grid, glm::vec3(31.5f, height, 28.5f));
        p.radius = 0.2f + 0.01f * static_cast<float>(particles.size());
        p.optical_depth = 0.4f + 0.3f * static_cast<float>(particles.size());
        p.albedo = 0.9f;
        particles.push_back(p);
    }
    return particles;
}

template <class B>
std::vector<float> harris(B& device, std::span<const cloud_particle> particles,
                          const light_box& box, float forward) {
    auto light = harris_light<B>::create(
        device, side, side, static_cast<std::uint32_t>(particles.size()), {3.0f, forward});
    auto buffer = make_buffer<B, cloud_particle>(device, particles);
    if (!light || !buffer) {
        ADD_FAILURE() << "no light buffer";
        return {};
    }
    const auto done =
        light->relight(view<B>(*buffer), static_cast<std::uint32_t>(particles.size()), box);
    if (!done) {
        ADD_FAILURE() << done.error().message;
        return {};
    }
    return {light->lights().begin(), light->lights().end()};
}

class harris_pass : public testing::TestWithParam<const char*> {};

TEST_P(harris_pass, agrees_with_the_product_on_the_axis) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const light_box box = box_of_four_metres();
        const auto particles = in_line(box);
        const float forward = 0.1074f;
        const auto lights = harris(device, particles, box, forward);
        ASSERT_EQ(lights.size(), particles.size());

        attenuation_options options;
        options.profile = attenuation_profile::step;
        options.light = attenuation_light::product;
        options.forward = forward;
        auto volume = attenuation_volume<B>::create(device, glm::uvec3(side), options);
        auto buffer = make_buffer<B, cloud_particle>(device, std::span(particles));
        ASSERT_TRUE(volume && buffer);
        ASSERT_TRUE(run(device, [&](auto& recorder) {
            volume->relight(recorder, view<B>(*buffer),
                            static_cast<std::uint32_t>(particles.size()), box);
        }));
        std::vector<float> values(std::size_t{side} * side * side);
        ASSERT_TRUE(device.download(volume->volume(), std::as_writable_bytes(std::span(values))));
        for (std::size_t i = 0; i < particles.size(); ++i) {
            // What the particles above let through, in double precision …
            double expected = 1;
            for (const cloud_particle& q : particles) {
                const double above =
                    glm::dot(glm::dvec3(q.position - particles[i].position), glm::dvec3(slanting));
                if (above > 1e-6) {
                    const double tau = double(q.optical_depth);
                    expected *= std::exp(-tau) + double(q.albedo) * tau * double(forward);
                }
            }
            EXPECT_NEAR(double(lights[i]), expected, 1e-5);
            // … and in the volume, in the voxel above the particle's top.
            const glm::vec3 cells = shared::cells_of(box.grid, particles[i].position);
            const auto y =
                static_cast<std::size_t>(cells.y + particles[i].radius / box.grid.voxel.y + 1);
            EXPECT_NEAR(std::exp(-double(values[(28 * side + y) * side + 31])), double(lights[i]),
                        1e-5);
        }
    });
}

/// The recurrence of eq. 1-4 over a light buffer, in double precision.
std::vector<double> recurrence(std::span<const cloud_particle> particles, const light_box& box,
                               double forward) {
    const auto cells = [&box](const cloud_particle& p) {
        const glm::dvec3 v = glm::dvec3(p.position) - glm::dvec3(glm::vec3(box.grid.anchor));
        return glm::dvec3(glm::dot(glm::dvec3(glm::vec3(box.grid.row_x)), v),
                          glm::dot(glm::dvec3(glm::vec3(box.grid.row_y)), v),
                          glm::dot(glm::dvec3(glm::vec3(box.grid.row_z)), v)) +
               glm::dvec3(double(box.grid.row_x.w), double(box.grid.row_y.w),
                          double(box.grid.row_z.w));
    };
    std::vector<std::size_t> order(particles.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        order[i] = i;
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return cells(particles[a]).y > cells(particles[b]).y;
    });
    std::vector<double> buffer(std::size_t{side} * side, 1.0);
    std::vector<double> lights(particles.size());
    for (const std::size_t i : order) {
        const cloud_particle& p = particles[i];
        const glm::dvec3 at = cells(p);
        const double incoming =
            buffer[static_cast<std::size_t>(at.z) * side + static_cast<std::size_t>(at.x)];
        lights[i] = incoming;
        for (std::uint32_t z = 0; z < side; ++z) {
            for (std::uint32_t x = 0; x < side; ++x) {
                const double dx = (x + 0.5 - at.x) * double(box.grid.voxel.x);
                const double dz = (z + 0.5 - at.z) * double(box.grid.voxel.z);
                const double r = double(p.radius);
                if (dx * dx + dz * dz < r * r) {
                    const double tau =
                        double(p.optical_depth) * std::exp(-4.5 * (dx * dx + dz * dz) / (r * r));
                    double& pixel = buffer[std::size_t{z} * side + x];
                    pixel = double(p.albedo) * tau * forward * incoming + std::exp(-tau) * pixel;
                }
            }
        }
    }
    return lights;
}

TEST_P(harris_pass, is_the_recurrence) {
    support::with_device(GetParam(), [](auto& device) {
        const light_box box = box_of_four_metres();
        std::mt19937 random(3);
        std::uniform_real_distribution<float> unit(-1, 1);
        std::vector<cloud_particle> particles(200);
        for (cloud_particle& p : particles) {
            p.position = glm::vec3(unit(random), unit(random), unit(random));
            p.radius = 0.2f + 0.1f * unit(random);
            p.optical_depth = 0.5f;
            p.albedo = 0.95f;
        }
        const auto lights = harris(device, particles, box, 0.1f);
        const auto expected = recurrence(particles, box, 0.1);
        ASSERT_EQ(lights.size(), expected.size());
        for (std::size_t i = 0; i < lights.size(); ++i) {
            // 200 blends in single precision, each to some 2e-7; at a particle's edge a pixel may
            // fall on either side, which is τ e^−4.5 = 0.0056 of its light: none does here.
            EXPECT_NEAR(double(lights[i]), expected[i], 2e-5) << i;
        }
        EXPECT_LT(*std::min_element(lights.begin(), lights.end()), 0.5f);
    });
}

TEST_P(harris_pass, has_no_history) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const light_box box = box_of_four_metres();
        const auto particles = in_line(box);
        auto buffer = make_buffer<B, cloud_particle>(device, std::span(particles));
        auto light = harris_light<B>::create(device, side, side, 5, {3.0f, 0.1f});
        ASSERT_TRUE(buffer && light);
        ASSERT_TRUE(light->relight(view<B>(*buffer), 5, box));
        const std::vector<float> first(light->lights().begin(), light->lights().end());
        ASSERT_TRUE(light->relight(view<B>(*buffer), 3, box)); // fewer
        ASSERT_TRUE(light->relight(view<B>(*buffer), 5, box));
        EXPECT_TRUE(std::ranges::equal(light->lights(), first));
    });
}

INSTANTIATE_TEST_SUITE_P(backends, harris_pass, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& backend) { return std::string(backend.param); });

TEST(harris_pass, refuses_a_light_buffer_without_pixels) {
    cpu::device device;
    const auto made = harris_light<cpu::device>::create(device, 0, 64, 10);
    ASSERT_FALSE(made);
    EXPECT_NE(made.error().message.find("0 x 64"), std::string::npos);
    EXPECT_FALSE(harris_light<cpu::device>::create(device, 64, 64, 0));
}

} // namespace
