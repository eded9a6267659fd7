// Procedural cumulus clouds: what makes them look like some, counted and measured.

#include <skybark/clouds/cumulus.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <numeric>

using namespace skybark;
using namespace skybark::clouds;
using glm::dvec3;

namespace {

constexpr double pi = 3.14159265358979323846;

bool same(const std::vector<cloud_particle>& a, const std::vector<cloud_particle>& b) {
    return a.size() == b.size() &&
           std::memcmp(a.data(), b.data(), a.size() * sizeof(cloud_particle)) == 0;
}

/// Extinction at a place, 1/m: Gaussians of sigma = radius / 3, ended at 4 sigma.
double extinction_at(const std::vector<cloud_particle>& cloud, dvec3 at) {
    double sum = 0;
    for (const cloud_particle& p : cloud) {
        const double sigma = double{p.radius} / 3;
        const dvec3 d = dvec3(p.position) - at;
        const double d2 = glm::dot(d, d);
        if (d2 < 16 * sigma * sigma) {
            sum += double{p.optical_depth} / (sigma * std::sqrt(2 * pi)) *
                   std::exp(-d2 / (2 * sigma * sigma));
        }
    }
    return sum;
}

/// In m²: extinction over all space.
double water_of(const std::vector<cloud_particle>& cloud) {
    double sum = 0;
    for (const cloud_particle& p : cloud) {
        sum += double{p.optical_depth} * 2 * pi * double{p.radius} * double{p.radius} / 9;
    }
    return sum;
}

struct spread {
    double mean = 0;
    double deviation = 0;
};
spread spread_of(const std::vector<double>& values) {
    spread s;
    const auto n = static_cast<double>(values.size());
    s.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
    for (const double v : values) {
        s.deviation += (v - s.mean) * (v - s.mean) / n;
    }
    s.deviation = std::sqrt(s.deviation);
    return s;
}

TEST(cumulus, as_many_particles_as_asked_within_the_size_asked) {
    for (const std::uint32_t count : {1u, 7u, 500u, 6000u}) {
        cumulus_options options;
        options.particles = count;
        options.base = {100, 700, -50};
        const auto cloud = cumulus_cloud(options);
        ASSERT_EQ(cloud.size(), count);
        for (const cloud_particle& p : cloud) {
            const glm::vec3 d = p.position - options.base;
            EXPECT_GE(d.y, 0);
            EXPECT_LE(d.y, options.thickness);
            // Shreds and puffs may hang over.
            EXPECT_LE(std::hypot(d.x, d.z), 0.8f * options.width);
            EXPECT_GT(p.radius, 0);
            EXPECT_LT(p.radius, options.width);
            EXPECT_GE(p.optical_depth, 0);
            EXPECT_TRUE(std::isfinite(p.optical_depth));
            EXPECT_EQ(p.albedo, 1);
        }
    }
}

TEST(cumulus, a_seed_makes_one_cloud_and_another_seed_another) {
    cumulus_options options;
    options.particles = 800;
    const auto cloud = cumulus_cloud(options);
    EXPECT_TRUE(same(cloud, cumulus_cloud(options)));
    options.seed = 2;
    EXPECT_FALSE(same(cloud, cumulus_cloud(options)));
}

TEST(cumulus, extinction_inside_is_what_is_asked) {
    cumulus_options options;
    options.particles = 4000;
    options.extinction = 0.07f;
    const auto cloud = cumulus_cloud(options);
    std::vector<double> inside;
    for (const cloud_particle& p : cloud) {
        // Half a radius beside the largest ones, which are those in the depth.
        if (p.radius > 120) {
            inside.push_back(
                extinction_at(cloud, dvec3(p.position) + dvec3(0.5 * double{p.radius}, 0, 0)));
        }
    }
    ASSERT_GT(inside.size(), 30u);
    const spread s = spread_of(inside);
    EXPECT_NEAR(s.mean, 0.07, 0.015);
    EXPECT_LT(s.deviation, 0.02) << "smooth";
}

TEST(cumulus, the_water_does_not_depend_on_how_many_share_it) {
    cumulus_options options;
    options.particles = 3000;
    const double few = water_of(cumulus_cloud(options));
    options.particles = 12000;
    const double many = water_of(cumulus_cloud(options));
    // More particles show smaller puffs, which add some.
    EXPECT_NEAR(many / few, 1, 0.1);
    options.extinction *= 2;
    EXPECT_NEAR(water_of(cumulus_cloud(options)) / many, 2, 1e-4);
}

/// Heights where a vertical line enters and leaves the cloud: at a quarter of its extinction.
struct crossing {
    double low = -1;
    double high = -1;
};
crossing cross(const std::vector<cloud_particle>& cloud, const cumulus_options& o, double x,
               double z) {
    std::vector<cloud_particle> near;
    for (const cloud_particle& p : cloud) {
        if (std::hypot(double{p.position.x} - x, double{p.position.z} - z) <
            4.0 / 3 * double{p.radius}) {
            near.push_back(p);
        }
    }
    crossing found;
    for (double y = -60; y < double{o.thickness} + 60; y += 4) {
        if (extinction_at(near, {x, double{o.base.y} + y, z}) > 0.25 * double{o.extinction}) {
            found.low = found.low < -0.5 && found.high < 0 ? y : found.low;
            found.high = y;
        }
    }
    return found;
}

TEST(cumulus, the_base_is_level_and_the_top_is_not) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        cumulus_options options;
        options.seed = seed;
        options.particles = 5000;
        const auto cloud = cumulus_cloud(options);
        std::vector<double> bases;
        std::vector<double> tops;
        for (double x = -450; x <= 450; x += 60) {
            for (double z = -450; z <= 450; z += 60) {
                const crossing c = cross(cloud, options, x, z);
                if (std::hypot(x, z) <= 450 && c.high > 0) {
                    bases.push_back(c.low);
                    tops.push_back(c.high);
                }
            }
        }
        ASSERT_GT(bases.size(), 140u) << "no holes";
        EXPECT_LT(spread_of(bases).deviation, 0.03 * double{options.thickness});
        EXPECT_LT(std::abs(spread_of(bases).mean), 0.04 * double{options.thickness});
        EXPECT_GT(spread_of(tops).deviation, 0.12 * double{options.thickness});
        const double highest = *std::max_element(tops.begin(), tops.end());
        EXPECT_GT(highest, 0.85 * double{options.thickness});
    }
}

