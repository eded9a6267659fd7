// The attenuation volume against sums in double precision, and what must not change it: the order
// of the particles, how the cloud is cut, where it is turned, and what was lit before.
#include "support/cloud_sums.hpp"
#include "support/devices.hpp"

#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/light_at_points.hpp>

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <numeric>
#include <random>

namespace {

using namespace skybark;
using namespace skybark::clouds;

using namespace skybark::support;

constexpr glm::vec3 slanting{0.4f, 0.7f, -0.3f};

class attenuation : public testing::TestWithParam<const char*> {};

/// Every way that a device has of making the volume.
std::vector<attenuation_options> every_way(const device_limits& limits,
                                           attenuation_profile profile) {
    std::vector<attenuation_options> ways{with(attenuation_method::impulse_scan, profile)};
    for (const auto polygons : {polygon_source::list, polygon_source::stage}) {
        for (const auto policy : {padding::degenerate, padding::compact}) {
            for (const auto route : {accumulate_route::direct, accumulate_route::tiles_copied,
                                     accumulate_route::tiles_drawn, accumulate_route::layers}) {
                if ((limits.accumulate_routes & route_bit(route)) != 0) {
                    ways.push_back(with(attenuation_method::shadow_polygons, profile));
                    ways.back().polygons = polygons;
                    ways.back().policy = policy;
                    ways.back().route = route;
                    ways.back().list_bytes = 1 << 15; // two turns or more
                }
            }
        }
    }
    return ways;
}

TEST_P(attenuation, is_the_exact_sum_at_cell_centres) {
    support::with_device(GetParam(), [](auto& device) {
        const auto particles = ball(300, 0.05f, 0.2f, 1.5f, 1);
        const glm::uvec3 voxels(40, 48, 36);
        for (const auto profile : {attenuation_profile::step, attenuation_profile::erf}) {
            for (const glm::vec3 sun : {slanting, glm::vec3(0, 1, 0), glm::vec3(1, 0, 0)}) {
                const auto box = fit_light_box(particles, sun, voxels);
                ASSERT_TRUE(box);
                const auto values = cold(device, particles, sun, voxels,
                                         with(attenuation_method::impulse_scan, profile));
                ASSERT_EQ(values.size(), std::size_t{voxels.x} * voxels.y * voxels.z);
                double worst = 0;
                for (std::uint32_t z = 0; z < voxels.z; z += 3) {
                    for (std::uint32_t y = 0; y < voxels.y; ++y) {
                        for (std::uint32_t x = 0; x < voxels.x; x += 2) {
                            const glm::dvec3 at = middle_of(box->grid, glm::dvec3(x, y, z) + 0.5);
                            double tau = 0;
                            bool edge = false;
                            for (const cloud_particle& p : particles) {
                                const exact_depth one =
                                    depth_of(p, at, glm::normalize(glm::dvec3(sun)), profile);
                                tau += one.tau;
                                edge = edge || one.on_edge;
                            }
                            if (!edge) {
                                const double off =
                                    std::abs(double(values[index_of(voxels, x, y, z)]) - tau);
                                worst = std::max(worst, off / std::max(1.0, tau));
                            }
                        }
                    }
                }
                // The promise: 1e-5 · max(1, τ).
                EXPECT_LE(worst, 1e-5) << (profile == attenuation_profile::erf ? "erf" : "step");
            }
        }
    });
}

TEST_P(attenuation, methods_agree) {
    support::with_device(GetParam(), [](auto& device) {
        const auto particles = ball(200, 0.05f, 0.2f, 1.5f, 2);
        const glm::uvec3 voxels(24, 32, 20);
        for (const auto profile : {attenuation_profile::step, attenuation_profile::erf}) {
            const auto ways = every_way(device.limits(), profile);
            const auto expected = cold(device, particles, slanting, voxels, ways[0]);
            for (std::size_t w = 1; w < ways.size(); ++w) {
                const auto values = cold(device, particles, slanting, voxels, ways[w]);
                ASSERT_EQ(values.size(), expected.size());
                double worst = 0;
                for (std::size_t i = 0; i < values.size(); ++i) {
                    worst = std::max(worst, std::abs(double(values[i]) - double(expected[i])));
                }
                // Whole quanta telescope to the same sums, so nothing but a compiler that rounds
                // an exponential differently in another program could part them.
                EXPECT_LE(worst, 1e-6) << "way " << w;
            }
        }
    });
}

TEST_P(attenuation, does_not_depend_on_the_order_of_particles) {
    support::with_device(GetParam(), [](auto& device) {
        auto particles = ball(150, 0.05f, 0.2f, 1.5f, 3);
        const glm::uvec3 voxels(16, 20, 16);
        const auto ways = every_way(device.limits(), attenuation_profile::erf);
        std::mt19937 random(5);
        for (const attenuation_options& way : ways) {
            const auto expected = cold(device, particles, slanting, voxels, way);
            const auto box = fit_light_box(particles, slanting, voxels);
            auto volume = attenuation_volume<std::remove_reference_t<decltype(device)>>::create(
                device, voxels, way);
            ASSERT_TRUE(volume && box);
            for (int order = 0; order < 100; ++order) {
                std::shuffle(particles.begin(), particles.end(), random);
                const auto values = lit(device, *volume, particles, *box);
                ASSERT_TRUE(values);
                ASSERT_EQ(*values, expected) << "order " << order;
            }
        }
    });
}

TEST_P(attenuation, has_no_history) {
    support::with_device(GetParam(), [](auto& device) {
        const auto particles = ball(150, 0.05f, 0.2f, 1.5f, 4);
        const glm::uvec3 voxels(20, 20, 20);
        for (const auto method :
             {attenuation_method::impulse_scan, attenuation_method::shadow_polygons}) {
            const attenuation_options way = with(method, attenuation_profile::erf);
            auto volume = attenuation_volume<std::remove_reference_t<decltype(device)>>::create(
                device, voxels, way);
            ASSERT_TRUE(volume);
            for (int degrees = 0; degrees < 360; degrees += 20) {
                const double angle = degrees * std::numbers::pi / 180;
                const glm::vec3 sun(std::cos(angle), std::sin(angle), 0);
                const auto box = fit_light_box(particles, sun, voxels);
                ASSERT_TRUE(box);
                const auto values = lit(device, *volume, particles, *box);
                ASSERT_TRUE(values);
                EXPECT_EQ(*values, cold(device, particles, sun, voxels, way)) << degrees;
            }
        }
    });
}

/// The largest difference that it makes to a blob's light when it is cut into n parts.
template <class B>
double cut_changes(B& device, cloud_particle blob, std::size_t n) {
    const glm::uvec3 voxels(24, 24, 24);
    const attenuation_options way = with(attenuation_method::impulse_scan, attenuation_profile::erf,
                                         attenuation_light::continuum, 0.7225f);
    const auto one = cold(device, std::span(&blob, 1), slanting, voxels, way);
    EXPECT_LE(fit_light_box(std::span(&blob, 1), slanting, voxels)->grid.voxel.w, 3e-7f);
    blob.optical_depth /= static_cast<float>(n);
    const std::vector<cloud_particle> parts(n, blob);
    const auto cut = cold(device, parts, slanting, voxels, way);
    EXPECT_EQ(cut.size(), one.size());
    double worst = 0;
    for (std::size_t i = 0; i < std::min(cut.size(), one.size()); ++i) {
        worst = std::max(worst, std::abs(double(cut[i]) - double(one[i])));
    }
    EXPECT_GT(*std::max_element(one.begin(), one.end()), 0.27f * 7.9f);
    return worst;
}

TEST_P(attenuation, continuum_does_not_depend_on_how_a_blob_is_cut) {
    support::with_device(GetParam(), [](auto& device) {
        cloud_particle blob;
        blob.radius = 1;
        blob.albedo = 1;
        // Powers of two divide floats exactly: nothing but a quantum's rounding for each part.
        blob.optical_depth = 8;
        for (std::size_t n = 1; n <= 512; n *= 2) {
            EXPECT_LE(cut_changes(device, blob, n), double(n) * 3e-7) << n << " parts";
        }
        // Others are rounded as floats, too, the whole and the parts each by itself: the parts'
        // depth by 2^-24 of it, three products (the profile's two, and what is kept of the light)
        // by as much, and the division by the quantum by 5 · 2^-24, as Vulkan allows. 17 · 2^-24
        // of what is taken out, at most 10 (1 − 0.7225).
        blob.optical_depth = 10;
        for (const std::size_t n : {3u, 10u, 100u, 1000u}) {
            EXPECT_LE(cut_changes(device, blob, n), double(n) * 3e-7 + 17 * 0x1p-24 * 2.775)
                << n << " parts";
        }
    });
}

TEST_P(attenuation, a_particle_cuts_np_slices_and_the_rest_is_degenerate) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const auto particles = ball(64, 0.05f, 0.3f, 0.1f, 6);
        const glm::uvec3 voxels(32, 32, 32);
        const auto box = fit_light_box(particles, slanting, voxels);
        ASSERT_TRUE(box);
        const kernels::shadow_slab slabs{
            attenuation_volume<B>::shade_of(attenuation_options{}, *box)};
        const std::uint32_t most = slabs.slabs();
        const std::size_t corners = particles.size() * most * 6;
        auto in = make_buffer<B, cloud_particle>(device, particles);
        auto out = device.create_buffer(corners * sizeof(kernels::shadow_corner));
        auto count = device.create_buffer(sizeof(count_record));
        ASSERT_TRUE(in && out && count);
        for (const padding policy : {padding::degenerate, padding::compact}) {
            ASSERT_TRUE(run(device, [&](auto& recorder) {
                recorder.expand(slabs, {view<B>(*in)}, range{0, 64},
                                {view<B>(*out), view<B>(*count), policy});
            }));
            std::vector<kernels::shadow_corner> list(corners);
            count_record length;
            ASSERT_TRUE((read_back<B, kernels::shadow_corner>(device, *out, list)));
            ASSERT_TRUE((read_back<B, count_record>(device, *count, std::span(&length, 1))));
            std::size_t expected_total = 0;
            std::size_t at = 0;
            for (const cloud_particle& p : particles) {
                // Layers whose middle lies in the particle, from the definition of the grid.
                const glm::dvec3 axis = glm::dvec3(glm::vec3(box->grid.row_z));
                const double centre = glm::dot(axis, glm::dvec3(p.position) -
                                                         glm::dvec3(glm::vec3(box->grid.anchor))) +
                                      double(box->grid.row_z.w);
                const double reach = double(p.radius) / double(box->grid.voxel.z);
                std::size_t expected = 0;
                for (std::uint32_t z = 0; z < voxels.z; ++z) {
                    expected += std::abs(z + 0.5 - centre) < reach ? 1 : 0;
                }
                expected_total += expected;
                if (policy == padding::degenerate) {
                    std::size_t present = 0;
                    for (std::uint32_t s = 0; s < most; ++s, at += 6) {
                        const bool spare = std::all_of(
                            list.begin() + static_cast<std::ptrdiff_t>(at),
                            list.begin() + static_cast<std::ptrdiff_t>(at + 6), [](const auto& c) {
                                return c.x == 0 && c.y == 0 && c.slice == 0 && c.particle == 0;
                            });
                        present += spare ? 0 : 1;
                    }
                    EXPECT_EQ(present, expected);
                }
            }
            EXPECT_EQ(length.written, policy == padding::degenerate ? 2 * most * particles.size()
                                                                    : 2 * expected_total);
        }
    });
}

