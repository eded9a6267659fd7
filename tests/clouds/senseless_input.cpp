// What no cloud can be: each is refused in a sentence, or means what it says, and nothing crashes,
// hangs or makes a light of nothing.

#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/drift.hpp>
#include <skybark/clouds/harris.hpp>
#include <skybark/clouds/multiple_scattering.hpp>
#include <skybark/clouds/path_tracer.hpp>
#include <skybark/cpu/cpu.hpp>

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace {

using namespace skybark;
using namespace skybark::clouds;

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float denormal = 1e-42f;
constexpr glm::vec3 slanting{0.3f, 0.8f, 0.2f};

cloud_particle particle(glm::vec3 at, float radius, float depth = 1) {
    cloud_particle p;
    p.position = at;
    p.radius = radius;
    p.optical_depth = depth;
    return p;
}

/// Whether `made` was refused, in a sentence that has `part` in it.
template <class Result>
testing::AssertionResult refused(const Result& made, const std::string& part = "") {
    if (made) {
        return testing::AssertionFailure() << "was accepted";
    }
    const std::string& sentence = made.error().message;
    const bool good = made.error().code == error_code::bad_input && !sentence.empty() &&
                      sentence.back() == '.' && sentence.find(part) != std::string::npos;
    return (good ? testing::AssertionSuccess() : testing::AssertionFailure()) << sentence;
}

bool is_number(const light_grid& grid) {
    float sum = 0;
    for (const glm::vec4& v : {grid.anchor, grid.row_x, grid.row_y, grid.row_z, grid.voxel}) {
        sum += v.x + v.y + v.z + v.w;
    }
    return std::isfinite(sum) && grid.voxel.x > 0 && grid.voxel.y > 0 && grid.voxel.z > 0;
}

result<light_box> box_of(std::vector<cloud_particle> particles, glm::vec3 to_sun = slanting) {
    return fit_light_box(particles, to_sun, glm::uvec3(32));
}

/// The largest attenuation that the cpu finds for them.
float deepest(const std::vector<cloud_particle>& particles, glm::vec3 to_sun = slanting) {
    const glm::uvec3 voxels(33);
    cpu::device device;
    attenuation_options options;
    options.light = attenuation_light::extinction;
    auto volume = attenuation_volume<cpu::device>::create(device, voxels, options).value();
    const auto box = fit_light_box(particles, to_sun, voxels).value();
    const auto sent = make_buffer<cpu::device, cloud_particle>(device, particles).value();
    EXPECT_TRUE(run(device, [&](auto& recorder) {
        volume.relight(recorder, view<cpu::device>(sent),
                       static_cast<std::uint32_t>(particles.size()), box);
    }));
    std::vector<float> values(33u * 33 * 33);
    EXPECT_TRUE(device.download(volume.volume(), std::as_writable_bytes(std::span(values))));
    float most = 0;
    for (const float value : values) {
        EXPECT_TRUE(value >= 0 && value < infinity) << value;
        most = std::max(most, value);
    }
    return most;
}

} // namespace

// ---- Boxes of light ----------------------------------------------------------------------------

TEST(senseless_box, particles_too_small_to_have_a_square) {
    for (const float radius : {denormal, 1e-38f, 1e-30f, 9e-7f}) {
        EXPECT_TRUE(refused(box_of({particle(glm::vec3(0), radius)}), "Particle 0 has the radius"));
    }
    EXPECT_TRUE(refused(box_of({particle(glm::vec3(0), 1e-30f)}), "1e-30"));
    // 33³ voxels with a margin of one: the middle column passes within half a voxel of 30 a side.
    EXPECT_NEAR(deepest({particle(glm::vec3(0), 1e-6f, 2)}), 2, 0.05);
    EXPECT_NEAR(deepest({particle(glm::vec3(0), 1e15f, 2)}), 2, 0.05);
}

