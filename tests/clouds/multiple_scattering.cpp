// Light that is scattered many times, against exact layers (adding and doubling) and paths of
// photons through Gaussian clouds; the same on all backends, and what it must not depend on.
#include "../support/adding_doubling.hpp"
#include "../support/allocations.hpp"
#include "../support/devices.hpp"

#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/multiple_scattering.hpp>
#include <skybark/clouds/path_tracer.hpp>

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace {

using namespace skybark;
using namespace skybark::clouds;

template <class Device>
using scattering_on = multiple_scattering<std::remove_reference_t<Device>>;

scattering_medium henyey_greenstein(float g, float albedo) { return {albedo, g, g * g}; }

std::size_t index_of(glm::uvec3 size, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return (std::size_t{z} * size.y + y) * size.x + x;
}

template <class Device>
std::vector<float> downloaded(Device& device, const scattering_on<Device>& from) {
    const glm::uvec3 size = from.size();
    std::vector<float> values(std::size_t{size.x} * size.y * size.z);
    EXPECT_TRUE(device.download(from.fluence(), std::as_writable_bytes(std::span<float>(values))));
    return values;
}

/// The attenuation of any cloud: what is in `values`, in a box with voxels of these sides.
template <class Device>
struct given_cloud {
    typename Device::volume attenuation;
    light_box box;

    given_cloud(Device& device, glm::uvec3 voxels, glm::vec3 sides, std::span<const float> values)
        : attenuation(std::move(
              *device.create_volume({voxels.x, voxels.y, voxels.z, volume_format::float32}))) {
        EXPECT_TRUE(device.upload(attenuation, std::as_bytes(values)));
        box.voxels = voxels;
        box.grid.voxel = glm::vec4(sides, 1);
        box.grid.row_x /= sides.x;
        box.grid.row_y /= sides.y;
        box.grid.row_z /= sides.z;
    }
};

template <class Device>
std::vector<float> solved(Device& device, const given_cloud<Device>& cloud,
                          scattering_on<Device>& scattering) {
    EXPECT_TRUE(run(
        device, [&](auto& recorder) { scattering.solve(recorder, cloud.attenuation, cloud.box); }));
    return downloaded(device, scattering);
}

// Layers ------------------------------------------------------------------------------------------

constexpr float slab_albedos[] = {1, 0.999f, 0.9f};
constexpr float slab_cosines[] = {0, 0.75f, 0.85f};
constexpr float slab_depths[] = {0.5f, 1, 2, 4, 8, 16, 32, 64};

/// A layer so wide that the light in its middle knows no borders: voxels of a metre by 10⁶ metres,
/// two without matter above it and two below.
template <class Device>
given_cloud<Device> wide_layer(Device& device, float depth, std::uint32_t layers = 128) {
    const glm::uvec3 voxels(4, layers + 4, 4);
    std::vector<float> values(std::size_t{16} * voxels.y);
    for (std::uint32_t y = 0; y < voxels.y; ++y) {
        const float above = static_cast<float>(layers) + 1.5f - static_cast<float>(y);
        const float part = std::clamp(above / static_cast<float>(layers), 0.0f, 1.0f);
        for (std::uint32_t i = 0; i < 16; ++i) {
            values[index_of(voxels, i % 4, y, i / 4)] = depth * part;
        }
    }
    return {device, voxels, {1e6f, 1, 1e6f}, values};
}

struct slab_result {
    double transmission = 0;
    double reflection = 0;
};

template <class Device>
slab_result slab(Device& device, float depth, const scattering_medium& medium) {
    const auto cloud = wide_layer(device, depth);
    multiple_scattering_options options;
    options.medium = medium;
    auto scattering = scattering_on<Device>::create(device, cloud.box.voxels, options);
    EXPECT_TRUE(scattering);
    const std::vector<float> phi = solved(device, cloud, *scattering);
    const glm::uvec3 size = scattering->size();
    const double out = double(scattering->escape(cloud.box).y);
    const double direct = std::exp(-double(depth) * (1 - double(medium.albedo * medium.forward)));
    return {direct + out * double(phi[index_of(size, 0, 0, 0)]),
            out * double(phi[index_of(size, 0, size.y - 1, 0)])};
}

class scattering_everywhere : public testing::TestWithParam<const char*> {};

TEST_P(scattering_everywhere, transmits_through_layers_like_the_exact_solution) {
    support::with_device(GetParam(), [](auto& device) {
        const bool all = device.name() == std::string_view("cpu");
        for (const float albedo : slab_albedos) {
            for (const float g : slab_cosines) {
                for (const float depth : slab_depths) {
                    if (!all && (g != 0.85f || (depth != 2 && depth != 64))) {
                        continue;
                    }
                    const auto exact =
                        support::adding_doubling(double(depth), double(g), double(albedo));
                    const auto found = slab(device, depth, henyey_greenstein(g, albedo));
                    const double off = found.transmission / exact.transmission - 1;
                    const std::string what = "albedo " + std::to_string(albedo) + ", g " +
                                             std::to_string(g) + ", depth " + std::to_string(depth);
                    // Held to 5 % where it is bright, 20 % down to 0.001.
                    if (exact.transmission >= 0.001) {
                        EXPECT_LE(std::abs(off), exact.transmission >= 0.05 ? 0.05 : 0.2) << what;
                    }
                    // δ-Eddington's own error; without a cloud's sides nothing else is left.
                    EXPECT_NEAR(found.reflection, exact.reflection, 0.013) << what;
                    // No light is made, but for what the last cycle has left undone.
                    EXPECT_LE(found.transmission + found.reflection, 1.002) << what;
                }
            }
        }
    });
}

// Clouds ------------------------------------------------------------------------------------------

/// Gaussian particles in a ball of radius 1 (flattened to `height`), every one as deep as the
/// next, so that a line through the middle crosses `depth` on average.
std::vector<cloud_particle> crowd(std::size_t count, float smallest, float largest, float height,
                                  float depth, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1, 1);
    std::uniform_real_distribution<float> radius(smallest, largest);
    std::vector<cloud_particle> particles;
    double area = 0; // of a line's cross section, all particles together
    while (particles.size() < count) {
        const glm::vec3 at(unit(random), unit(random), unit(random));
        if (glm::dot(at, at) <= 1) {
            cloud_particle p;
            p.position = at * glm::vec3(1, height, 1);
            p.radius = radius(random);
            p.optical_depth = 1;
            particles.push_back(p);
            const double sigma = double(p.radius) / 3;
            area += 2 * 3.141592653589793 * sigma * sigma;
        }
    }
    for (cloud_particle& p : particles) {
        p.optical_depth = static_cast<float>(double(depth) * 3.141592653589793 / area);
    }
    return particles;
}