/// The value of an IEEE 754 binary16.
double half_value(std::uint16_t half) {
    const int exponent = half >> 10 & 31;
    const double fraction = half & 1023;
    const double size =
        exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
    return (half & 0x8000) != 0 ? -size : size;
}

/// A volume of half floats.
template <class B>
std::vector<std::uint16_t> halves_of(B& device, std::span<const cloud_particle> particles,
                                     glm::uvec3 voxels, attenuation_options way) {
    way.format = volume_format::float16;
    const auto box = fit_light_box(particles, slanting, voxels);
    auto volume = attenuation_volume<B>::create(device, voxels, way);
    auto buffer = make_buffer<B, cloud_particle>(device, particles);
    std::vector<std::uint16_t> halves(std::size_t{voxels.x} * voxels.y * voxels.z);
    if (!box || !volume || !buffer ||
        !run(device,
             [&](auto& recorder) {
                 volume->relight(recorder, view<B>(*buffer),
                                 static_cast<std::uint32_t>(particles.size()), *box);
             }) ||
        !device.download(volume->volume(), std::as_writable_bytes(std::span(halves)))) {
        ADD_FAILURE();
        return {};
    }
    return halves;
}

TEST_P(attenuation, half_floats_err_as_stated) {
    support::with_device(GetParam(), [](auto& device) {
        const auto particles = ball(300, 0.05f, 0.2f, 1.5f, 7);
        const glm::uvec3 voxels(24, 24, 24);
        for (const auto& [light, forward] : {std::pair{attenuation_light::extinction, 0.0f},
                                             std::pair{attenuation_light::product, 6.5f}}) {
            const auto way =
                with(attenuation_method::impulse_scan, attenuation_profile::erf, light, forward);
            const auto whole = cold(device, particles, slanting, voxels, way);
            const auto halves = halves_of(device, particles, voxels, way);
            ASSERT_EQ(halves.size(), whole.size());
            double worst = 0;
            double least = 0;
            double most = 0;
            for (std::size_t i = 0; i < halves.size(); ++i) {
                const double exact = double(whole[i]);
                const double value = half_value(halves[i]);
                // 10 bits follow the first: half of the last is 2^-11 of a power of two, and less
                // of what lies above. From 2^-14 down the last stays 2^-24.
                ASSERT_LE(std::abs(value - exact), 0x1p-11 * std::abs(exact) + 0x1p-25);
                if (exact >= 0) {
                    worst = std::max(worst, std::abs(std::exp(-value) - std::exp(-exact)));
                }
                least = std::min(least, value);
                most = std::max(most, value);
            }
            // 2^-11 A e^-A, the largest at A = 1.
            EXPECT_LE(worst, 0.00018);
            if (light == attenuation_light::product) {
                EXPECT_LT(least, -3); // it amplifies
            } else {
                EXPECT_GT(worst, 0.00005);
                EXPECT_GT(most, 3);
            }
        }
    });
}

