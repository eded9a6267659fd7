// The CPU backend's gather_light and directional_light: the bits of the kernels' own functions.

#include "support/cpu_work.hpp"

#include <cstring>
#include <gtest/gtest.h>

using namespace skybark;
using support::expect_value;
using support::random_source;

namespace {

using device = cpu::device;

/// Hits on triangles with a few patches on both sides, on one, or on none.
struct lit_scene {
    std::vector<gather_sample> samples;
    std::vector<gather_hit> hits;
    std::vector<patch_table> tables;
    std::vector<glm::vec4> radiance;
    std::vector<glm::vec4> sums;    ///< twice as many
    std::vector<glm::vec4> moments; ///< three a sample
};

lit_scene make_scene(std::uint32_t triangles, std::uint32_t samples) {
    random_source random(41);
    const auto vector = [&] {
        return glm::vec4(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1),
                         random.between(-1, 1));
    };
    lit_scene s;
    for (std::uint32_t i = 0; i < triangles; ++i) {
        patch_table t;
        t.rows = 1 + random.below(3);
        const std::uint32_t patches = t.rows * t.rows;
        t.front = static_cast<std::uint32_t>(s.radiance.size());
        t.back = i % 3 == 0 ? no_surface : t.front + patches;
        for (std::uint32_t k = 0; k < 2 * patches; ++k) {
            s.radiance.push_back(vector());
        }
        s.tables.push_back(t);
    }
    for (std::uint32_t i = 0; i < samples; ++i) {
        gather_sample at;
        at.normal = glm::vec3(random.direction());
        s.samples.push_back(at);
        gather_hit hit;
        if (random.below(3) != 0) {
            hit.surface = random.below(2 * triangles);
            hit.u = static_cast<float>(random.between(0, 1));
            hit.v = 1 - hit.u;
        }
        s.hits.push_back(hit);
        for (int k = 0; k < 3; ++k) {
            s.moments.push_back(vector());
        }
        s.sums.push_back(vector());
        s.sums.push_back(vector());
    }
    return s;
}

template <class T>
cpu::buffer put(device& d, const std::vector<T>& records) {
    return expect_value(make_buffer<device, T>(d, records));
}

bool same_bits(const cpu::buffer& buffer, const std::vector<glm::vec4>& expected) {
    return buffer.size_bytes() == expected.size() * sizeof(glm::vec4) &&
           std::memcmp(buffer.data(), expected.data(), buffer.size_bytes()) == 0;
}

TEST(gather_light, has_the_kernels_bits) {
    // Tables small enough to be taken as they are, and larger ones; whole hundreds and not.
    for (const std::uint32_t triangles : {5u, 40'000u}) {
        for (const std::uint32_t count : {1u, 256u, 5000u}) {
            lit_scene s = make_scene(triangles, count);
            cpu::device_options options;
            options.threads = 2;
            device d(options);
            const auto samples = put(d, s.samples);
            const auto hits = put(d, s.hits);
            const auto tables = put(d, s.tables);
            const auto radiance = put(d, s.radiance);
            const auto sums = put(d, s.sums);
            const auto moments = put(d, s.moments);
            const auto all = [](const cpu::buffer& b) { return view<device>(b); };
            kernels::gather_light light;
            light.direction = {0.6f, 0, 0.8f, 0};
            light.sky_along = {1, 2, 3, 0};
            light.sky_against = {4, 5, 6, 0};
            light.first = count / 2;
            kernels::directional_light directional;
            directional.direction = {0, 0.8f, 0.6f, 0};
            directional.sky_along = {0.1f, 0.2f, 0.3f, 0};
            ASSERT_TRUE(run(d, [&](auto& r) {
                r.map(light,
                      {all(samples), all(hits), all(tables), all(radiance), all(sums), all(sums)},
                      range{0, count});
                r.map(directional,
                      {all(samples), all(hits), all(tables), all(radiance), all(sums), all(sums),
                       all(moments), all(moments)},
                      range{0, count});
            }));
            for (std::uint32_t i = 0; i < count; ++i) {
                light.map(i, s.samples, s.hits, s.tables, s.radiance, s.sums, s.sums);
            }
            for (std::uint32_t i = 0; i < count; ++i) {
                directional.map(i, s.samples, s.hits, s.tables, s.radiance, s.sums, s.sums,
                                s.moments, s.moments);
            }
            EXPECT_TRUE(same_bits(sums, s.sums)) << triangles << ' ' << count;
            EXPECT_TRUE(same_bits(moments, s.moments)) << triangles << ' ' << count;
        }
    }
}

} // namespace