std::vector<cloud_particle> single_blob(float depth) {
    cloud_particle p;
    p.radius = 1;
    p.optical_depth = depth;
    return {p};
}

/// Linear between the middles of cells, at a place in cells.
double sampled(const std::vector<float>& values, glm::uvec3 size, glm::dvec3 cells) {
    const glm::dvec3 last = glm::dvec3(size) - 1.0;
    const glm::dvec3 at = glm::clamp(cells - 0.5, glm::dvec3(0), last);
    const glm::dvec3 low = glm::min(glm::floor(at), glm::max(last - 1.0, glm::dvec3(0)));
    const glm::dvec3 part = at - low;
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
        const glm::ivec3 o(c & 1, (c >> 1) & 1, c >> 2);
        const glm::dvec3 w = glm::mix(1.0 - part, part, glm::dvec3(o));
        const glm::uvec3 v = glm::min(glm::uvec3(low) + glm::uvec3(o), size - 1u);
        sum += w.x * w.y * w.z * double(values[index_of(size, v.x, v.y, v.z)]);
    }
    return sum;
}

/// How far off fluences are, over a cloud.
struct fluence_error {
    double of_water = 0;  ///< mean relative error, each place as often as there is water
    double of_places = 0; ///< over the voxels with at least 1 % of the largest extinction
    double bias = 0;      ///< mean of found over true, less 1, by water
};

/// A cloud, and what paths of photons make of it.
struct traced_cloud {
    std::vector<cloud_particle> particles;
    glm::vec3 sun{0, 1, 0};
    light_box box;
    std::vector<double> truth;
    std::vector<double> noise;      ///< standard errors
    std::vector<double> extinction; ///< in the middle of each voxel, 1/m
    std::vector<double> depth;      ///< between there and the sun, exact

    traced_cloud(std::vector<cloud_particle> cloud, glm::vec3 to_sun, std::uint32_t side,
                 scattering_medium medium, std::uint64_t paths)
        : particles(std::move(cloud)), sun(glm::normalize(to_sun)) {
        for (cloud_particle& p : particles) {
            p.albedo = medium.albedo;
        }
        box = *fit_light_box(particles, sun, glm::uvec3(side));
        // Water ends at the radius here: three standard deviations.
        const auto matter = gaussian_medium::create(particles, 3, 3);
        path_options how;
        how.paths = paths;
        const auto field =
            trace_fluence(*matter, phase_function::henyey_greenstein(double(medium.mean_cosine)),
                          glm::normalize(glm::dvec3(sun)), box.grid, box.voxels, how);
        truth = field->mean;
        noise = field->standard_error;
        for (std::uint32_t z = 0; z < side; ++z) {
            for (std::uint32_t y = 0; y < side; ++y) {
                for (std::uint32_t x = 0; x < side; ++x) {
                    const glm::dvec3 at = place(glm::dvec3(x, y, z) + 0.5);
                    extinction.push_back(extinction_at(at));
                    depth.push_back(matter->optical_depth(at, glm::normalize(glm::dvec3(sun))));
                }
            }
        }
    }