/// Where the water lies: at particles picked at random, spread as their Gaussians are.
std::vector<glm::vec4> places_in(std::span<const cloud_particle> particles, std::size_t count,
                                 unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<std::size_t> pick(0, particles.size() - 1);
    std::normal_distribution<float> normal;
    std::vector<glm::vec4> places(count);
    for (glm::vec4& place : places) {
        const cloud_particle& p = particles[pick(random)];
        const glm::vec3 off(normal(random), normal(random), normal(random));
        place = glm::vec4(p.position + off * (p.radius / 3), 0);
    }
    return places;
}

// As a caller asks for it, and at a level sun.
TEST_P(attenuation, light_at_places_is_the_exact_transmittance) {
    support::with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const glm::vec3 level(0.8f, 0, -0.6f);
        const glm::uvec3 voxels(128);
        const auto particles = blobs(18);
        const auto places = places_in(particles, 2000, 19);
        const auto count = static_cast<std::uint32_t>(places.size());
        const auto box = fit_light_box(particles, level, voxels);
        auto sun = attenuation_volume<B>::create(
            device, voxels, with(attenuation_method::impulse_scan, attenuation_profile::erf));
        auto buffer = make_buffer<B, cloud_particle>(device, particles);
        auto at = make_buffer<B, glm::vec4>(device, places);
        auto found = device.create_buffer(places.size() * sizeof(glm::vec4));
        ASSERT_TRUE(box && sun && buffer && at && found);
        result<void> looked;
        ASSERT_TRUE(run(device, [&](auto& recorder) {
            sun->relight(recorder, view<B>(*buffer), static_cast<std::uint32_t>(particles.size()),
                         *box);
            looked = record_light_at(recorder, device.limits(), *sun, nullptr, view<B>(*at), count,
                                     view<B>(*found));
        }));
        ASSERT_TRUE(looked);
        std::vector<glm::vec4> lights(places.size());
        ASSERT_TRUE((read_back<B, glm::vec4>(device, *found, std::span(lights))));
        double off = 0;
        double exact_sum = 0;
        double sum = 0;
        double depth = 0;
        for (std::size_t i = 0; i < places.size(); ++i) {
            double tau = 0;
            for (const cloud_particle& p : particles) {
                tau += depth_of(p, glm::dvec3(glm::vec3(places[i])),
                                glm::normalize(glm::dvec3(level)), attenuation_profile::erf)
                           .tau;
            }
            const double light = double(lights[i].y);
            ASSERT_NEAR(light, std::exp(-double(lights[i].x)), 1e-6); // its exponential: 2e-7
            off += std::abs(light - std::exp(-tau));
            exact_sum += std::exp(-tau);
            sum += light;
            depth += tau;
        }
        EXPECT_NEAR(depth / count, 7, 1.5);
        EXPECT_LE(off / count, 0.002);
        EXPECT_LE(std::abs(sum / exact_sum - 1), 0.01);
        std::printf("128^3: mean |dT| %.6f, bias %.4f, mean depth %.2f\n", off / count,
                    sum / exact_sum - 1, depth / count);
    });
}