TEST(cumulus, more_of_it_is_low_and_in_the_middle) {
    const cumulus_options options;
    const auto cloud = cumulus_cloud(options);
    double water = 0;
    double height = 0;
    double wide[2] = {0, 0};
    double halves[2] = {0, 0};
    for (const cloud_particle& p : cloud) {
        const dvec3 d(p.position - options.base);
        const double w = double{p.optical_depth} * double{p.radius} * double{p.radius};
        const int half = d.y > 0.5 * double{options.thickness} ? 1 : 0;
        water += w;
        height += w * d.y;
        halves[half] += w;
        wide[half] += w * (d.x * d.x + d.z * d.z);
    }
    EXPECT_LT(height / water, 0.42 * double{options.thickness});
    EXPECT_LT(wide[1] / halves[1], 0.5 * wide[0] / halves[0]);
    // A level disc as wide as the cloud has ½ of its half width, squared.
    const double half_width = 0.5 * double{options.width};
    EXPECT_LT(wide[0] / halves[0], 0.45 * half_width * half_width);
}

/// Small ones near the surface, where the eye sees them: of the smallest fifth most have little
/// beyond them on some side, of the largest fifth hardly any.
TEST(cumulus, the_surface_is_made_of_the_smallest) {
    cumulus_options options;
    options.particles = 8000;
    auto cloud = cumulus_cloud(options);
    std::sort(cloud.begin(), cloud.end(),
              [](const auto& a, const auto& b) { return a.radius < b.radius; });
    const auto outer_part = [&](std::size_t first) {
        int outer = 0;
        int all = 0;
        for (std::size_t i = first; i < first + 1600; i += 8) {
            const cloud_particle& p = cloud[i];
            double least = 1e9;
            for (const dvec3& way : {dvec3(1, 0, 0), dvec3(-1, 0, 0), dvec3(0, 1, 0),
                                     dvec3(0, -1, 0), dvec3(0, 0, 1), dvec3(0, 0, -1)}) {
                least = std::min(least, extinction_at(cloud, dvec3(p.position) +
                                                                 way * (0.5 * double{p.radius})));
            }
            outer += least < 0.4 * double{options.extinction} ? 1 : 0;
            ++all;
        }
        return static_cast<double>(outer) / all;
    };
    EXPECT_GT(outer_part(0), 0.5);
    EXPECT_LT(outer_part(6400), 0.1);
}

TEST(cumulus, senseless_sizes_make_no_cloud) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    const auto none = [](auto change) {
        cumulus_options options;
        options.particles = 10;
        change(options);
        return cumulus_cloud(options).empty();
    };
    EXPECT_FALSE(none([](auto&) {}));
    EXPECT_TRUE(none([](auto& o) { o.particles = 0; }));
    for (const float wrong : {0.0f, -5.0f, nan, inf}) {
        EXPECT_TRUE(none([&](auto& o) { o.width = wrong; }));
        EXPECT_TRUE(none([&](auto& o) { o.thickness = wrong; }));
        EXPECT_TRUE(none([&](auto& o) { o.extinction = wrong; }));
        EXPECT_EQ(none([&](auto& o) { o.albedo = wrong; }), !std::isfinite(wrong));
    }
    EXPECT_TRUE(none([&](auto& o) { o.base.x = nan; }));
    cumulus_field_options field;
    field.clouds = 0;
    EXPECT_TRUE(cumulus_field(field).empty());
    field.clouds = 2;
    field.extent = -1;
    EXPECT_TRUE(cumulus_field(field).empty());
}