    [[nodiscard]] glm::dvec3 place(glm::dvec3 cells) const {
        glm::dvec3 at(glm::vec3(box.grid.anchor));
        const glm::vec4 rows[] = {box.grid.row_x, box.grid.row_y, box.grid.row_z};
        for (int a = 0; a < 3; ++a) {
            const glm::dvec3 axis = glm::normalize(glm::dvec3(glm::vec3(rows[a])));
            at += axis * (double(box.grid.voxel[a]) * (cells[a] - double(rows[a].w)));
        }
        return at;
    }

    [[nodiscard]] double extinction_at(glm::dvec3 at) const {
        double sum = 0;
        for (const cloud_particle& p : particles) {
            const glm::dvec3 d = at - glm::dvec3(p.position);
            const double sigma = double(p.radius) / 3;
            if (glm::dot(d, d) < double(p.radius) * double(p.radius)) {
                sum += double(p.optical_depth) / (sigma * 2.5066282746310002) *
                       std::exp(-glm::dot(d, d) / (2 * sigma * sigma));
            }
        }
        return sum;
    }

    /// Of `found(voxel number, its middle in voxels)`, where the truth is known to 10 %.
    template <class Found>
    [[nodiscard]] fluence_error score(Found&& found) const {
        const double most = *std::max_element(extinction.begin(), extinction.end());
        fluence_error error;
        double water = 0;
        double places = 0;
        for (std::size_t i = 0; i < truth.size(); ++i) {
            if (extinction[i] <= 0 || !(noise[i] < 0.1 * truth[i])) {
                continue;
            }
            const std::size_t side = box.voxels.x;
            const glm::dvec3 cells(glm::uvec3(i % side, i / side % side, i / (side * side)));
            const double off = found(i, cells + 0.5) / truth[i] - 1;
            error.of_water += extinction[i] * std::abs(off);
            error.bias += extinction[i] * off;
            water += extinction[i];
            if (extinction[i] > 0.01 * most) {
                error.of_places += std::abs(off);
                ++places;
            }
        }
        error.of_water /= water;
        error.bias /= water;
        error.of_places /= places;
        return error;
    }
};

/// The fluence of a cloud by the attenuation volume of extinction and what scatters on it.
template <class Device>
fluence_error scored(Device& device, const traced_cloud& cloud, const scattering_medium& medium,
                     std::uint32_t finer = 1) {
    attenuation_options light;
    light.light = attenuation_light::extinction;
    light_box box = *fit_light_box(cloud.particles, cloud.sun, cloud.box.voxels * finer);
    auto attenuation = attenuation_volume<Device>::create(device, box.voxels, light);
    multiple_scattering_options options;
    options.medium = medium;
    auto scattering = scattering_on<Device>::create(device, box.voxels, options);
    auto particles = make_buffer<Device, cloud_particle>(
        device, std::span<const cloud_particle>(cloud.particles));
    EXPECT_TRUE(attenuation && scattering && particles);
    EXPECT_TRUE(run(device, [&](auto& recorder) {
        attenuation->relight(recorder, view<Device>(*particles),
                             static_cast<std::uint32_t>(cloud.particles.size()), box);
        scattering->solve(recorder, attenuation->volume(), box);
    }));
    const std::vector<float> phi = downloaded(device, *scattering);
    const light_grid grid = scattering->grid(box);
    return cloud.score([&](std::size_t i, glm::dvec3 cells) {
        const glm::vec3 place(cloud.place(cells));
        const glm::dvec3 at(shared::cells_of(grid, place));
        return std::exp(-cloud.depth[i] * double(share_of(medium))) +
               sampled(phi, scattering->size(), at);
    });
}

/// The paper's product (eq. 7), with the phase function straight on.
fluence_error product_scored(cpu::device& device, const traced_cloud& cloud,
                             const scattering_medium& medium) {
    attenuation_options light;
    light.light = attenuation_light::product;
    light.forward = static_cast<float>(
        phase_function::henyey_greenstein(double(medium.mean_cosine)).forward_value());
    auto attenuation = attenuation_volume<cpu::device>::create(device, cloud.box.voxels, light);
    auto particles = make_buffer<cpu::device, cloud_particle>(
        device, std::span<const cloud_particle>(cloud.particles));
    EXPECT_TRUE(attenuation && particles);
    EXPECT_TRUE(run(device, [&](auto& recorder) {
        attenuation->relight(recorder, view<cpu::device>(*particles),
                             static_cast<std::uint32_t>(cloud.particles.size()), cloud.box);
    }));
    std::vector<float> values(cloud.truth.size());
    EXPECT_TRUE(
        device.download(attenuation->volume(), std::as_writable_bytes(std::span<float>(values))));
    return cloud.score([&](std::size_t i, glm::dvec3) { return std::exp(-double(values[i])); });
}