INSTANTIATE_TEST_SUITE_P(backends, attenuation, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& backend) { return std::string(backend.param); });

TEST(attenuation_accuracy, trilinear_transmittance) {
    cpu::device device;
    const auto particles = blobs(11);
    const struct {
        std::uint32_t side;
        double mean;
    } wanted[] = {{128, 0.002}, {256, 0.0005}};
    for (const auto& [side, mean] : wanted) {
        const glm::uvec3 voxels(side);
        const auto values = cold(device, particles, slanting, voxels,
                                 with(attenuation_method::impulse_scan, attenuation_profile::erf));
        const auto box = fit_light_box(particles, slanting, voxels);
        ASSERT_TRUE(box && !values.empty());
        const auto errors = errors_of(values, *box, particles, slanting, 2000, 12);
        EXPECT_NEAR(errors.depth, 7, 1.5);
        EXPECT_LE(errors.mean, mean) << side;
        EXPECT_LE(std::abs(errors.bias), 0.01) << side;
        std::printf("%u^3: mean |dT| %.6f, bias %.4f, mean depth %.2f, mean T %.4f\n", side,
                    errors.mean, errors.bias, errors.depth, errors.light);
    }
}

// ---- A cloud as large as they are meant for -----------------------------------------------------

/// Evenly in a ball of diameter 1 that they fill: 60,134, their radius 3 % of it, 7 deep on the
/// mean.
std::vector<cloud_particle> whole_cloud() {
    constexpr float radius = 0.03f;
    constexpr float reach = 0.5f - radius;
    // A particle's depth over the plane comes to 2 π σ², the ball's disk to π reach².
    constexpr float depth = 7 * reach * reach * 9 / (2 * radius * radius * 60134);
    auto particles = ball(60134, radius, radius, depth, 16);
    for (cloud_particle& p : particles) {
        p.position *= reach;
    }
    return particles;
}