TEST(senseless_box, a_cloud_too_far_away_for_its_size) {
    EXPECT_TRUE(refused(box_of({particle({1e15f, 0, 0}, 1e-3f)}), "1e-12 of that distance"));
    EXPECT_TRUE(refused(box_of({particle({0, -1e9f, 0}, 1e-6f)}), "world's origin"));
    EXPECT_NEAR(deepest({particle({1e9f, -1e9f, 1e9f}, 1, 2)}), 2, 0.05);
    cloud_bounds far; // a thread, 32 voxels of 4e-8 m across
    far.low = {1e9f, 0, 0};
    far.high = {1e9f + 64, 1e-6f, 1e-6f};
    EXPECT_TRUE(refused(fit_light_box(far, glm::vec3(1, 0, 0), glm::uvec3(32)), "world's origin"));
    far.low.x = 0;
    far.high.x = 64;
    EXPECT_TRUE(fit_light_box(far, glm::vec3(1, 0, 0), glm::uvec3(32)));
}

TEST(senseless_box, the_sun_has_any_length_but_none) {
    const auto unit = box_of({particle(glm::vec3(0), 1)}, {0, 0.6f, 0.8f});
    ASSERT_TRUE(unit);
    for (const float length : {1e-45f, 1e-30f, 1e-7f, 1e20f, 3e38f}) {
        const auto box = box_of({particle(glm::vec3(0), 1)}, {0, 0, length});
        ASSERT_TRUE(box) << length << box.error().message;
        EXPECT_TRUE(is_number(box->grid)) << length;
        EXPECT_GT(box->grid.row_y.z, 0) << length;
    }
    for (const glm::vec3 none :
         {glm::vec3(0), glm::vec3(0, -0.0f, 0), glm::vec3(not_a_number, 1, 0),
          glm::vec3(0, infinity, 0), glm::vec3(0, 0, -infinity)}) {
        EXPECT_TRUE(refused(box_of({particle(glm::vec3(0), 1)}, none), "direction to the sun"));
    }
}

TEST(senseless_box, bounds_that_no_cloud_has) {
    const glm::vec3 one(1);
    const auto fit = [](glm::vec3 low, glm::vec3 high, float radius, float depth) {
        return fit_light_box(cloud_bounds{low, high, radius, depth}, slanting, glm::uvec3(32));
    };
    EXPECT_TRUE(fit(-one, one, 1, 100));
    EXPECT_TRUE(refused(fit(-one, one, 1.1f, 100), "largest radius of 1.1"));
    for (const float radius : {-1.0f, not_a_number, infinity, 1e30f}) {
        EXPECT_TRUE(refused(fit(-one, one, radius, 100), "largest radius"));
    }
    for (const float depth : {-1.0f, not_a_number, infinity, 1e13f}) {
        EXPECT_TRUE(refused(fit(-one, one, 0, depth), "optical depth"));
    }
    for (const float size : {0.0f, -1.0f, denormal, 1e-7f, not_a_number, infinity, 1e16f, 3e38f}) {
        EXPECT_TRUE(refused(fit(glm::vec3(0), {1, size, 1}, 0, 100), "expected sides"));
    }
    EXPECT_TRUE(refused(fit(glm::vec3(not_a_number), one, 0, 100)));
    EXPECT_TRUE(refused(fit(glm::vec3(-infinity), glm::vec3(infinity), 0, 100)));
}

TEST(senseless_box, degenerate_clouds_are_lit) {
    // A thousand of the largest depth in one place: the deepest column there may be.
    const float all = deepest(std::vector<cloud_particle>(1000, particle(glm::vec3(5), 1, 1e6f)));
    EXPECT_NEAR(all / 1e9f, 1, 0.02);
    // A hundred in line with the sun.
    std::vector<cloud_particle> line;
    for (int i = 0; i < 100; ++i) {
        line.push_back(particle({static_cast<float>(i), 0, 0}, 1e-3f));
    }
    EXPECT_NEAR(deepest(line, {1, 0, 0}), 100, 2);
    EXPECT_EQ(deepest({particle(glm::vec3(0), 1, 0)}), 0);
}