/// Shapes whose pile would be endless, or that floats do not resolve: none, and at once.
TEST(cumulus, shapes_beyond_the_limits_make_no_cloud) {
    const auto start = std::chrono::steady_clock::now();
    for (const auto& [width, thickness] :
         {std::pair{1e5f, 1.0f}, std::pair{1000.0f, 1e-3f}, std::pair{1e-42f, 1.0f},
          std::pair{1.0f, 1e9f}, std::pair{1e30f, 1e-30f}, std::pair{1e-3f, 1000.0f},
          std::pair{1.0f, 1e5f}, std::pair{1e30f, 1e30f}, std::pair{1e-30f, 1e-30f},
          std::pair{1.0f, 50.1f}, std::pair{50.1f, 1.0f}, std::pair{9e-4f, 9e-4f},
          std::pair{1.1e6f, 1e6f}, std::pair{1e6f, 1.1e6f}}) {
        cumulus_options options;
        options.width = width;
        options.thickness = thickness;
        options.particles = 10;
        EXPECT_TRUE(cumulus_cloud(options).empty()) << width << " x " << thickness;
        cumulus_field_options field;
        field.clouds = 2;
        field.particles_per_cloud = 10;
        field.width = width;
        field.thickness = thickness;
        EXPECT_TRUE(cumulus_field(field).empty()) << width << " x " << thickness;
    }
    cumulus_options dense;
    dense.extinction = 1e30f;
    EXPECT_TRUE(cumulus_cloud(dense).empty());
    cumulus_options many;
    many.particles = most_cumulus_particles + 1;
    EXPECT_TRUE(cumulus_cloud(many).empty());
    cumulus_field_options field;
    field.clouds = 0xffffffffu;
    field.particles_per_cloud = 0xffffffffu;
    EXPECT_TRUE(cumulus_field(field).empty());
    field.clouds = 2;
    field.particles_per_cloud = most_cumulus_particles / 2 + 1;
    EXPECT_TRUE(cumulus_field(field).empty());
    field.clouds = most_cumulus_clouds + 1;
    field.particles_per_cloud = 1;
    EXPECT_TRUE(cumulus_field(field).empty());
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
}

/// At the limits of one cloud, the smaller ones of a field have other shapes.
TEST(cumulus, a_field_of_odd_shapes_has_all_its_particles) {
    for (const auto& [width, thickness] :
         {std::pair{2e-3f, 1e-3f}, std::pair{1e6f, 5e5f}, std::pair{100.0f, 5000.0f}}) {
        cumulus_field_options options;
        options.clouds = 2;
        options.particles_per_cloud = 20;
        options.extent = 4 * width;
        options.width = width;
        options.thickness = thickness;
        EXPECT_EQ(cumulus_field(options).size(), 40u) << width << " x " << thickness;
    }
}

TEST(cumulus, odd_shapes_are_clouds_as_well) {
    for (const auto& [width, thickness] :
         {std::pair{2000.0f, 60.0f}, std::pair{100.0f, 4000.0f}, std::pair{1.0f, 1.0f},
          std::pair{2000.0f, 40.0f}, std::pair{100.0f, 5000.0f}, std::pair{1e-3f, 1e-3f},
          std::pair{1e6f, 1e6f}}) {
        cumulus_options options;
        options.width = width;
        options.thickness = thickness;
        options.particles = 400;
        const auto cloud = cumulus_cloud(options);
        ASSERT_EQ(cloud.size(), 400u);
        for (const cloud_particle& p : cloud) {
            ASSERT_TRUE(std::isfinite(p.optical_depth) && p.radius > 0);
            ASSERT_LE(p.position.y - options.base.y, thickness * 1.0001f);
        }
    }
}

TEST(cumulus, a_field_has_clouds_of_many_sizes_side_by_side) {
    cumulus_field_options options;
    options.clouds = 14;
    options.particles_per_cloud = 300;
    const auto field = cumulus_field(options);
    ASSERT_EQ(field.size(), 14u * 300);
    EXPECT_TRUE(same(field, cumulus_field(options)));
    // The sky over the square that is covered: some, not all.
    int covered = 0;
    int all = 0;
    for (float x = -3900; x < 4000; x += 200) {
        for (float z = -3900; z < 4000; z += 200) {
            ++all;
            covered += std::any_of(field.begin(), field.end(),
                                   [&](const cloud_particle& p) {
                                       return p.optical_depth > 0.05f &&
                                              std::hypot(p.position.x - x, p.position.z - z) <
                                                  0.6f * p.radius;
                                   })
                           ? 1
                           : 0;
        }
    }
    EXPECT_GT(covered, all / 20);
    EXPECT_LT(covered, all / 2);
    for (const cloud_particle& p : field) {
        ASSERT_GE(p.position.y, options.centre.y);
        ASSERT_LE(std::abs(p.position.x), 0.62f * options.extent);
        ASSERT_LE(std::abs(p.position.z), 0.62f * options.extent);
    }
}

} // namespace