// On which side of an edge a voxel's middle lies is rounded, too. Half an ulp of a coordinate, in
// voxels, is at most u = side · 2^-24, and of the way from the anchor, in the middle, half of that.
// A particle's coordinate is rounded as the difference to the anchor and as products (u/2 each), in
// two sums (u/2 each) and in the last one (u): 3 u. The rows are floats: their lengths are off by
// 2^-24 (u/2), and the right angle to each of the others by 2 · 2^-24 (u each): 2.5 u. The y axis
// leans by 2^-24 over a shadow as long as the box: u. That is 6.5 u, √2 of it along x and z
// together, and along y two more sums for a particle's top: below 10 u at worst, 2e-5 of a radius
// of 3 % of the box, and 1.3 u as the root of the squares' sum. 1e-5 of the radius, which depth_of
// leaves out, are 5 u, nearly four times that, and one voxel in a hundred has an edge so near: none
// is decided wrongly among thousands.
void expect_exact_sums(std::uint32_t side, int places) {
    cpu::device device;
    const auto particles = whole_cloud();
    const glm::uvec3 voxels(side);
    const auto box = fit_light_box(particles, slanting, voxels);
    ASSERT_TRUE(box);
    const glm::dvec3 sun = glm::normalize(glm::dvec3(slanting));
    for (const auto profile : {attenuation_profile::step, attenuation_profile::erf}) {
        const auto values = cold(device, particles, slanting, voxels,
                                 with(attenuation_method::impulse_scan, profile));
        ASSERT_FALSE(values.empty());
        std::mt19937 random(17);
        std::uniform_int_distribution<std::uint32_t> any(0, side - 1);
        int compared = 0;
        double worst = 0;
        double deepest = 0;
        for (int k = 0; k < places;) {
            const glm::uvec3 cell(any(random), any(random), any(random));
            const glm::dvec3 at = middle_of(box->grid, glm::dvec3(cell) + 0.5);
            if (glm::dot(at, at) > 0.25) {
                continue; // not in the cloud
            }
            ++k;
            double tau = 0;
            bool edge = false;
            for (const cloud_particle& p : particles) {
                const exact_depth one = depth_of(p, at, sun, profile);
                tau += one.tau;
                edge = edge || one.on_edge;
            }
            if (!edge) {
                ++compared;
                const double found = double(values[index_of(voxels, cell.x, cell.y, cell.z)]);
                worst = std::max(worst, std::abs(found - tau) / std::max(1.0, tau));
                deepest = std::max(deepest, tau);
            }
        }
        EXPECT_LE(worst, 1e-5); // the promise, of max(1, τ)
        EXPECT_GT(compared, places * 95 / 100);
        EXPECT_GT(deepest, 7);
        std::printf("%s, %u^3: %d of %d, off by up to %.2e of max(1, depth), depths up to %.1f\n",
                    profile == attenuation_profile::erf ? "erf" : "step", side, compared, places,
                    worst, deepest);
    }
}

