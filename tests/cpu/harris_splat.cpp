// Harris's splat as the CPU backend runs it has the bits of the kernel's own function.
#include <skybark/cpu/cpu.hpp>

#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace {

using namespace skybark;

TEST(harris_splat, has_the_kernels_bits) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(-1, 1);
    kernels::harris_splat splat;
    splat.grid.row_x = {4, 0.3f, 0.1f, 20};
    splat.grid.row_z = {-0.2f, 0.1f, 5, 15};
    splat.grid.voxel = {0.25f, 0.3f, 0.2f, 1};
    splat.columns = 40;
    splat.rows = 30;
    splat.forward = 0.3f;
    splat.incoming = 0.7f;
    const std::uint32_t order = 0;
    for (int i = 0; i < 500; ++i) {
        cloud_particle p;
        p.position = {6 * unit(random), unit(random), 4 * unit(random)}; // over the borders, too
        p.radius = 1.2f + unit(random);
        p.optical_depth = 2 + 2 * unit(random);
        p.albedo = 0.9f;
        splat.sigmas = 2.5f + unit(random);
        splat.side = static_cast<std::uint32_t>(2 * p.radius / 0.2f) + 2;
        std::vector<float> before(40 * 30);
        for (float& light : before) {
            light = 0.5f + 0.5f * unit(random);
        }
        std::vector<float> fast = before;
        std::vector<float> plain = before;
        const range all{0, splat.side * splat.side};
        const std::span particles(&p, 1);
        const std::span<const std::uint32_t> first(&order, 1);
        cpu::program<kernels::harris_splat>::map(splat, all, particles, first,
                                                 std::span<const float>(fast), std::span(fast));
        cpu::plain_program<kernels::harris_splat>::map(
            splat, all, particles, first, std::span<const float>(plain), std::span(plain));
        ASSERT_EQ(fast, plain) << i;
    }
}

} // namespace