TEST(senseless_box, clouds_that_cannot_drift) {
    cpu::device device;
    using made = drifting_particles<cpu::device>;
    EXPECT_TRUE(
        refused(made::create(device, {}, {}, {{not_a_number, 0}, 8000, 3000, 4000}), "nan"));
    EXPECT_TRUE(refused(made::create(device, {}, {}, {{0, infinity}, 8000, 3000, 4000}), "inf"));
    drift_bounds good;
    good.reach = 1000;
    good.high = 500;
    good.largest_radius = 100;
    const auto fit = [](const drift_bounds& bounds) {
        return fit_light_box(bounds, slanting, glm::uvec3(32));
    };
    EXPECT_TRUE(fit(good));
    for (const float radius : {not_a_number, infinity, -1.0f, 300.0f, 1e30f}) {
        drift_bounds bad = good;
        bad.largest_radius = radius;
        EXPECT_TRUE(refused(fit(bad), "cannot be lit"));
    }
    for (const float place : {not_a_number, infinity, 1e30f}) {
        drift_bounds bad = good;
        bad.centre.x = place;
        EXPECT_TRUE(refused(fit(bad))) << place;
        bad = good;
        bad.low = -place;
        EXPECT_TRUE(refused(fit(bad))) << place;
    }
    drift_bounds thin = good;
    thin.high = denormal;
    thin.largest_radius = 0;
    EXPECT_TRUE(refused(fit(thin), "1e-6"));
}

// ---- Harris, and what is scattered more than once ----------------------------------------------

TEST(senseless_harris, options_and_counts_that_make_no_light) {
    cpu::device device;
    using made = harris_light<cpu::device>;
    for (const float sigmas : {0.0f, -3.0f, not_a_number, infinity, 9.5f}) {
        EXPECT_TRUE(refused(made::create(device, 64, 64, 10, {sigmas, 0}), "standard deviations"));
    }
    for (const float forward : {-1.0f, not_a_number, infinity, 2e6f}) {
        EXPECT_TRUE(refused(made::create(device, 64, 64, 10, {3, forward}), "straight on"));
    }
    EXPECT_TRUE(made::create(device, 64, 64, 10, {9, 1e6f}));
    EXPECT_TRUE(refused(made::create(device, 16385, 64, 10), "16385 x 64"));
}

TEST(senseless_harris, more_pixels_than_a_buffer_has) {
    cpu::device_options options;
    options.limits.max_buffer_bytes = 4 * 64 * 32; // floats
    cpu::device small(options);
    using made = harris_light<cpu::device>;
    EXPECT_TRUE(made::create(small, 64, 32, 10));
    EXPECT_TRUE(refused(made::create(small, 64, 33, 10), "64 x 33 pixels"));
    EXPECT_TRUE(refused(made::create(small, 33, 64, 10), "up to 2048 pixels"));
    EXPECT_TRUE(refused(made::create(small, 16384, 16384, 10), "16384 x 16384"));
    EXPECT_TRUE(refused(made::create(small, 8, 8, 257), "up to 256")); // of 32 bytes
}

TEST(senseless_scattering, no_more_halvings_than_there_are) {
    cpu::device device;
    using made = multiple_scattering<cpu::device>;
    multiple_scattering_options options;
    for (const auto& [side, most] : {std::pair{4u, 2u}, std::pair{8u, 3u}, std::pair{9u, 4u}}) {
        for (std::uint32_t halvings = 1; halvings <= 4; ++halvings) {
            options.halvings = halvings;
            const auto scattering = made::create(device, glm::uvec3(side), options);
            if (halvings > most) {
                EXPECT_TRUE(refused(scattering, "halvings; expected up to"));
                continue;
            }
            ASSERT_TRUE(scattering) << side << " " << halvings;
            // The longest side counts.
            EXPECT_TRUE(made::create(device, {4, side, 4}, options));
        }
    }
    options.halvings = 5;
    EXPECT_TRUE(refused(made::create(device, glm::uvec3(64), options), "5 halvings"));
    options.halvings = 0;
    EXPECT_TRUE(refused(made::create(device, glm::uvec3(64), options), "0 halvings"));
    options.halvings = 1;
    for (const float share : {0.0f, -1.0f, 1.1f, not_a_number}) {
        options.share = share;
        EXPECT_TRUE(refused(made::create(device, glm::uvec3(16), options), "share"));
    }
}

TEST(senseless_scattering, of_the_least_volume_with_all_halvings_is_solved) {
    cpu::device device;
    const glm::uvec3 voxels(4);
    const std::vector<cloud_particle> cloud{particle(glm::vec3(0), 1, 3)};
    const auto box = fit_light_box(cloud, slanting, voxels).value();
    auto sun = attenuation_volume<cpu::device>::create(device, voxels).value();
    const auto sent = make_buffer<cpu::device, cloud_particle>(device, cloud).value();
    multiple_scattering_options options;
    options.halvings = 2;
    auto light = multiple_scattering<cpu::device>::create(device, voxels, options).value();
    ASSERT_TRUE(run(device, [&](auto& recorder) {
        sun.relight(recorder, view<cpu::device>(sent), 1, box);
        light.solve(recorder, sun.volume(), box);
    }));
    ASSERT_EQ(light.size(), glm::uvec3(1));
    float fluence = not_a_number;
    ASSERT_TRUE(device.download(light.fluence(), std::as_writable_bytes(std::span(&fluence, 1))));
    EXPECT_TRUE(fluence >= 0 && fluence < 10) << fluence;
}