TEST_P(scattering_everywhere, lights_gaussian_clouds_like_paths_of_photons) {
    const scattering_medium medium = henyey_greenstein(0.85f, 1);
    static const traced_cloud cloud(crowd(60, 0.2f, 0.36f, 1, 8, 1), {0.5f, 1, -0.3f}, 32, medium,
                                    1 << 19);
    support::with_device(GetParam(), [&](auto& device) {
        const fluence_error error = scored(device, cloud, medium);
        // Held to 15 %.
        EXPECT_LE(error.of_water, 0.15);
        EXPECT_LE(error.of_places, 0.15);
    });
}

// What must not matter ----------------------------------------------------------------------------

/// A cloud without a plan, that fills what is not a border: columns add up what is random.
std::vector<float> random_attenuation(glm::uvec3 size, float most, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> amount(0, most);
    std::vector<float> values(std::size_t{size.x} * size.y * size.z, 0);
    for (std::uint32_t z = 1; z + 1 < size.z; ++z) {
        for (std::uint32_t x = 1; x + 1 < size.x; ++x) {
            float sum = 0;
            for (std::uint32_t y = size.y - 1; y-- > 0;) {
                sum += y > 1 ? amount(random) : 0.0f;
                values[index_of(size, x, y, z)] = sum;
            }
        }
    }
    return values;
}

constexpr glm::uvec3 odd_size(21, 26, 17);

template <class Device>
std::vector<float> solved(Device& device, glm::uvec3 size, glm::vec3 sides,
                          std::span<const float> values,
                          const multiple_scattering_options& options = {}) {
    const given_cloud<Device> cloud(device, size, sides, values);
    auto scattering = scattering_on<Device>::create(device, size, options);
    EXPECT_TRUE(scattering);
    return solved(device, cloud, *scattering);
}

double largest(const std::vector<float>& values) {
    return double(*std::max_element(values.begin(), values.end()));
}

double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
    EXPECT_EQ(a.size(), b.size());
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        most = std::max(most, std::abs(double(a[i]) - double(b[i])));
    }
    return most;
}

TEST_P(scattering_everywhere, is_the_same_on_all_backends) {
    const auto values = random_attenuation(odd_size, 0.5f, 11);
    multiple_scattering_options options;
    options.medium = henyey_greenstein(0.85f, 0.99f);
    cpu::device cpu;
    const auto expected = solved(cpu, odd_size, {3, 2, 4}, values, options);
    support::with_device(GetParam(), [&](auto& device) {
        const auto found = solved(device, odd_size, {3, 2, 4}, values, options);
        // The formulas are + - * / and sqrt; where a device rounds a quotient differently (2.5 ulp
        // are allowed), 40 steps in a row with weights of up to 1.73 add up to less than 40 · 2.5 ·
        // 2^-23 · 1.73 = 2e-5 of the brightest.
        EXPECT_LE(largest_difference(found, expected), 2e-5 * largest(expected));
        EXPECT_GT(largest(found), 0.5);
    });
}

/// Of a volume of 216 MiB, where lavapipe binds 128 MiB of a buffer at most.
TEST(scattering, of_a_volume_larger_than_a_binding_slow) {
    const glm::uvec3 size(384);
    const auto values = random_attenuation(size, 0.03f, 22);
    multiple_scattering_options options;
    options.medium = henyey_greenstein(0.85f, 0.99f);
    cpu::device cpu;
    const auto expected = solved(cpu, size, {3, 2, 4}, values, options);
    support::with_device("vulkan", [&](auto& device) {
        const auto found = solved(device, size, {3, 2, 4}, values, options);
        ASSERT_EQ(found.size(), expected.size());
        EXPECT_TRUE(
            std::all_of(found.begin(), found.end(), [](float v) { return std::isfinite(v); }));
        // As of small ones: coarser grids than theirs take steps of their own, but hand on no more.
        EXPECT_LE(largest_difference(found, expected), 2e-5 * largest(expected));
        EXPECT_GT(largest(found), 0.5);
    });
}

