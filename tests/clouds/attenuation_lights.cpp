// Each kind of light by its own formula in double precision, whatever the albedos, however wide the
// Gaussians, in one call or many; and what a frame before it may have left.
#include "support/cloud_sums.hpp"
#include "support/devices.hpp"

#include <skybark/clouds/attenuation_volume.hpp>

namespace {

using namespace skybark;
using namespace skybark::clouds;
using namespace skybark::support;

constexpr glm::vec3 slanting{0.4f, 0.7f, -0.3f};

class attenuation_lights : public testing::TestWithParam<const char*> {};

/// 0.5 … 1: none of it is what another one is.
std::vector<cloud_particle> of_many_albedos(std::size_t count, unsigned seed) {
    auto particles = ball(count, 0.05f, 0.3f, 1.5f, seed);
    for (std::size_t i = 0; i < count; ++i) {
        particles[i].albedo = 0.5f + 0.5f * static_cast<float>(i % 11) / 10;
    }
    return particles;
}

/// −ln of what a particle leaves, of the depth that a line through it meets; the rest is the
/// profile's.
double taken(const cloud_particle& p, double tau, attenuation_light light, double forward) {
    const double on = double(p.albedo) * forward;
    return light == attenuation_light::extinction  ? tau
           : light == attenuation_light::continuum ? tau * (1 - on)
                                                   : -std::log(std::exp(-tau) + on * tau);
}

/// The largest error over max(1, |exact|) at every `step`-th voxel's middle.
double worst_of(const std::vector<float>& values, const light_box& box,
                std::span<const cloud_particle> particles, const attenuation_options& way,
                std::uint32_t step = 2) {
    double worst = 0;
    for (std::uint32_t z = 0; z < box.voxels.z; z += step) {
        for (std::uint32_t y = 0; y < box.voxels.y; y += step) {
            for (std::uint32_t x = 0; x < box.voxels.x; x += step) {
                const glm::dvec3 at = middle_of(box.grid, glm::dvec3(x, y, z) + 0.5);
                const glm::dvec3 sun = glm::normalize(glm::dvec3(slanting));
                double sum = 0;
                bool edge = false;
                for (const cloud_particle& p : particles) {
                    const double sigmas = double(way.sigmas);
                    const exact_depth whole =
                        depth_of(p, at, sun, attenuation_profile::step, sigmas);
                    const exact_depth part = depth_of(p, at, sun, way.profile, sigmas);
                    edge = edge || whole.on_edge || part.on_edge;
                    if (whole.tau > 0) {
                        sum += taken(p, whole.tau, way.light, double(way.forward)) * part.tau /
                               whole.tau;
                    }
                }
                if (!edge) {
                    const double off =
                        std::abs(double(values[index_of(box.voxels, x, y, z)]) - sum);
                    worst = std::max(worst, off / std::max(1.0, std::abs(sum)));
                }
            }
        }
    }
    return worst;
}

// One volume for all of them: the light is what was last set. 0.1074 dims and 6.5 amplifies.
TEST_P(attenuation_lights, are_the_exact_sums_of_their_formulas) {
    with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const auto particles = of_many_albedos(120, 21);
        const glm::uvec3 voxels(20, 24, 18);
        const auto box = fit_light_box(particles, slanting, voxels);
        ASSERT_TRUE(box);
        for (const auto method :
             {attenuation_method::impulse_scan, attenuation_method::shadow_polygons}) {
            for (const float sigmas : {3.0f, 2.0f}) {
                attenuation_options way = with(method, attenuation_profile::erf);
                way.sigmas = sigmas;
                auto volume = attenuation_volume<B>::create(device, voxels, way);
                ASSERT_TRUE(volume);
                for (const auto& [light, forward] : {std::pair{attenuation_light::extinction, 0.7f},
                                                     std::pair{attenuation_light::continuum, 0.7f},
                                                     std::pair{attenuation_light::continuum, 0.25f},
                                                     std::pair{attenuation_light::product, 0.1074f},
                                                     std::pair{attenuation_light::product, 6.5f}}) {
                    ASSERT_TRUE(volume->set_light(light, forward));
                    way.light = light;
                    way.forward = forward;
                    const auto values = lit(device, *volume, particles, *box);
                    ASSERT_TRUE(values);
                    EXPECT_LE(worst_of(*values, *box, particles, way), 1e-5)
                        << "light " << static_cast<int>(light) << ", forward " << forward
                        << ", sigmas " << sigmas << ", method " << static_cast<int>(method);
                }
            }
        }
    });
}