// ---- What the path tracer flies through --------------------------------------------------------

TEST(senseless_medium, particles_that_no_path_gets_through) {
    const auto of = [](std::vector<cloud_particle> particles, double sigmas = 3, double cut = 4) {
        return gaussian_medium::create(particles, sigmas, cut);
    };
    for (const float radius : {1e-45f, 1e-30f, 9e-7f, infinity}) {
        EXPECT_TRUE(refused(of({particle({1e7f, 0, 0}, radius)}), "Particle 0"));
    }
    // A micrometre wide 10,000 km away: of a rounding's size, and still in its cells.
    const auto far = of({particle({1e7f, -1e7f, 1e7f}, 1e-6f, 2)}, 100, 0.1);
    ASSERT_TRUE(far) << far.error().message;
    EXPECT_NE(far->cells().low, far->cells().high());
    EXPECT_TRUE(refused(of({particle(glm::vec3(0), 1000, 1), particle(glm::vec3(0), 1e-6f, 1e4f)}),
                        "1e6 is wanted"));
    EXPECT_TRUE(of({particle(glm::vec3(0), 1000, 1), particle(glm::vec3(0), 1, 100)}));
    for (const double none : {0.0, -1.0, 101.0, double{not_a_number}, double{infinity}}) {
        EXPECT_TRUE(refused(of({particle(glm::vec3(0), 1)}, none), "standard deviations"));
        EXPECT_TRUE(refused(of({particle(glm::vec3(0), 1)}, 3, none), "standard deviations"));
    }
}

TEST(senseless_medium, grids_that_no_path_gets_through) {
    const std::vector<float> dense(8, 1e9f);
    const auto of = [&](double side) {
        return voxel_medium::create(dense, {2, 2, 2}, glm::dvec3(0), glm::dvec3(side), 1);
    };
    EXPECT_TRUE(of(5e-4)); // 5e5 √3 through a cell
    EXPECT_TRUE(refused(of(1e-3), "1e6 is wanted"));
    EXPECT_TRUE(refused(of(1e6), "1e6 is wanted"));
    EXPECT_TRUE(refused(of(1e-7), "sides from 1e-6"));
    EXPECT_TRUE(refused(of(double{not_a_number}), "sides from 1e-6"));
}

TEST(senseless_paths, phase_functions_and_skies_that_are_none) {
    const auto cloud = gaussian_medium::create(std::vector{particle(glm::vec3(0), 1)}).value();
    const camera_ray ray[] = {{{0, 0, -5}, {0, 0, 1}}};
    path_options few;
    few.paths = 64;
    const auto isotropic = phase_function::isotropic();
    for (const double sky : {double{not_a_number}, double{infinity}, -1.0}) {
        EXPECT_TRUE(refused(trace_radiance(cloud, isotropic, {0, 1, 0}, ray, sky, few), "A sky"));
    }
    // The largest alpha that is taken: Draine's lobe is then that of its cosine squared.
    const auto steep = phase_function::draine(0.5, 1e300);
    EXPECT_TRUE(trace_slab(1, 1, steep, 1, few));
    // No assertion of phase_function speaks against an endless one.
    const auto endless = phase_function::draine(0.5, double{infinity});
    const auto box = fit_light_box(std::vector{particle(glm::vec3(0), 1)}, slanting, glm::uvec3(4));
    EXPECT_TRUE(refused(trace_slab(1, 1, endless, 1, few), "alpha inf"));
    EXPECT_TRUE(refused(trace_radiance(cloud, endless, {0, 1, 0}, ray, 0, few), "alpha inf"));
    EXPECT_TRUE(
        refused(trace_fluence(cloud, endless, {0, 1, 0}, box->grid, glm::uvec3(4), few), "alpha"));
}
