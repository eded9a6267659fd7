// What the light of a cloud may be asked for: sums that hold whatever is asked, and a sentence
// where something cannot be.
#include "support/cloud_sums.hpp"
#include "support/devices.hpp"

#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/multiple_scattering.hpp>

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace {

using namespace skybark;
using namespace skybark::clouds;
using namespace skybark::support;

constexpr glm::vec3 slanting{0.4f, 0.7f, -0.3f};
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

template <class T>
testing::AssertionResult refused(const result<T>& made, const std::string& part) {
    if (made) {
        return testing::AssertionFailure() << "it was taken";
    }
    const std::string& sentence = made.error().message;
    const bool good = made.error().code == error_code::bad_input && sentence.back() == '.' &&
                      sentence.find(part) != std::string::npos;
    return (good ? testing::AssertionSuccess() : testing::AssertionFailure()) << sentence;
}

/// Each way of summing that every device has.
std::vector<attenuation_options> ways(attenuation_light light, float forward) {
    std::vector<attenuation_options> found;
    for (const auto profile : {attenuation_profile::erf, attenuation_profile::step}) {
        found.push_back(with(attenuation_method::impulse_scan, profile, light, forward));
        for (const auto polygons : {polygon_source::list, polygon_source::stage}) {
            found.push_back(with(attenuation_method::shadow_polygons, profile, light, forward));
            found.back().polygons = polygons;
        }
    }
    return found;
}

class light_options : public testing::TestWithParam<const char*> {};

// 2,000 thin particles along the light, in droplets' forward peak: each amplifies by ln 6, all of
// them by 3,600, for which quanta that fit Σ τ = 20 overflow seven times.
TEST_P(light_options, the_products_sums_do_not_overflow) {
    with_device(GetParam(), [](auto& device) {
        const glm::dvec3 towards = glm::normalize(glm::dvec3(slanting));
        std::vector<cloud_particle> particles(2000);
        for (std::size_t i = 0; i < particles.size(); ++i) {
            particles[i].position = glm::vec3(towards * (0.01 * double(i)));
            particles[i].radius = 4;
            particles[i].optical_depth = 0.01f;
            particles[i].albedo = 1 - 1e-4f * static_cast<float>(i);
        }
        const glm::uvec3 voxels(12, 24, 12);
        const auto box = fit_light_box(particles, slanting, voxels);
        ASSERT_TRUE(box);
        const float forward = 500;
        for (const attenuation_options& way : ways(attenuation_light::product, forward)) {
            const auto values = cold(device, particles, slanting, voxels, way);
            ASSERT_EQ(values.size(), 12u * 24 * 12);
            double least = 0;
            for (std::uint32_t y = 0; y < voxels.y; ++y) {
                const glm::dvec3 at = middle_of(box->grid, glm::dvec3(5.5, y + 0.5, 5.5));
                double sum = 0;
                for (const cloud_particle& p : particles) {
                    // −ln G of the whole particle, times what of it lies above.
                    const auto whole = depth_of(p, at - towards * 100.0, towards, way.profile);
                    const auto above = depth_of(p, at, towards, way.profile);
                    const double on = double{p.albedo} * double{forward} * whole.tau;
                    sum += whole.tau > 0
                               ? -std::log(std::exp(-whole.tau) + on) * above.tau / whole.tau
                               : 0;
                }
                least = std::min(least, sum);
                // Quanta of 2^-17 for 10,000 = 20 · 500, half of one for each of 2,000 particles;
                // sums in float, 2^-24 of themselves; and 1e-5 of −ln G as everywhere.
                EXPECT_NEAR(double(values[index_of(voxels, 5, y, 5)]), sum,
                            0.5 * 2000 * 0x1p-17 + 2e-5 * std::abs(sum))
                    << "row " << y;
            }
            EXPECT_LT(least, -2000);
        }
    });
}

// A particle that fills the volume has a rectangle in each of its layers, of 96 bytes; views of the
// particles that are left start where views may.
TEST_P(light_options, a_list_holds_a_step_of_the_largest_particles) {
    with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        std::vector<cloud_particle> particles(40);
        for (std::size_t i = 0; i < particles.size(); ++i) {
            particles[i].position = glm::vec3(0.001f * static_cast<float>(i), 0, 0);
            particles[i].radius = 10;
            particles[i].optical_depth = 0.1f;
        }
        const glm::uvec3 voxels(16, 8, 40);
        const std::uint64_t step = std::max<std::uint64_t>(1, device.limits().view_alignment / 32);
        const std::uint64_t least = std::uint64_t{96} * (40 + 2) * step;
        attenuation_options way =
            with(attenuation_method::shadow_polygons, attenuation_profile::erf);
        for (const std::uint64_t less : {std::uint64_t{0}, std::uint64_t{95}, least - 1}) {
            way.list_bytes = less;
            EXPECT_TRUE(refused(attenuation_volume<B>::create(device, voxels, way),
                                "it takes " + std::to_string(least) + " at least"));
        }
        const auto expected =
            cold(device, particles, slanting, voxels,
                 with(attenuation_method::impulse_scan, attenuation_profile::erf));
        for (const std::uint64_t enough : {least, least + 95, 2 * least - 1}) {
            way.list_bytes = enough;
            EXPECT_EQ(cold(device, particles, slanting, voxels, way), expected) << enough;
        }
        way.list_bytes = 0; // is not asked for
        way.polygons = polygon_source::stage;
        EXPECT_EQ(cold(device, particles, slanting, voxels, way), expected);
    });
}