TEST_P(scattering_everywhere, has_no_history) {
    support::with_device(GetParam(), [](auto& device) {
        using Device = std::remove_reference_t<decltype(device)>;
        const auto first = random_attenuation(odd_size, 0.5f, 12);
        const auto other = random_attenuation(odd_size, 5, 13);
        const given_cloud<Device> cloud(device, odd_size, {3, 2, 4}, first);
        const given_cloud<Device> another(device, odd_size, {1, 2, 1}, other);
        auto scattering = scattering_on<Device>::create(device, odd_size);
        ASSERT_TRUE(scattering);
        const auto cold = solved(device, cloud, *scattering);
        const auto between = solved(device, another, *scattering);
        EXPECT_NE(between, cold);
        EXPECT_EQ(solved(device, cloud, *scattering), cold);
    });
}

TEST_P(scattering_everywhere, of_nothing_is_nothing) {
    support::with_device(GetParam(), [](auto& device) {
        const std::vector<float> none(std::size_t{odd_size.x} * odd_size.y * odd_size.z, 0);
        EXPECT_EQ(largest(solved(device, odd_size, {1, 1, 1}, none)), 0);
        // Nor does what only absorbs scatter.
        multiple_scattering_options options;
        options.medium.albedo = 0;
        const auto values = random_attenuation(odd_size, 0.5f, 14);
        EXPECT_EQ(largest(solved(device, odd_size, {1, 1, 1}, values, options)), 0);
    });
}

TEST(scattering, of_a_cloud_and_its_mirror_images) {
    cpu::device device;
    const glm::uvec3 size(32, 20, 32); // halved to the end, so that no grid is lopsided
    const auto values = random_attenuation(size, 0.7f, 15);
    const auto image = [&](const std::vector<float>& of, glm::uvec3 n, int which) {
        std::vector<float> to(of.size());
        for (std::uint32_t z = 0; z < n.z; ++z) {
            for (std::uint32_t y = 0; y < n.y; ++y) {
                for (std::uint32_t x = 0; x < n.x; ++x) {
                    const glm::uvec3 from = which == 0   ? glm::uvec3(n.x - 1 - x, y, z)
                                            : which == 1 ? glm::uvec3(x, y, n.z - 1 - z)
                                                         : glm::uvec3(z, y, x);
                    to[index_of(n, x, y, z)] = of[index_of(n, from.x, from.y, from.z)];
                }
            }
        }
        return to;
    };
    const auto whole = solved(device, size, {2, 3, 2}, values);
    for (int which = 0; which < 3; ++which) {
        const auto found = solved(device, size, {2, 3, 2}, image(values, size, which));
        // Neighbours are added in another order: a rounding or two in each of 40 steps.
        EXPECT_LE(largest_difference(found, image(whole, size / 2u, which)), 1e-5 * largest(whole));
    }
}

TEST(scattering, makes_and_loses_no_light) {
    cpu::device device;
    const auto values = random_attenuation(odd_size, 0.6f, 16);
    const glm::vec3 sides(3, 2, 4);
    for (const float albedo : {1.0f, 0.9f}) {
        multiple_scattering_options options;
        options.medium = henyey_greenstein(0.85f, albedo);
        options.cycles = 12;
        const given_cloud<cpu::device> cloud(device, odd_size, sides, values);
        auto scattering = scattering_on<cpu::device>::create(device, odd_size, options);
        ASSERT_TRUE(scattering);
        const auto phi = solved(device, cloud, *scattering);
        const glm::uvec3 n = scattering->size();
        const glm::dvec3 side(sides * 2.0f);
        const glm::dvec3 out(scattering->escape(cloud.box));
        const glm::dvec3 faces(side.y * side.z, side.x * side.z, side.x * side.y);
        // What columns scatter of the beam, what is absorbed of the diffuse light, what leaves.
        const double kept = double(share_of(options.medium));
        const double forward = double(options.medium.forward);
        double scattered = 0;
        double absorbed = 0;
        double left = 0;
        for (std::uint32_t z = 0; z < odd_size.z; ++z) {
            for (std::uint32_t x = 0; x < odd_size.x; ++x) {
                const double depth = double(values[index_of(odd_size, x, 0, z)]);
                scattered += double(albedo) * (1 - forward) / kept * -std::expm1(-kept * depth) *
                             double(sides.x) * double(sides.z);
            }
        }
        const auto row = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
            const bool inside = x < odd_size.x && y < odd_size.y && z < odd_size.z;
            return inside ? double(values[index_of(odd_size, x, y, z)]) : 0.0;
        };
        for (std::uint32_t z = 0; z < n.z; ++z) {
            for (std::uint32_t y = 0; y < n.y; ++y) {
                for (std::uint32_t x = 0; x < n.x; ++x) {
                    const double here = double(phi[index_of(n, x, y, z)]);
                    const glm::uvec3 at(x, y, z);
                    for (int a = 0; a < 3; ++a) {
                        left += (at[a] == 0 ? here * out[a] * faces[a] : 0) +
                                (at[a] + 1 == n[a] ? here * out[a] * faces[a] : 0);
                    }
                    for (std::uint32_t c = 0; c < 4; ++c) {
                        const std::uint32_t vx = 2 * x + c % 2;
                        const std::uint32_t vz = 2 * z + c / 2;
                        const double below = y == 0 ? row(vx, 0, vz) : row(vx, 2 * y - 1, vz);
                        const double taken = (below + row(vx, 2 * y, vz)) / 2 -
                                             (row(vx, 2 * y + 1, vz) + row(vx, 2 * y + 2, vz)) / 2;
                        absorbed +=
                            (1 - double(albedo)) * taken * here * double(sides.x) * double(sides.z);
                    }
                }
            }
        }
        // Floats, and 12 cycles.
        EXPECT_NEAR((left + absorbed) / scattered, 1, 1e-3) << "albedo " << albedo;
    }
}