TEST(attenuation_accuracy, of_sixty_thousand_particles) { expect_exact_sums(256, 300); }

TEST(attenuation_accuracy, of_sixty_thousand_particles_in_384_slow) {
    expect_exact_sums(384, 3000);
}

/// Mean T at places that turn with the cloud, for one rotation of both.
double turned_light(cpu::device& device, std::span<const cloud_particle> still,
                    const std::array<glm::dvec3, 3>& axes, std::uint32_t side) {
    const auto turn = [&axes](glm::vec3 v) {
        return glm::vec3(axes[0] * double(v.x) + axes[1] * double(v.y) + axes[2] * double(v.z));
    };
    std::vector<cloud_particle> particles(still.begin(), still.end());
    for (cloud_particle& p : particles) {
        p.position = turn(p.position);
    }
    const glm::vec3 sun(axes[1]);
    const glm::uvec3 voxels(side);
    const auto values = cold(device, particles, sun, voxels,
                             with(attenuation_method::impulse_scan, attenuation_profile::erf));
    const auto box = fit_light_box(particles, sun, voxels);
    if (!box || values.empty()) {
        return -1;
    }
    double sum = 0;
    for (const cloud_particle& p : particles) {
        glm::dvec3 cells;
        const glm::vec4 rows[] = {box->grid.row_x, box->grid.row_y, box->grid.row_z};
        for (int a = 0; a < 3; ++a) {
            cells[a] = glm::dot(glm::dvec3(glm::vec3(rows[a])),
                                glm::dvec3(p.position) - glm::dvec3(glm::vec3(box->grid.anchor))) +
                       double(rows[a].w);
        }
        sum += std::exp(-sampled(values, voxels, cells));
    }
    return sum / static_cast<double>(particles.size());
}

void expect_no_change_by_turning(int directions, std::uint32_t side) {
    cpu::device device;
    const auto particles = blobs(13);
    double least = 1;
    double most = 0;
    for (int k = 0; k < directions; ++k) {
        // A Fibonacci sphere, its first six replaced by the axes themselves.
        const double up = 1 - 2 * (k + 0.5) / directions;
        const double turn = k * 2.399963229728653;
        const double level = std::sqrt(1 - up * up);
        glm::dvec3 sun(level * std::cos(turn), up, level * std::sin(turn));
        if (k < 6) {
            sun = glm::dvec3(0);
            sun[k % 3] = k < 3 ? 1 : -1;
        }
        const glm::dvec3 other = std::abs(sun.x) > 0.5 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
        const glm::dvec3 side_axis = glm::normalize(glm::cross(other, sun));
        const double light =
            turned_light(device, particles, {side_axis, sun, glm::cross(side_axis, sun)}, side);
        least = std::min(least, light);
        most = std::max(most, light);
    }
    EXPECT_LE(most - least, 0.005);
    EXPECT_GT(least, 0.01);
    std::printf("%d directions at %u^3: mean T from %.6f to %.6f\n", directions, side, least, most);
}

TEST(attenuation_accuracy, turning_sun_and_cloud_changes_nothing) {
    expect_no_change_by_turning(24, 96);
}

TEST(attenuation_accuracy, turning_through_a_thousand_directions_slow) {
    expect_no_change_by_turning(1000, 256);
}