TEST_P(light_options, of_a_grid_are_checked_before_it_is_lit) {
    with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const glm::uvec3 voxels(8);
        attenuation_options options;
        options.most_bytes = 8 * 512;
        auto volume = attenuation_volume<B>::create(device, voxels, options);
        ASSERT_TRUE(volume) << volume.error().message;
        EXPECT_TRUE(refused(volume->prepare_for_grids(device), "8 x 8 x 8 voxels takes"));
        options.most_bytes = 12 * 512;
        options.light = attenuation_light::product;
        volume = attenuation_volume<B>::create(device, voxels, options);
        ASSERT_TRUE(volume);
        EXPECT_TRUE(refused(volume->prepare_for_grids(device), "no particles to multiply"));
        ASSERT_TRUE(volume->set_light(attenuation_light::continuum, 0.5f));
        EXPECT_TRUE(volume->prepare_for_grids(device));
        EXPECT_TRUE(volume->prepare_for_grids(device));
        EXPECT_TRUE(refused(volume->set_light(attenuation_light::product, 0.5f), "density grid"));
        EXPECT_EQ(volume->options().light, attenuation_light::continuum);
        EXPECT_TRUE(volume->set_light(attenuation_light::extinction, 0));
    });
}

TEST(light_option, what_goes_on_forward_leaves_something_to_scatter) {
    cpu::device device;
    using made = attenuation_volume<cpu::device>;
    auto volume = made::create(device, glm::uvec3(8)).value();
    const auto both = [&](attenuation_light light, float forward) {
        attenuation_options options;
        options.light = light;
        options.forward = forward;
        const auto fresh = made::create(device, glm::uvec3(8), options);
        const auto set = volume.set_light(light, forward);
        EXPECT_EQ(fresh.has_value(), set.has_value());
        EXPECT_EQ(volume.options().forward == forward && volume.options().light == light,
                  set.has_value());
        return set;
    };
    EXPECT_TRUE(both(attenuation_light::continuum, std::nextafter(1.0f, 0.0f)));
    EXPECT_TRUE(refused(both(attenuation_light::continuum, 1), "forward part of 1;"));
    EXPECT_TRUE(refused(both(attenuation_light::continuum, 2), "below 1 for the continuum"));
    EXPECT_TRUE(both(attenuation_light::product, 1e6f));
    EXPECT_TRUE(both(attenuation_light::extinction, 2));
    for (const auto light : {attenuation_light::extinction, attenuation_light::continuum,
                             attenuation_light::product}) {
        EXPECT_TRUE(refused(both(light, not_a_number), "forward part of nan"));
        EXPECT_TRUE(refused(both(light, -0.1f), "forward part of -0.1"));
        EXPECT_TRUE(refused(both(light, infinity), "forward part of inf"));
    }
}