TEST(scattering, has_converged) {
    cpu::device device;
    const auto cloud = [&](std::uint32_t cycles) {
        multiple_scattering_options options;
        options.cycles = cycles;
        return solved(device, odd_size, {3, 2, 4}, random_attenuation(odd_size, 0.8f, 17), options);
    };
    const auto exact = cloud(40);
    const auto two = cloud(2);
    const auto four = cloud(4);
    double mean = 0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        mean += std::abs(double(two[i]) - double(exact[i])) / double(exact.size());
    }
    // Cells twice as long as high: 0.37 of the error remains after a step of the smoother, the
    // limiter follows a cycle behind. Measured: 1.2 %, 3.2 %, 0.7 %.
    RecordProperty("mean", std::to_string(mean / largest(exact)));
    RecordProperty("two", std::to_string(largest_difference(two, exact) / largest(exact)));
    RecordProperty("four", std::to_string(largest_difference(four, exact) / largest(exact)));
    EXPECT_LE(mean, 0.02 * largest(exact));
    EXPECT_LE(largest_difference(two, exact), 0.05 * largest(exact));
    EXPECT_LE(largest_difference(four, exact), 0.01 * largest(exact));
}

/// Thick matter beside empty space that does not resist: where coarser grids help least.
TEST(scattering, converges_without_a_limiter_as_well) {
    cpu::device device;
    const glm::uvec3 size(48);
    auto values = random_attenuation(size, 4, 20);
    for (std::uint32_t i = 0; i < values.size(); ++i) {
        const glm::dvec2 off(double(i % 48) - 23.5, double(i / (48 * 48)) - 23.5);
        values[i] *= glm::length(off) < 15 ? 1.0f : 0.0f;
    }
    const auto cloud = [&](std::uint32_t cycles) {
        multiple_scattering_options options;
        options.medium = henyey_greenstein(0, 1);
        options.spreading = 0;
        options.emptiness = 0;
        options.cycles = cycles;
        return solved(device, size, {1, 1, 1}, values, options);
    };
    const auto exact = cloud(60);
    EXPECT_LE(largest(exact), 10);
    EXPECT_LE(largest_difference(cloud(20), exact), 0.01 * largest(exact));
}

TEST(scattering, of_a_coarser_grid_is_nearly_the_same) {
    cpu::device device;
    const glm::uvec3 size(64);
    std::vector<float> values(std::size_t{64} * 64 * 64);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const glm::dvec3 at =
            (glm::dvec3(glm::uvec3(i % 64, i / 64 % 64, i / 4096)) + 0.5 - 32.0) / 10.0;
        values[i] = static_cast<float>(10 * std::exp(-(at.x * at.x + at.z * at.z) / 2) * 0.5 *
                                       std::erfc(at.y / 1.4142135623730951));
    }
    multiple_scattering_options options;
    options.medium = henyey_greenstein(0.85f, 1);
    const auto fine = solved(device, size, {1, 1, 1}, values, options);
    options.halvings = 2;
    const auto coarse = solved(device, size, {1, 1, 1}, values, options);
    double most = 0;
    for (std::uint32_t z = 0; z < 16; ++z) {
        for (std::uint32_t y = 0; y < 16; ++y) {
            for (std::uint32_t x = 0; x < 16; ++x) {
                const double found = double(coarse[index_of(glm::uvec3(16), x, y, z)]);
                const double there = sampled(fine, glm::uvec3(32), glm::dvec3(x, y, z) * 2.0 + 1.0);
                most = std::max(most, std::abs(found - there));
            }
        }
    }
    EXPECT_LE(most, 0.03 * largest(fine));
}

