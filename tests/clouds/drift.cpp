// Clouds that drift: where they are, that they come back, and the same bits on every backend.
#include "support/devices.hpp"

#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/drift.hpp>

#include <cstring>
#include <numbers>

namespace {

using namespace skybark;
using namespace skybark::clouds;

constexpr drift_box square{{100, -50}, 8000, 3000, 4000};

/// Particles in groups of four around middles that lie on a lattice of 40 × 40 over the square.
struct lattice {
    std::vector<cloud_particle> particles;
    std::vector<glm::vec4> middles;
};
lattice lattice_of(const drift_box& box) {
    lattice made;
    constexpr int side = 40;
    for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side; ++i) {
            const glm::vec2 at =
                box.centre +
                box.side * (glm::vec2(float(i), float(j)) / float(side) - glm::vec2(0.4875f));
            for (int k = 0; k < 4; ++k) {
                cloud_particle p;
                p.position = {at.x + float(k * 20), 900.0f + float(7 * i), at.y - float(k * 10)};
                p.radius = 60.0f + float(k);
                p.optical_depth = 1.5f;
                p.albedo = 0.999f;
                made.particles.push_back(p);
                made.middles.emplace_back(at.x, 900, at.y, 0);
            }
        }
    }
    return made;
}

template <class B>
std::vector<cloud_particle> moved(B& device, const lattice& of, const drift_box& box,
                                  glm::dvec2 by) {
    auto made =
        drifting_particles<B>::create(device, std::span(of.particles), std::span(of.middles), box);
    std::vector<cloud_particle> found(of.particles.size());
    if (!made) {
        ADD_FAILURE() << made.error().message;
        return found;
    }
    EXPECT_TRUE(run(device, [&](auto& to) { made->record(to, by, made->capacity()); }));
    EXPECT_TRUE(
        (read_back<B, cloud_particle>(device, *made->particles().buffer, std::span(found))));
    return found;
}
std::vector<cloud_particle> moved(const lattice& of, const drift_box& box, glm::dvec2 by) {
    cpu::device device;
    return moved(device, of, box, by);
}

TEST(drift, moves_what_is_inside_and_keeps_the_rest_as_it_is) {
    const lattice at_rest = lattice_of(square);
    const glm::dvec2 by(317.25, -1208.5);
    const auto found = moved(at_rest, square, by);
    std::size_t whole = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const cloud_particle& was = at_rest.particles[i];
        const cloud_particle& is = found[i];
        EXPECT_EQ(is.position.y, was.position.y);
        EXPECT_EQ(is.radius, was.radius);
        EXPECT_EQ(is.albedo, was.albedo);
        const glm::dvec2 middle = glm::dvec2(at_rest.middles[i].x, at_rest.middles[i].z) + by;
        const double from = glm::distance(middle, glm::dvec2(square.centre));
        if (from < 2999) {
            ++whole;
            // Two roundings of numbers below 8192: 2 · 2^-11.
            EXPECT_NEAR(double(is.position.x), double(was.position.x) + by.x, 0.001);
            EXPECT_NEAR(double(is.position.z), double(was.position.z) + by.y, 0.001);
            EXPECT_EQ(is.optical_depth, was.optical_depth);
        }
        // Wherever it is, its middle is in the square, and a whole number of sides away.
        const double dx = double(is.position.x) - double(was.position.x);
        const double dz = double(is.position.z) - double(was.position.z);
        EXPECT_LE(std::abs(double(at_rest.middles[i].x) + dx - 100), 4000.01);
        EXPECT_LE(std::abs(double(at_rest.middles[i].z) + dz + 50), 4000.01);
        EXPECT_NEAR(std::remainder(dx - by.x, 8000), 0, 0.002);
        EXPECT_NEAR(std::remainder(dz - by.y, 8000), 0, 0.002);
        if (glm::distance(glm::dvec2(at_rest.middles[i].x + dx, at_rest.middles[i].z + dz),
                          glm::dvec2(square.centre)) > 4001) {
            EXPECT_EQ(is.optical_depth, 0.0f);
        }
    }
    EXPECT_GT(whole, found.size() / 3); // pi 3000² of 8000²: 0.44
}

TEST(drift, comes_back_after_a_whole_side) {
    const lattice at_rest = lattice_of(square);
    const auto once = moved(at_rest, square, {731.5, 2048});
    // A thousand sides, 21 days in a wind of 4.4 m/s: the same bits, as 731.5 + 8000 n is exact.
    const auto again = moved(at_rest, square, {731.5 + 8000.0 * 1000, 2048 - 8000.0 * 3});
    ASSERT_EQ(once.size(), again.size());
    EXPECT_EQ(std::memcmp(once.data(), again.data(), once.size() * sizeof(cloud_particle)), 0);
}

/// Nothing jumps: in a step of 1 m no particle that is to be seen moves by more, and no optical
/// depth changes by more than the steepest fade gives.
TEST(drift, is_seamless) {
    const lattice at_rest = lattice_of(square);
    auto before = moved(at_rest, square, {3990, 17});
    // d/dr of the smooth step (3 t² − 2 t³), t = (4000² − r²) / (4000² − 3000²): at most
    // 1.5 · 2 · 4000 / 7e6 a metre.
    const float steepest = 1.5f * 1.5f * 2 * 4000 / 7e6f * 1.01f;
    for (int step = 1; step <= 60; ++step) {
        const auto after = moved(at_rest, square, {3990.0 + step, 17});
        for (std::size_t i = 0; i < after.size(); ++i) {
            if (after[i].optical_depth > 0 && before[i].optical_depth > 0) {
                ASSERT_LT(glm::distance(after[i].position, before[i].position), 1.01f);
            }
            ASSERT_NEAR(after[i].optical_depth, before[i].optical_depth, steepest);
        }
        before = after;
    }
}

