// The CPU's own particle_impulse and shadow_slab give the plain kernels' bits.

#include "support/cpu_work.hpp"

#include <cstring>
#include <gtest/gtest.h>

using namespace skybark;
using support::expect_value;

namespace {

using device = cpu::device;

struct cloud_case {
    const char* name;
    glm::uvec3 voxels;
    glm::vec3 sides;    ///< of a voxel, m
    double least, most; ///< radius, voxels along x
    std::uint32_t count;
    float quantum = 0x1p-22f;
    double deepest = 3;       ///< optical depth
    std::uint32_t slices = 0; ///< more than there are: the particles go through in small batches
};

const cloud_case cases[] = {
    {"a usual cloud", {96, 40, 33}, {2, 2, 2}, 1, 6, 900, 0x1p-22f, 0.4},
    {"voxels that are no cubes", {40, 64, 20}, {1.5f, 0.7f, 3.1f}, 0.2, 12, 300},
    {"narrower than a vector", {5, 9, 7}, {1, 1, 1}, 0.1, 4, 100},
    {"as wide as the particles", {24, 30, 30}, {1, 1, 1}, 8, 11, 60},
    {"larger than the volume", {33, 33, 33}, {1, 1, 1}, 20, 70, 20},
    {"smaller than a voxel", {17, 17, 17}, {1, 1, 1}, 0.01, 0.8, 3000},
    {"a quantum that is no power of two", {32, 32, 32}, {1, 1, 1}, 1, 6, 200, 3e-6f},
    {"deep ones", {32, 32, 32}, {1, 1, 1}, 1, 6, 50, 0x1p-18f, 60},
    {"many for many threads", {48, 48, 48}, {1, 1, 1}, 0.5, 2, 20'000},
    {"many batches", {48, 16, 16}, {1, 1, 1}, 0.5, 2, 1500, 0x1p-22f, 3, 1u << 22},
};

/// Turned against the world, with its middle in the middle of the volume.
light_grid grid_of(const cloud_case& c) {
    const glm::vec3 axes[] = {{0.8f, 0, -0.6f}, {0.36f, 0.8f, 0.48f}, {0.48f, -0.6f, 0.64f}};
    light_grid grid;
    grid.anchor = {3, -4, 5, 0};
    glm::vec4* const rows[] = {&grid.row_x, &grid.row_y, &grid.row_z};
    for (int a = 0; a < 3; ++a) {
        *rows[a] = glm::vec4(axes[a] / c.sides[a], 0.5f * static_cast<float>(c.voxels[a]));
    }
    grid.voxel = glm::vec4(c.sides, c.quantum);
    return grid;
}

/// Some of them beyond the sides.
std::vector<cloud_particle> particles_of(const cloud_case& c) {
    support::random_source random(17);
    const light_grid grid = grid_of(c);
    std::vector<cloud_particle> all(c.count);
    for (cloud_particle& p : all) {
        const glm::vec3 cells(random.between(-2, c.voxels.x + 2),
                              random.between(-2, c.voxels.y + 2),
                              random.between(-2, c.voxels.z + 2));
        p.position = shared::place_of(grid, cells);
        p.radius = static_cast<float>(random.between(c.least, c.most)) * c.sides.x;
        p.optical_depth = static_cast<float>(random.between(0, c.deepest));
        p.albedo = static_cast<float>(random.between(0, 1));
    }
    all[0].radius = 0;
    all[1].optical_depth = 0;
    all[2].position = {1e6f, 1e6f, 1e6f};
    all[3].position = shared::place_of(grid, glm::vec3(c.voxels) * 0.5f); // symmetrical: d² = r²
    all[3].radius = 3 * c.sides.x;
    return all;
}

/// What the kernel's own functions add.
template <class K>
std::vector<std::int32_t> plain_sums(const K& kernel, const std::vector<cloud_particle>& particles,
                                     glm::uvec3 voxels) {
    std::vector<std::int32_t> sums(std::size_t{voxels.x} * voxels.y * voxels.z);
    const std::span<const cloud_particle> span(particles);
    for (std::uint32_t i = 0; i < particles.size(); ++i) {
        for (std::uint32_t s = 0; s < kernel.slab_count(i, span); ++s) {
            const std::int64_t z = kernel.slab(i, s, span).slice;
            if (z >= 0 && z < voxels.z) {
                cpu::plain_program<K>::add_slab(
                    kernel, i, s,
                    {sums.data() + z * voxels.x * voxels.y, voxels.x, voxels.y, voxels.x}, span);
            }
        }
    }
    return sums;
}

template <class K>
void expect_plain_bits() {
    static_assert(requires { typename cpu::program<K>::bins; });
    for (const cloud_case& c : cases) {
        const auto particles = particles_of(c);
        cpu::device_options options;
        options.threads = 2;
        device d(options);
        const auto buffer = expect_value(make_buffer<device, cloud_particle>(d, particles));
        volume_description what{c.voxels.x, c.voxels.y, c.voxels.z, volume_format::int32};
        const auto sums = expect_value(d.create_volume(what));
        what.format = volume_format::float32;
        const auto apart = expect_value(d.create_volume(what));
        const auto fused = expect_value(d.create_volume(what));
        K kernel;
        kernel.shade.grid = grid_of(c);
        kernel.shade.slices = std::max(
            c.slices, static_cast<std::uint32_t>(2 * c.most * double(c.sides.x / c.sides.z)) + 8);
        for (kernel.shade.light = 0; kernel.shade.light < 3; ++kernel.shade.light) {
            for (kernel.shade.profile = 0; kernel.shade.profile < 2; ++kernel.shade.profile) {
                kernel.shade.forward = kernel.shade.light == 2 ? 1.7f : 0.7f; // G > 1 as well
                kernel.shade.sigmas = kernel.shade.light == 1 ? 2.5f : 3.0f;
                const auto expected = plain_sums(kernel, particles, c.voxels);
                const volume_scan how{scan_axis::y, scan_direction::descending, scan_share::whole,
                                      c.quantum};
                ASSERT_TRUE(run(d, [&](auto& r) {
                    r.accumulate(kernel, {view<device>(buffer)}, range{0, c.count},
                                 {&sums, true, {}, {}});
                    r.scan(sums, apart, how);
                    r.accumulate_scan(kernel, {view<device>(buffer)}, range{0, c.count}, sums,
                                      fused, how);
                }));
                EXPECT_EQ(std::memcmp(sums.data(), expected.data(), sums.size_bytes()), 0)
                    << c.name << ", light " << kernel.shade.light << ", profile "
                    << kernel.shade.profile;
                EXPECT_EQ(std::memcmp(apart.data(), fused.data(), apart.size_bytes()), 0) << c.name;
                EXPECT_NE(std::count(expected.begin(), expected.end(), 0),
                          static_cast<std::ptrdiff_t>(expected.size()));
            }
        }
    }
}

} // namespace

TEST(particle_layers, impulses_have_the_plain_kernels_bits) {
    expect_plain_bits<kernels::particle_impulse>();
}

TEST(particle_layers, shadow_slabs_have_the_plain_kernels_bits) {
    expect_plain_bits<kernels::shadow_slab>();
}

// Rounding widens the chord of such a particle beyond what a row has room for; the address
// sanitizer sees what is read and written there.
TEST(particle_layers, almost_as_wide_as_a_row) {
    cpu::device_options options;
    options.threads = 1; // no other's memory lies in front of a layer's
    device d(options);
    const glm::uvec3 voxels(131, 3, 131);
    kernels::particle_impulse kernel;
    kernel.shade.slices = 131;
    kernel.shade.profile = 1; // through all rows, the lowest among them
    kernel.shade.grid.row_x = {1, 0, 0, 0};
    kernel.shade.grid.row_y = {0, 1, 0, 0};
    kernel.shade.grid.row_z = {0, 0, 1, 0};
    kernel.shade.grid.voxel = {1, 1, 1, 0x1p-22f};
    const auto sums = expect_value(d.create_volume({131, 3, 131, volume_format::int32}));
    const auto scanned = expect_value(d.create_volume({131, 3, 131, volume_format::float32}));
    for (int i = 0; i <= 20; ++i) {
        cloud_particle p;
        p.position = {65.49001f + 0.001f * static_cast<float>(2 * i), 1.5f, 65.5f};
        p.radius = 64;
        p.optical_depth = 3;
        const std::vector<cloud_particle> one{p};
        const auto buffer = expect_value(make_buffer<device, cloud_particle>(d, one));
        ASSERT_TRUE(run(d, [&](auto& r) {
            r.accumulate(kernel, {view<device>(buffer)}, range{0, 1}, {&sums, true, {}, {}});
            r.accumulate_scan(kernel, {view<device>(buffer)}, range{0, 1}, sums, scanned, {});
        }));
        const auto expected = plain_sums(kernel, one, voxels);
        EXPECT_EQ(std::memcmp(sums.data(), expected.data(), sums.size_bytes()), 0) << i;
        EXPECT_GT(*std::max_element(expected.begin(), expected.end()), 0);
    }
}