// Where the fluence lies: cells of two, four … voxels from the same corner on.
TEST(scattering, has_a_grid_of_as_many_halvings) {
    cpu::device device;
    light_box box;
    box.voxels = glm::uvec3(64, 48, 40);
    box.grid.anchor = glm::vec4(10, 20, 30, 0);
    const glm::dvec3 y = glm::normalize(glm::dvec3(0.3, 0.8, -0.5));
    const glm::dvec3 x = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), y));
    box.grid.row_x = glm::vec4(glm::vec3(x / 2.0), 31.5f);
    box.grid.row_y = glm::vec4(glm::vec3(y / 3.0), 22.25f);
    box.grid.row_z = glm::vec4(glm::vec3(glm::cross(x, y) / 0.5), 19);
    box.grid.voxel = glm::vec4(2, 3, 0.5f, 1);
    for (std::uint32_t halvings = 1; halvings <= 4; ++halvings) {
        multiple_scattering_options options;
        options.halvings = halvings;
        const auto scattering =
            multiple_scattering<cpu::device>::create(device, box.voxels, options);
        ASSERT_TRUE(scattering);
        const float over = std::ldexp(1.0f, -static_cast<int>(halvings));
        const light_grid grid = scattering->grid(box);
        for (const glm::vec3 place : {glm::vec3(10, 20, 30), glm::vec3(-3, 40, 25)}) {
            const glm::vec3 fine = shared::cells_of(box.grid, place);
            const glm::vec3 coarse = shared::cells_of(grid, place);
            for (int a = 0; a < 3; ++a) {
                EXPECT_NEAR(coarse[a], fine[a] * over, 1e-4f) << halvings;
                EXPECT_EQ(grid.voxel[a], box.grid.voxel[a] / over);
            }
        }
        const glm::uvec3 size = scattering->size();
        EXPECT_EQ(size, glm::uvec3(glm::ceil(glm::vec3(box.voxels) * over)));
    }
}

TEST(scattering, takes_the_light_of_the_continuum_as_well) {
    cpu::device device;
    auto values = random_attenuation(odd_size, 0.5f, 18);
    multiple_scattering_options options;
    options.medium = henyey_greenstein(0.85f, 0.95f);
    const auto expected = solved(device, odd_size, {3, 2, 4}, values, options);
    options.share = share_of(options.medium);
    for (float& v : values) {
        v *= options.share;
    }
    const auto found = solved(device, odd_size, {3, 2, 4}, values, options);
    EXPECT_LE(largest_difference(found, expected), 1e-5 * largest(expected));
}

TEST(scattering, frames_allocate_nothing) {
    cpu::device device;
    const auto values = random_attenuation(odd_size, 0.5f, 19);
    const given_cloud<cpu::device> cloud(device, odd_size, {1, 1, 1}, values);
    auto scattering = multiple_scattering<cpu::device>::create(device, odd_size);
    ASSERT_TRUE(scattering);
    std::uint64_t allocations[2] = {0, 0};
    for (std::uint64_t& count : allocations) {
        auto recorder = device.begin();
        const std::uint64_t before = support::allocations;
        scattering->solve(*recorder, cloud.attenuation, cloud.box);
        count = support::allocations - before;
        ASSERT_TRUE(device.submit(*recorder));
    }
    EXPECT_EQ(allocations[1], 0u);
}

TEST(scattering, refuses_what_makes_no_sense) {
    cpu::device device;
    const auto refused = [&](glm::uvec3 size, const multiple_scattering_options& options) {
        const auto made = multiple_scattering<cpu::device>::create(device, size, options);
        return !made && made.error().code == error_code::bad_input && !made.error().message.empty();
    };
    const float not_a_number = std::nanf("");
    multiple_scattering_options options;
    EXPECT_FALSE(refused(odd_size, options));
    EXPECT_TRUE(refused({3, 64, 64}, options));
    EXPECT_TRUE(refused({65536, 65536, 65536}, options));
    for (const scattering_medium medium :
         {scattering_medium{1.1f, 0, 0}, scattering_medium{-0.1f, 0, 0},
          scattering_medium{1, 1, 0.5f}, scattering_medium{1, 0.5f, 1},
          scattering_medium{not_a_number, 0, 0}, scattering_medium{1, not_a_number, 0}}) {
        options.medium = medium;
        EXPECT_TRUE(refused(odd_size, options));
    }
    options = {};
    options.halvings = 0;
    EXPECT_TRUE(refused(odd_size, options));
    options = {};
    options.cycles = 0;
    EXPECT_TRUE(refused(odd_size, options));
    options = {};
    options.most_bytes = 1000;
    EXPECT_TRUE(refused(odd_size, options));
    auto made = multiple_scattering<cpu::device>::create(device, odd_size);
    ASSERT_TRUE(made);
    EXPECT_FALSE(made->set_medium({2, 0, 0}));
    EXPECT_TRUE(made->set_medium({1, 0.5f, 0.25f}));
}

// The tables of the docs -------------------------------------------------------------------------