TEST(light_option, density_boxes_that_hold_no_cloud) {
    const density_box good{{-1, 0, -1}, {1, 3, 1}, 0.5f, 0.9f};
    EXPECT_TRUE(check_density_box(good));
    EXPECT_TRUE(check_density_box(density_box{}));
    const auto with_one = [&](auto change) {
        density_box where = good;
        change(where);
        const auto checked = check_density_box(where);
        const auto box = fit_light_box(where, slanting, glm::uvec3(16));
        EXPECT_EQ(checked.has_value(), box.has_value());
        return checked;
    };
    EXPECT_TRUE(refused(with_one([](density_box& w) { w.low.y = 3; }), "2 x 0 x 2"));
    EXPECT_TRUE(refused(with_one([](density_box& w) { w.high.z = -2; }), "expected sides"));
    for (const float none : {not_a_number, infinity, -1.0f}) {
        EXPECT_TRUE(refused(with_one([&](density_box& w) { w.high.x = w.low.x + none; }), "sides"));
        EXPECT_TRUE(refused(with_one([&](density_box& w) { w.extinction = none; }), "extinction"));
        EXPECT_TRUE(refused(with_one([&](density_box& w) { w.albedo = none; }), "albedo"));
    }
    EXPECT_TRUE(refused(with_one([](density_box& w) { w.albedo = 1.01f; }), "albedo 1.01"));
    EXPECT_TRUE(with_one([](density_box& w) { w.extinction = 0; }));
}

// All corners of the grid lie in its box, with a voxel to spare.
TEST(light_option, a_density_box_is_fitted_edge_to_edge) {
    const density_box where{{-1, 0, -1}, {1, 3, 1}, 0.5f, 0.9f};
    const auto box = fit_light_box(where, slanting, glm::uvec3(16, 20, 24));
    ASSERT_TRUE(box);
    EXPECT_EQ(box->largest_radius, 0);
    for (int c = 0; c < 8; ++c) {
        const glm::vec3 corner((c & 1) != 0 ? 1 : -1, (c & 2) != 0 ? 3 : 0, (c & 4) != 0 ? 1 : -1);
        const glm::vec3 cells = shared::cells_of(box->grid, corner);
        EXPECT_TRUE(glm::all(glm::greaterThanEqual(cells, glm::vec3(0.999f)))) << c;
        EXPECT_TRUE(glm::all(glm::lessThanEqual(cells, glm::vec3(15.001f, 19.001f, 23.001f)))) << c;
    }
}

TEST(light_option, layers_of_a_particle_end_with_those_of_the_volume) {
    light_box box = fit_light_box(density_box{}, slanting, glm::uvec3(16, 20, 24)).value();
    using made = attenuation_volume<cpu::device>;
    EXPECT_EQ(made::shade_of({}, box).slices, 2u);
    box.largest_radius = 5 * box.grid.voxel.z;
    EXPECT_EQ(made::shade_of({}, box).slices, 12u);
    for (const float radius : {30 * box.grid.voxel.z, 1e30f, infinity}) {
        box.largest_radius = radius;
        EXPECT_EQ(made::shade_of({}, box).slices, 26u);
    }
}