TEST(attenuation_accuracy, backends_agree) {
    cpu::device reference;
    const auto particles = ball(300, 0.05f, 0.2f, 1.5f, 8);
    const glm::uvec3 voxels(32, 40, 24);
    for (const auto light : {attenuation_light::extinction, attenuation_light::continuum,
                             attenuation_light::product}) {
        const auto way = with(attenuation_method::impulse_scan, attenuation_profile::erf, light,
                              light == attenuation_light::product ? 6.5f : 0.72f);
        const auto expected = cold(reference, particles, slanting, voxels, way);
        for (const char* name : {"opengl", "vulkan"}) {
            support::with_device(name, [&](auto& device) {
                const auto values = cold(device, particles, slanting, voxels, way);
                ASSERT_EQ(values.size(), expected.size());
                double worst = 0;
                for (std::size_t i = 0; i < values.size(); ++i) {
                    worst = std::max(worst, std::abs(double(values[i]) - double(expected[i])));
                }
                EXPECT_LE(worst, 1e-4) << name; // asked for
            });
        }
    }
}

TEST(attenuation_accuracy, volumes_larger_than_a_binding) {
    // 384³ floats are 216 MiB; lavapipe binds 128 MiB of a buffer at most.
    cpu::device reference;
    const auto particles = ball(300, 0.05f, 0.2f, 1.5f, 15);
    const glm::uvec3 voxels(384);
    const auto way = with(attenuation_method::impulse_scan, attenuation_profile::step);
    const auto expected = cold(reference, particles, slanting, voxels, way);
    support::with_device("vulkan", [&](auto& device) {
        const auto values = cold(device, particles, slanting, voxels, way);
        ASSERT_EQ(values.size(), expected.size());
        double worst = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            worst = std::max(worst, std::abs(double(values[i]) - double(expected[i])));
        }
        EXPECT_LE(worst, 1e-4);
        const std::uint64_t most = device.limits().max_buffer_bytes;
        if (most >= values.size() * sizeof(float)) {
            GTEST_SKIP() << "Right, but of no more than this device can bind: " << (most >> 20)
                         << " MiB";
        }
    });
}

TEST(attenuation_accuracy, product_is_the_papers) {
    // One particle: G on its axis is e^−τ + a τ f, amplifying where f is sharp (a thick
    // particle can amplify light).
    cpu::device device;
    cloud_particle p;
    p.radius = 1;
    p.albedo = 0.8f;
    for (const float tau : {0.01f, 0.5f, 2.0f, 10.0f}) {
        for (const float f : {0.0f, 0.1074f, 6.5f}) {
            p.optical_depth = tau;
            const glm::uvec3 voxels(35, 16, 35);
            const auto values =
                cold(device, std::span(&p, 1), slanting, voxels,
                     with(attenuation_method::impulse_scan, attenuation_profile::step,
                          attenuation_light::product, f));
            ASSERT_FALSE(values.empty());
            const auto box = fit_light_box(std::span(&p, 1), slanting, voxels);
            // The column nearest to the axis.
            double nearest = 1e9;
            double expected = 0;
            float found = 0;
            for (std::uint32_t z = 0; z < 35; ++z) {
                for (std::uint32_t x = 0; x < 35; ++x) {
                    const glm::dvec3 at = middle_of(box->grid, {x + 0.5, 0.5, z + 0.5});
                    const exact_depth one = depth_of(p, at, glm::normalize(glm::dvec3(slanting)),
                                                     attenuation_profile::step);
                    const double off = std::abs(one.tau - double(tau));
                    if (off < nearest) {
                        nearest = off;
                        expected = -std::log(std::exp(-one.tau) + 0.8 * one.tau * double(f));
                        found = values[index_of(voxels, x, 0, z)];
                    }
                }
            }
            EXPECT_NEAR(double(found), expected, 1e-5 * std::max(1.0, std::abs(expected)))
                << tau << " " << f;
        }
    }
}

TEST(light_box, is_snapped_to_the_world) {
    auto particles = ball(200, 0.05f, 0.2f, 1.5f, 9);
    const auto before = fit_light_box(particles, slanting, glm::uvec3(32));
    ASSERT_TRUE(before);
    for (cloud_particle& p : particles) {
        p.position += glm::vec3(0.013f, 0.021f, -0.008f);
    }
    const auto after = fit_light_box(particles, slanting, glm::uvec3(32));
    ASSERT_TRUE(after);
    EXPECT_EQ(before->grid.voxel, after->grid.voxel);
    // A place's voxel coordinates differ by whole numbers.
    const glm::vec3 place(0.3f, -0.2f, 0.1f);
    const glm::vec3 moved =
        shared::cells_of(after->grid, place) - shared::cells_of(before->grid, place);
    for (int a = 0; a < 3; ++a) {
        EXPECT_NEAR(moved[a], std::round(moved[a]), 2e-5f);
    }
}