TEST(scattering_table, of_layers_slow) {
    cpu::device device;
    std::printf("| albedo | g | depth | transmission | error | reflection | error |\n");
    for (const float albedo : slab_albedos) {
        for (const float g : slab_cosines) {
            for (const float depth : slab_depths) {
                const auto exact =
                    support::adding_doubling(double(depth), double(g), double(albedo));
                const auto found = slab(device, depth, henyey_greenstein(g, albedo));
                std::printf("| %.3f | %.2f | %g | %.5f | %+.1f %% | %.5f | %+.4f |\n",
                            double(albedo), double(g), double(depth), exact.transmission,
                            100 * (found.transmission / exact.transmission - 1), exact.reflection,
                            found.reflection - exact.reflection);
                EXPECT_NEAR(found.transmission, exact.transmission, 0.05);
            }
        }
    }
}

/// Every method on every cloud: mean relative errors of fluence, by water and by places, in
/// percent. Volumes of 96³ voxels, and (coarse) of 48³.
TEST(scattering_table, of_gaussian_clouds_slow) {
    cpu::device device;
    struct sort {
        const char* name;
        std::vector<cloud_particle> particles;
        glm::vec3 sun;
    };
    const sort clouds[] = {
        {"one blob, depth 2", single_blob(2), {0, 1, 0}},
        {"one blob, depth 10", single_blob(10), {0, 1, 0}},
        {"one blob, depth 40", single_blob(40), {0, 1, 0}},
        {"60 blobs, depth 8", crowd(60, 0.2f, 0.36f, 1, 8, 1), {0.5f, 1, -0.3f}},
        {"60 blobs, depth 30", crowd(60, 0.2f, 0.36f, 1, 30, 2), {0, 1, 0}},
        {"300 blobs, flat, depth 10", crowd(300, 0.08f, 0.2f, 0.5f, 10, 3), {0, 1, 0}},
        {"300 blobs, flat, depth 40", crowd(300, 0.08f, 0.2f, 0.5f, 40, 4), {0, 1, 0}},
        {"300 blobs, flat, depth 40, low sun", crowd(300, 0.08f, 0.2f, 0.5f, 40, 5), {1, 0.3f, 0}},
    };
    const scattering_medium media[] = {henyey_greenstein(0.85f, 1), henyey_greenstein(0.75f, 1),
                                       henyey_greenstein(0.85f, 0.999f),
                                       henyey_greenstein(0.85f, 0.9f), henyey_greenstein(0, 1)};
    std::printf("| g | albedo | cloud | here (bias) | coarse | product | continuum | octaves | "
                "extinction |\n");
    for (const scattering_medium& medium : media) {
        for (const sort& c : clouds) {
            const traced_cloud cloud(c.particles, c.sun, 48, medium, 1 << 20);
            const fluence_error coarse = scored(device, cloud, medium);
            const fluence_error ours = scored(device, cloud, medium, 2);
            const auto of_depth = [&](auto&& light) {
                return cloud.score(
                    [&](std::size_t i, glm::dvec3) { return light(cloud.depth[i]); });
            };
            const fluence_error none = of_depth([](double tau) { return std::exp(-tau); });
            const fluence_error product = product_scored(device, cloud, medium);
            const fluence_error continuum =
                of_depth([&](double tau) { return std::exp(-tau * double(share_of(medium))); });
            const fluence_error octaves = of_depth([](double tau) {
                double sum = 0;
                double weight = 0.5;
                double depth = tau;
                for (int i = 0; i < 16; ++i, weight /= 2, depth /= 2) {
                    sum += weight * std::exp(-depth);
                }
                return sum;
            });
            std::printf("| %.2f | %.3f | %s | %.1f / %.1f (%+.1f) | %.1f / %.1f | %.2g | %.0f | "
                        "%.0f | %.0f "
                        "|\n",
                        double(medium.mean_cosine), double(medium.albedo), c.name,
                        100 * ours.of_water, 100 * ours.of_places, 100 * ours.bias,
                        100 * coarse.of_water, 100 * coarse.of_places, 100 * product.of_water,
                        100 * continuum.of_water, 100 * octaves.of_water, 100 * none.of_water);
            std::fflush(stdout);
            // Held to 15 %.
            EXPECT_LE(ours.of_water, 0.15) << c.name;
            EXPECT_LE(ours.of_places, 0.15) << c.name;
            // Cells larger than the particles' standard deviation: 37 % by water and 38 % by
            // places where isotropic light comes through the flat cloud of depth 40 from the side.
            EXPECT_LE(coarse.of_water, 0.40) << c.name;
            EXPECT_LE(coarse.of_places, 0.40) << c.name;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(backends, scattering_everywhere,
                         testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& on) { return std::string(on.param); });

} // namespace