TEST(drift, carries_the_same_water_at_all_times) {
    const lattice at_rest = lattice_of(square);
    const auto sum = [&](double t) {
        double water = 0;
        for (const cloud_particle& p : moved(at_rest, square, {6.3 * t, -2.9 * t})) {
            water += double{p.optical_depth};
        }
        return water;
    };
    // 1,600 clouds, evenly: a disc that fades over a thousand metres, where 200 m lie between two,
    // is summed within 1 %. Its smooth step is even in the square of the distance, so the mean of
    // what is left is that of a disc half way between the two squares.
    const double left = std::numbers::pi * 0.5 * (3000.0 * 3000 + 4000.0 * 4000) / (8000.0 * 8000);
    const double first = sum(0);
    EXPECT_NEAR(first / (left * 1.5 * double(at_rest.particles.size())), 1, 0.01);
    for (const double t : {10.0, 33.0, 87.5, 400.0, 3600.0, 86400.0}) {
        EXPECT_NEAR(sum(t) / first, 1, 0.01) << "after " << t << " s";
    }
}

TEST(drift, makes_the_same_bits_on_every_backend) {
    const lattice at_rest = lattice_of(square);
    for (const glm::dvec2 by : {glm::dvec2(0), glm::dvec2(1234.567, -98765.4321)}) {
        const auto expected = moved(at_rest, square, by);
        for (const char* name : {"opengl", "vulkan"}) {
            support::with_device(name, [&](auto& device) {
                const auto found = moved(device, at_rest, square, by);
                EXPECT_EQ(std::memcmp(found.data(), expected.data(),
                                      found.size() * sizeof(cloud_particle)),
                          0)
                    << name;
            });
        }
    }
}

TEST(drift, lights_a_box_that_holds_all_of_it) {
    const lattice at_rest = lattice_of(square);
    const drift_bounds bounds = reach_of(at_rest.particles, at_rest.middles, square);
    for (const glm::vec3 to_sun :
         {glm::vec3(0, 1, 0), glm::vec3(0.6f, 0.2f, -0.77f), glm::vec3(-1, 0, 0.1f)}) {
        const auto box = fit_light_box(bounds, to_sun, glm::uvec3(32));
        ASSERT_TRUE(box);
        EXPECT_EQ(box->largest_radius, 63.0f);
        for (const double t : {0.0, 77.0, 500.0}) {
            for (const cloud_particle& p : moved(at_rest, square, {9 * t, 5 * t})) {
                if (p.optical_depth > 0) {
                    const glm::vec4 at(p.position - glm::vec3(box->grid.anchor), 1);
                    const glm::vec3 cells(glm::dot(at, box->grid.row_x),
                                          glm::dot(at, box->grid.row_y),
                                          glm::dot(at, box->grid.row_z));
                    const glm::vec3 reach = p.radius / glm::vec3(box->grid.voxel);
                    // A voxel of margin, but for rounding.
                    EXPECT_TRUE(glm::all(glm::greaterThan(cells - reach, glm::vec3(0.99f))));
                    EXPECT_TRUE(glm::all(glm::lessThan(cells + reach, glm::vec3(31.01f))));
                }
            }
        }
    }
    // A disc takes less room than the square that it lies in: √2 where the sun is in a corner.
    const auto box = fit_light_box(bounds, glm::vec3(1, 0.5f, 1), glm::uvec3(32));
    ASSERT_TRUE(box);
    EXPECT_LT(box->grid.voxel.x * 29, 2 * (4000 + 63 + 68) * 1.03f);
}

TEST(drift, refuses_what_makes_no_sense) {
    cpu::device device;
    const lattice at_rest = lattice_of(square);
    using made = drifting_particles<cpu::device>;
    const std::span<const cloud_particle> all(at_rest.particles);
    const std::span<const glm::vec4> middles(at_rest.middles);
    const auto code = [](const auto& result) {
        return result ? error_code{} : result.error().code;
    };
    EXPECT_EQ(code(made::create(device, all, middles.first(3), square)), error_code::bad_input);
    EXPECT_EQ(code(made::create(device, all, middles, {{0, 0}, 8000, 3000, 4001})),
              error_code::bad_input);
    EXPECT_EQ(code(made::create(device, all, middles, {{0, 0}, 8000, 3000, 3000})),
              error_code::bad_input);
    EXPECT_EQ(code(made::create(device, all, middles, {{0, 0}, NAN, 3000, 4000})),
              error_code::bad_input);
    EXPECT_TRUE(made::create(device, {}, {}, square));
    drift_bounds bounds = reach_of(all, middles, square);
    EXPECT_EQ(code(fit_light_box(bounds, glm::vec3(0), glm::uvec3(32))), error_code::bad_input);
    EXPECT_EQ(code(fit_light_box(bounds, glm::vec3(0, 1, 0), glm::uvec3(3))),
              error_code::bad_input);
    bounds.reach = NAN;
    EXPECT_EQ(code(fit_light_box(bounds, glm::vec3(0, 1, 0), glm::uvec3(32))),
              error_code::bad_input);
    // A wind that is no number leaves clouds where they are.
    EXPECT_EQ(drift_offset(square, {NAN, INFINITY}), glm::vec2(0));
}

} // namespace