// What a simulation may leave behind where nobody checks: no light is made of it, on any device.
TEST_P(light_options, particles_that_make_no_sense_make_no_light) {
    with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        cloud_bounds bounds;
        bounds.low = glm::vec3(-1);
        bounds.high = glm::vec3(1);
        bounds.largest_radius = 1;
        const glm::uvec3 voxels(15);
        const auto box = fit_light_box(bounds, {0, 1, 0}, voxels);
        ASSERT_TRUE(box);
        struct senseless {
            float depth;
            float albedo;
            double least; // −ln of the light behind nine of them
            double most;
        };
        // The middle column passes the axis half a voxel of 0.171 aside both ways: it meets
        // e^(−4.5 · 2 · 0.0855²) = 0.936 of the depth. Of one that 100 in all does not foresee, 16
        // are left: 2^26 quanta of 2^-22.
        const senseless cases[] = {{not_a_number, 1, 0, 0},  {-3, 1, 0, 0},
                                   {-infinity, 1, 0, 0},     {infinity, 1, 16, 144},
                                   {3e38f, 1, 16, 144},      {1e6f, 0, 16, 144},
                                   {0.1f, 1e30f, 0.84, 0.9}, {0.1f, infinity, 0.84, 0.9},
                                   {0.1f, -5, 0.84, 0.9},    {0.1f, not_a_number, 0.84, 0.9}};
        for (const auto light : {attenuation_light::extinction, attenuation_light::continuum,
                                 attenuation_light::product}) {
            const bool product = light == attenuation_light::product;
            for (const attenuation_options& way : ways(light, product ? 5 : 0.5f)) {
                auto volume = attenuation_volume<B>::create(device, voxels, way);
                ASSERT_TRUE(volume);
                for (const senseless& c : cases) {
                    cloud_particle p;
                    p.radius = 1;
                    p.optical_depth = c.depth;
                    p.albedo = c.albedo;
                    const std::vector<cloud_particle> particles(9, p);
                    const auto values = lit(device, *volume, particles, *box);
                    ASSERT_TRUE(values);
                    // The product amplifies, but no more than nine white particles that make sense.
                    const double least = product ? -9 * std::log(1 + 5e6) : 0;
                    for (const float value : *values) {
                        ASSERT_TRUE(value >= least && double{value} <= c.most * 1.000001)
                            << value << " of depth " << c.depth << ", albedo " << c.albedo;
                    }
                    const bool thinned =
                        light == attenuation_light::continuum && !(c.depth > 1) && c.albedo > 0;
                    EXPECT_GE(double{(*values)[index_of(voxels, 7, 0, 7)]},
                              product ? least : (thinned ? 0.5 : 1.0) * c.least)
                        << "depth " << c.depth << ", albedo " << c.albedo;
                }
            }
        }
    });
}

// Of extinction and of the continuum the same fluence is made, whatever share the options name.
TEST_P(light_options, scattering_takes_its_share_from_the_volume) {
    with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const auto particles = ball(200, 0.2f, 0.4f, 0.5f, 7);
        const auto phase = phase_function::henyey_greenstein(0.8);
        const glm::uvec3 voxels(16, 20, 18);
        const auto box = fit_light_box(particles, slanting, voxels);
        ASSERT_TRUE(box);
        multiple_scattering_options options;
        options.medium = medium_of(phase, mean_albedo(particles));
        // Adding_doubling and paths have the levels; here: of one volume and another.
        const auto fluence = [&](attenuation_light light, float share, bool from_volume) {
            auto sun = attenuation_volume<B>::create(device, voxels, light_of(phase, light));
            options.share = share;
            auto diffuse = multiple_scattering<B>::create(device, voxels, options);
            EXPECT_TRUE(sun && diffuse && lit(device, *sun, particles, *box));
            EXPECT_TRUE(diffuse->fits(sun->options()));
            EXPECT_TRUE(run(device, [&](auto& recorder) {
                if (from_volume) {
                    diffuse->solve(recorder, *sun);
                } else {
                    diffuse->solve(recorder, sun->volume(), *box);
                }
            }));
            const glm::uvec3 size = diffuse->size();
            std::vector<float> values(std::size_t{size.x} * size.y * size.z);
            EXPECT_TRUE(
                device.download(diffuse->fluence(), std::as_writable_bytes(std::span(values))));
            return values;
        };
        const float share = share_of(options.medium);
        const auto extinction = fluence(attenuation_light::extinction, 0.3f, true);
        EXPECT_EQ(extinction, fluence(attenuation_light::extinction, 1, false));
        const auto continuum = fluence(attenuation_light::continuum, 1, true);
        EXPECT_EQ(continuum, fluence(attenuation_light::continuum, share, false));
        // Particles' albedos differ by a tenth from their mean, and so the continuum's depths.
        double off = 0;
        double sum = 0;
        for (std::size_t i = 0; i < continuum.size(); ++i) {
            off += std::abs(double{continuum[i]} - double{extinction[i]});
            sum += double{extinction[i]};
        }
        EXPECT_LT(off / sum, 0.05);
        EXPECT_GT(sum / static_cast<double>(extinction.size()), 0.05);
    });
}