// Rectangles that do not fit into their list go through it in turns.
TEST_P(attenuation_lights, lists_in_many_turns_change_no_bit) {
    with_device(GetParam(), [](auto& device) {
        const auto particles = of_many_albedos(300, 22);
        const glm::uvec3 voxels(20, 24, 18);
        attenuation_options way =
            with(attenuation_method::shadow_polygons, attenuation_profile::erf);
        for (const padding policy : {padding::degenerate, padding::compact}) {
            way.policy = policy;
            way.list_bytes = std::uint64_t{1} << 24;
            const auto at_once = cold(device, particles, slanting, voxels, way);
            way.list_bytes = std::uint64_t{1} << 14;
            const auto in_turns = cold(device, particles, slanting, voxels, way);
            ASSERT_FALSE(at_once.empty());
            EXPECT_EQ(in_turns, at_once);
        }
        // At least 4 layers, of two triangles of three corners, for each: 115 KiB.
        const auto box = fit_light_box(particles, slanting, voxels);
        EXPECT_GE(2 * box->largest_radius / box->grid.voxel.z, 3);
    });
}

/// The same volume once more, in the box of before, for none of the particles that a buffer holds.
template <class B>
std::vector<float> lit_by_none(B& device, attenuation_volume<B>& volume,
                               std::span<const cloud_particle> particles) {
    const light_box box = volume.box();
    auto buffer = make_buffer<B, cloud_particle>(device, particles);
    std::vector<float> values(std::size_t{box.voxels.x} * box.voxels.y * box.voxels.z, -1);
    if (!buffer ||
        !run(device, [&](auto& recorder) { volume.relight(recorder, view<B>(*buffer), 0, box); }) ||
        !device.download(volume.volume(), std::as_writable_bytes(std::span(values)))) {
        ADD_FAILURE();
    }
    return values;
}

/// impulse_scan, and shadow_polygons from lists in turns, padded and compact, and from the stage.
std::vector<attenuation_options> methods() {
    std::vector<attenuation_options> ways{
        with(attenuation_method::impulse_scan, attenuation_profile::erf)};
    for (const polygon_source polygons : {polygon_source::list, polygon_source::stage}) {
        for (const padding policy : {padding::degenerate, padding::compact}) {
            ways.push_back(with(attenuation_method::shadow_polygons, attenuation_profile::erf));
            ways.back().polygons = polygons;
            ways.back().policy = policy;
            ways.back().list_bytes = std::uint64_t{1} << 14;
        }
    }
    return ways;
}

// More, fewer, others, none, under another sun, by any method: as a volume that is new.
TEST_P(attenuation_lights, particles_come_and_go_without_a_trace) {
    with_device(GetParam(), [](auto& device) {
        using B = std::remove_reference_t<decltype(device)>;
        const auto particles = of_many_albedos(200, 23);
        const std::span<const cloud_particle> all(particles);
        const glm::uvec3 voxels(16, 20, 16);
        for (const attenuation_options& way : methods()) {
            auto volume = attenuation_volume<B>::create(device, voxels, way);
            ASSERT_TRUE(volume);
            float turn = 0;
            for (const auto part :
                 {all, all.first(1), all.subspan(50, 120), all.last(3), all.first(199)}) {
                const glm::vec3 sun(std::cos(turn), 0.3f, std::sin(turn));
                turn += 1;
                const auto box = fit_light_box(part, sun, voxels);
                ASSERT_TRUE(box);
                const auto values = lit(device, *volume, part, *box);
                ASSERT_TRUE(values);
                EXPECT_EQ(*values, cold(device, part, sun, voxels, way)) << part.size();
                EXPECT_GT(*std::max_element(values->begin(), values->end()), 0.1f);
                EXPECT_EQ(lit_by_none(device, *volume, part), std::vector<float>(values->size()))
                    << "none after " << part.size();
            }
        }
    });
}

INSTANTIATE_TEST_SUITE_P(backends, attenuation_lights, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& backend) { return std::string(backend.param); });

// Every number of parts from 1 to 1000: a quantum's rounding for each. A part's depth is rounded by
// 2^-24 of it as a float, and whole and parts each by three products (the profile's two, and what
// is kept of the light; the quantum, a power of two, divides exactly): 7 · 2^-24 of what is taken
// out, at most 10 (1 − 0.9 · 0.7225).
TEST(attenuation_cuts, into_any_number_change_nothing) {
    cpu::device device;
    cloud_particle whole;
    whole.radius = 1;
    whole.optical_depth = 10;
    whole.albedo = 0.9f;
    const glm::uvec3 voxels(9);
    const attenuation_options way = with(attenuation_method::impulse_scan, attenuation_profile::erf,
                                         attenuation_light::continuum, 0.7225f);
    const auto one = cold(device, std::span(&whole, 1), slanting, voxels, way);
    for (std::size_t n = 1; n <= 1000; ++n) {
        // Powers of two divide floats exactly.
        const double slack = (n & (n - 1)) == 0 ? 0 : 7 * 0x1p-24 * 10 * (1 - 0.9 * 0.7225);
        cloud_particle part = whole;
        part.optical_depth = whole.optical_depth / static_cast<float>(n);
        const std::vector<cloud_particle> parts(n, part);
        const auto cut = cold(device, parts, slanting, voxels, way);
        ASSERT_EQ(cut.size(), one.size());
        for (std::size_t i = 0; i < cut.size(); ++i) {
            ASSERT_NEAR(double(cut[i]), double(one[i]), double(n) * 3e-7 + slack) << n << " parts";
        }
    }
}

