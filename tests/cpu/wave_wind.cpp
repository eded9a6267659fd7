// The CPU's own wave_wind gives the plain kernel's bits.

#include "support/random.hpp"

#include <skybark/cpu/cpu.hpp>

#include <cstring>
#include <gtest/gtest.h>

using namespace skybark;

namespace {

struct scene {
    std::vector<glm::vec4> places;
    std::vector<shared::wind_waves> waves;
    std::vector<glm::vec4> phases;
};

scene random_scene(double most_place, double most_wave) {
    support::random_source random(77);
    const auto four = [&](double most) {
        return glm::vec4(random.between(-most, most), random.between(-most, most),
                         random.between(-most, most), random.between(-most, most));
    };
    scene s;
    for (int i = 0; i < 1000; ++i) {
        s.places.push_back(four(most_place));
    }
    for (int i = 0; i < 11; ++i) {
        s.waves.push_back(
            {four(most_wave), four(most_wave), four(most_wave), four(1), four(1), four(1)});
        s.phases.push_back(four(1));
    }
    return s;
}

void expect_plain_bits(const scene& s) {
    const kernels::wave_wind kernel{glm::vec4(1, 2, 3, 0), 11};
    std::vector<glm::vec4> plain(s.places.size()), own(s.places.size());
    using spans = std::tuple<std::span<const glm::vec4>, std::span<const shared::wind_waves>,
                             std::span<const glm::vec4>>;
    const spans in(s.places, s.waves, s.phases);
    cpu::plain_program<kernels::wave_wind>::map(kernel, range{3, 990}, std::get<0>(in),
                                                std::get<1>(in), std::get<2>(in),
                                                std::span<glm::vec4>(plain));
    cpu::program<kernels::wave_wind>::map(kernel, range{3, 990}, std::get<0>(in), std::get<1>(in),
                                          std::get<2>(in), std::span<glm::vec4>(own));
    EXPECT_EQ(std::memcmp(plain.data(), own.data(), plain.size() * sizeof(glm::vec4)), 0);
    EXPECT_NE(own[3], glm::vec4(0));
}

} // namespace

TEST(wave_wind, bits_are_the_plain_kernels) { expect_plain_bits(random_scene(100, 3)); }

TEST(wave_wind, bits_are_the_plain_kernels_far_away) {
    expect_plain_bits(random_scene(1e6, 200)); // past 2^23 cycles
    expect_plain_bits(random_scene(1e6, 1e6)); // past 2^31
}