TEST(light_option, is_that_of_the_droplets) {
    const auto phase = phase_function::henyey_greenstein(0.8);
    // Henyey and Greenstein: the second moment is g², P(0) = (1 + g) / (4π (1 − g)²).
    EXPECT_EQ(light_of(phase).light, attenuation_light::continuum);
    EXPECT_FLOAT_EQ(light_of(phase).forward, 0.64f);
    const attenuation_options product = light_of(phase, attenuation_light::product);
    EXPECT_EQ(product.light, attenuation_light::product);
    EXPECT_FLOAT_EQ(product.forward, static_cast<float>(1.8 / (4 * std::numbers::pi * 0.04)));
    EXPECT_EQ(light_of(phase, attenuation_light::extinction).light, attenuation_light::extinction);
    EXPECT_EQ(light_of(phase, attenuation_light::extinction).forward, 0);
    const scattering_medium medium = medium_of(phase, 0.9f);
    EXPECT_EQ(medium.albedo, 0.9f);
    EXPECT_FLOAT_EQ(medium.mean_cosine, 0.8f);
    EXPECT_FLOAT_EQ(medium.forward, 0.64f);
    EXPECT_FLOAT_EQ(share_of(medium), 1 - 0.9f * 0.64f);

    std::vector<cloud_particle> particles(3);
    EXPECT_EQ(mean_albedo({}), 1);
    for (cloud_particle& p : particles) {
        p.optical_depth = 0;
        p.albedo = 0.5f;
    }
    EXPECT_EQ(mean_albedo(particles), 1);
    particles[1].optical_depth = 3;
    particles[2].optical_depth = 1;
    particles[2].albedo = 0.9f;
    EXPECT_FLOAT_EQ(mean_albedo(particles), (3 * 0.5f + 0.9f) / 4);
}

// The product tells no depth; a continuum without a forward part is not the medium's.
TEST(light_option, of_another_medium_does_not_fit) {
    cpu::device device;
    const auto phase = phase_function::henyey_greenstein(0.8);
    multiple_scattering_options options;
    options.medium = medium_of(phase, 1);
    const auto diffuse =
        multiple_scattering<cpu::device>::create(device, glm::uvec3(8), options).value();
    EXPECT_TRUE(diffuse.fits(light_of(phase)));
    EXPECT_TRUE(diffuse.fits(light_of(phase, attenuation_light::extinction)));
    EXPECT_FALSE(diffuse.fits(light_of(phase, attenuation_light::product)));
    EXPECT_FALSE(diffuse.fits(light_of(phase_function::henyey_greenstein(0.79))));
    EXPECT_FALSE(diffuse.fits(attenuation_options{}));
}

// Every kernel that is recorded is asked for: a backend that has but some fails at the concept.
static_assert(relights_volumes<cpu::device> && scatters_light<cpu::device>);
static_assert(!relights_volumes<int> && !scatters_light<int>);

INSTANTIATE_TEST_SUITE_P(backends, light_options, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& of) { return std::string(of.param); });

} // namespace
