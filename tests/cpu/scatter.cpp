// The CPU's own kernels of multiple scattering give the plain kernels' bits.

#include "support/random.hpp"

#include <skybark/cpu/cpu.hpp>

#include <cstring>
#include <gtest/gtest.h>

using namespace skybark;

namespace {

cpu::volume filled(cpu::device& device, glm::uvec3 size, double low, double high,
                   std::uint32_t seed) {
    support::random_source random(seed);
    std::vector<float> values(std::size_t{size.x} * size.y * size.z);
    for (float& v : values) {
        v = static_cast<float>(random.between(low, high));
    }
    auto volume = device.create_volume({size.x, size.y, size.z, volume_format::float32});
    EXPECT_TRUE(volume);
    EXPECT_TRUE(device.upload(*volume, std::as_bytes(std::span<const float>(values))));
    return std::move(*volume);
}

/// All voxels of the targets by both programs.
template <class K>
void expect_plain_bits(cpu::device& device, const K& kernel,
                       const std::array<const cpu::volume*, volumes_of<K>>& read, glm::uvec3 to) {
    const std::size_t count = std::size_t{to.x} * to.y * to.z;
    std::vector<float> found[2][volume_targets_of<K>];
    for (int own = 0; own < 2; ++own) {
        std::vector<cpu::volume> targets;
        for (std::uint32_t t = 0; t < volume_targets_of<K>; ++t) {
            targets.push_back(filled(device, to, 7, 8, 1)); // what was there before
        }
        volume_bindings<cpu::device, K> bound;
        bound.read = read;
        for (std::uint32_t t = 0; t < volume_targets_of<K>; ++t) {
            bound.write[t] = &targets[t];
        }
        const auto grids = cpu::grids::of<cpu::device, K>(bound);
        for (std::uint32_t row = 0; row < to.y * to.z; ++row) {
            const glm::ivec3 first(0, static_cast<int>(row % to.y), static_cast<int>(row / to.y));
            if (own == 1) {
                cpu::program<K>::voxels(kernel, first, to.x, grids);
            } else {
                cpu::plain_program<K>::voxels(kernel, first, to.x, grids);
            }
        }
        for (std::uint32_t t = 0; t < volume_targets_of<K>; ++t) {
            found[own][t].resize(count);
            EXPECT_TRUE(device.download(targets[t],
                                        std::as_writable_bytes(std::span<float>(found[own][t]))));
        }
    }
    for (std::uint32_t t = 0; t < volume_targets_of<K>; ++t) {
        EXPECT_EQ(std::memcmp(found[0][t].data(), found[1][t].data(), count * sizeof(float)), 0)
            << "target " << t << " of " << to.x << " x " << to.y << " x " << to.z;
    }
}

constexpr glm::uvec3 sizes[] = {{4, 3, 2}, {7, 4, 6}, {8, 8, 8}, {16, 12, 10}, {13, 7, 9},
                                {5, 1, 3}, {1, 6, 1}, {2, 2, 2}, {9, 9, 1}};

} // namespace

TEST(scatter, bits_are_the_plain_kernels) {
    cpu::device device;
    for (const glm::uvec3 size : sizes) {
        const glm::uvec3 coarse = (size + 1u) / 2u;
        const auto phi = filled(device, size, 0, 3, 2);
        const auto resistance = filled(device, size, 0.01, 5, 3);
        const auto extinction = filled(device, size, 0, 2, 4);
        const auto source = filled(device, size, -0.5, 2, 5);
        const auto coarse_phi = filled(device, coarse, -1, 1, 6);
        const kernels::scatter_equation equation{glm::vec4(0.3f, 0.7f, 1.1f, 0.2f), 0.1f};
        const std::array<const cpu::volume*, 4> all{&phi, &resistance, &extinction, &source};
        for (const std::uint32_t from_zero : {0u, 1u}) {
            expect_plain_bits(device, kernels::scatter_relax{equation, 1.73f, from_zero, 0.1f}, all,
                              size);
            expect_plain_bits(device, kernels::scatter_prolong{from_zero}, {&phi, &coarse_phi},
                              size);
        }
        expect_plain_bits(device, kernels::scatter_restrict{equation}, all, coarse);
        for (std::uint32_t axes = 0; axes < kernels::all_axes; ++axes) {
            const auto halved = glm::uvec3(kernels::halved_axes(axes, glm::ivec3(size)));
            const glm::uvec3 partly = (size + halved) / (1u + halved);
            const auto partly_phi = filled(device, partly, -1, 1, 8);
            expect_plain_bits(device, kernels::scatter_prolong{0, axes}, {&phi, &partly_phi}, size);
            expect_plain_bits(device, kernels::scatter_restrict{equation, axes}, all, partly);
        }
        for (const double deepest : {3.0, 120.0}) {
            const auto attenuation = filled(device, size, -0.1, deepest, 7);
            expect_plain_bits(device, kernels::scatter_medium{2, 0.7f, 0.3f}, {&attenuation},
                              coarse);
        }
    }
}