TEST(light_box, keeps_a_margin_of_a_voxel) {
    for (unsigned seed = 0; seed < 40; ++seed) {
        std::mt19937 random(seed);
        std::normal_distribution<float> normal;
        const glm::vec3 sun(normal(random), normal(random), normal(random));
        const auto particles = ball(5, 0.05f, 0.5f, 0.1f, seed);
        const auto box = fit_light_box(particles, sun, glm::uvec3(16, 9, 4));
        ASSERT_TRUE(box);
        for (const cloud_particle& p : particles) {
            const glm::vec3 at = shared::cells_of(box->grid, p.position);
            for (int a = 0; a < 3; ++a) {
                const float reach = p.radius / box->grid.voxel[a];
                EXPECT_GE(at[a] - reach, 0.999f);
                EXPECT_LE(at[a] + reach, static_cast<float>(box->voxels[a]) - 0.999f);
            }
        }
    }
}

TEST(light_box, deep_clouds_get_a_coarser_quantum) {
    std::vector<cloud_particle> particles(1000);
    for (cloud_particle& p : particles) {
        p.radius = 1;
        p.optical_depth = 100;
    }
    const auto box = fit_light_box(particles, slanting, glm::uvec3(16));
    ASSERT_TRUE(box);
    EXPECT_GE(double(box->grid.voxel.w) * 2147483647.0, 1e5);
    cpu::device device;
    const auto values = cold(device, particles, slanting, glm::uvec3(17),
                             with(attenuation_method::impulse_scan, attenuation_profile::step));
    EXPECT_GT(*std::max_element(values.begin(), values.end()), 9e4f);
    EXPECT_GE(*std::min_element(values.begin(), values.end()), 0.0f);
}

TEST(light_box, refuses_what_makes_no_sense) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    const auto good = ball(3, 0.1f, 0.2f, 0.1f, 10);
    const auto message = [&](auto&& spoil, glm::vec3 sun = slanting,
                             glm::uvec3 voxels = glm::uvec3(16)) {
        auto particles = good;
        spoil(particles);
        const auto box = fit_light_box(particles, sun, voxels);
        return box ? std::string("accepted") : box.error().message;
    };
    const auto as_is = [](auto&) {};
    EXPECT_EQ(message(as_is), "accepted");
    EXPECT_EQ(message([](auto& p) { p.clear(); }),
              "The cloud has no particles; expected one at least.");
    EXPECT_EQ(message([&](auto& p) { p[1].radius = nan; }),
              "Particle 1 has the radius nan; expected a number of metres from 1e-6 to 1e15.");
    EXPECT_NE(message([&](auto& p) { p[2].radius = -1; }).find("Particle 2"), std::string::npos);
    EXPECT_NE(message([&](auto& p) { p[2].radius = 0; }).find("radius"), std::string::npos);
    EXPECT_NE(message([&](auto& p) { p[0].optical_depth = -0.1f; }).find("optical depth"),
              std::string::npos);
    EXPECT_NE(message([&](auto& p) { p[0].optical_depth = infinity; }).find("optical depth"),
              std::string::npos);
    EXPECT_NE(message([&](auto& p) { p[0].albedo = 1.5f; }).find("albedo"), std::string::npos);
    EXPECT_NE(message([&](auto& p) { p[0].position.z = infinity; }).find("coordinate"),
              std::string::npos);
    EXPECT_NE(message(as_is, glm::vec3(0)).find("direction to the sun"), std::string::npos);
    EXPECT_NE(message(as_is, glm::vec3(nan, 1, 0)).find("direction to the sun"), std::string::npos);
    EXPECT_NE(message(as_is, slanting, glm::uvec3(16, 3, 16)).find("16 x 3 x 16"),
              std::string::npos);
    cpu::device device;
    const auto huge =
        attenuation_volume<cpu::device>::create(device, glm::uvec3(1000), attenuation_options{});
    ASSERT_FALSE(huge);
    EXPECT_NE(huge.error().message.find("1000 x 1000 x 1000 voxels takes 7629 MiB"),
              std::string::npos)
        << huge.error().message;
}

} // namespace