// ---- The box ------------------------------------------------------------------------------------

/// How far a cloud reaches along an axis of a box, m.
double extent_along(std::span<const cloud_particle> particles, const light_grid& grid, int axis) {
    const glm::vec4 rows[] = {grid.row_x, grid.row_y, grid.row_z};
    const glm::dvec3 along = glm::normalize(glm::dvec3(glm::vec3(rows[axis])));
    double low = 1e30;
    double high = -1e30;
    for (const cloud_particle& p : particles) {
        low = std::min(low, glm::dot(along, glm::dvec3(p.position)) - double(p.radius));
        high = std::max(high, glm::dot(along, glm::dvec3(p.position)) + double(p.radius));
    }
    return high - low;
}

TEST(light_boxes, have_sides_in_steps_of_a_thirty_second_of_an_octave) {
    for (unsigned seed = 0; seed < 40; ++seed) {
        const auto particles = ball(30, 0.05f, 0.4f, 1, seed);
        const glm::vec3 sun(std::cos(float(seed)), 0.2f, std::sin(float(seed)));
        const glm::uvec3 voxels(32, 20, 57);
        const auto box = fit_light_box(particles, sun, voxels);
        ASSERT_TRUE(box);
        for (int a = 0; a < 3; ++a) {
            const double side = double(box->grid.voxel[a]);
            const double steps = std::log2(side) * 32;
            EXPECT_NEAR(steps, std::round(steps), 1e-4);
            // As large as they have to be: within a voxel at each end, and one for the snapping.
            const double least = extent_along(particles, box->grid, a) / (double(voxels[a]) - 3);
            EXPECT_GE(side, least * (1 - 1e-6));
            EXPECT_LE(side, least * std::exp2(1.0 / 32) * (1 + 1e-6));
        }
    }
}

TEST(light_boxes, of_bounds_hold_all_corners_and_no_more_than_they_must) {
    cloud_bounds bounds;
    bounds.low = glm::vec3(-3, 10, 2);
    bounds.high = glm::vec3(4, 11, 7);
    bounds.largest_radius = 0.2f;
    for (int k = 0; k < 40; ++k) {
        const auto turn = static_cast<float>(k);
        const glm::vec3 sun =
            k < 6 ? glm::vec3(k % 3 == 0, k % 3 == 1, k % 3 == 2) * (k < 3 ? 1.0f : -1.0f)
                  : glm::vec3(std::cos(turn), std::sin(2 * turn), std::sin(turn));
        const glm::uvec3 voxels(32, 24, 40);
        const auto box = fit_light_box(bounds, sun, voxels);
        ASSERT_TRUE(box);
        EXPECT_EQ(box->largest_radius, 0.2f);
        glm::vec3 low(1e30f);
        glm::vec3 high(-1e30f);
        for (int c = 0; c < 8; ++c) {
            const glm::vec3 corner((c & 1) != 0 ? bounds.high.x : bounds.low.x,
                                   (c & 2) != 0 ? bounds.high.y : bounds.low.y,
                                   (c & 4) != 0 ? bounds.high.z : bounds.low.z);
            const glm::vec3 cells = shared::cells_of(box->grid, corner);
            low = glm::min(low, cells);
            high = glm::max(high, cells);
        }
        for (int a = 0; a < 3; ++a) {
            EXPECT_GE(low[a], 0.999f) << k;
            EXPECT_LE(high[a], float(voxels[a]) - 0.999f) << k;
            // 3 voxels of margins and snapping, and sides of up to 2.2 % more.
            EXPECT_GE(high[a] - low[a], (float(voxels[a]) - 3) / 1.0222f) << k;
        }
    }
}

// 1,000 particles around a place that none has its centre at: a line through it is as deep as all
// of them together, about 10 times as deep as the sum of those whose centres lie side by side.
TEST(light_boxes, know_the_depth_where_particles_overlap) {
    std::vector<cloud_particle> particles(1000);
    const glm::dvec3 sun = glm::normalize(glm::dvec3(slanting));
    const glm::dvec3 side = glm::normalize(glm::cross(sun, glm::dvec3(0, 1, 0)));
    for (std::size_t i = 0; i < particles.size(); ++i) {
        const double turn = static_cast<double>(i) * 0.00628318530718;
        particles[i].position =
            glm::vec3(0.6 * (std::cos(turn) * side + std::sin(turn) * glm::cross(sun, side)));
        particles[i].radius = 1;
        particles[i].optical_depth = 100;
    }
    cpu::device device;
    const glm::uvec3 voxels(21, 8, 21);
    const attenuation_options way =
        with(attenuation_method::impulse_scan, attenuation_profile::step);
    const auto box = fit_light_box(particles, slanting, voxels);
    ASSERT_TRUE(box);
    const auto values = cold(device, particles, slanting, voxels, way);
    ASSERT_FALSE(values.empty());
    EXPECT_LE(worst_of(values, *box, particles, way), 2e-5);
    EXPECT_GT(*std::max_element(values.begin(), values.end()), 1.5e4f);
}

} // namespace
