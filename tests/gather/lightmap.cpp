// Lightmaps: charts apart, samples in their places, and what bilinear lookup reads.

#include <skybark/gather/lightmap.hpp>

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

using namespace skybark;
using gather::lightmap;

namespace {

gather_triangle triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    gather_triangle t;
    t.a = a;
    t.b = b;
    t.c = c;
    return t;
}

/// Triangles of all shapes: slivers, some of a millimetre, some of metres.
std::vector<gather_triangle> soup(std::size_t count, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(-1, 1);
    std::uniform_real_distribution<float> size(-3, 0);
    std::vector<gather_triangle> all;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 at(10 * place(random), place(random), 10 * place(random));
        const float s = std::pow(10.0f, size(random));
        const auto corner = [&] {
            return at + s * glm::vec3(place(random), place(random), place(random));
        };
        all.push_back(triangle(corner(), corner(), corner()));
    }
    return all;
}

/// A grid of squares, each of two triangles.
std::vector<gather_triangle> squares(std::uint32_t side) {
    std::vector<gather_triangle> all;
    for (std::uint32_t y = 0; y < side; ++y) {
        for (std::uint32_t x = 0; x < side; ++x) {
            const glm::vec3 p(static_cast<float>(x), 0, static_cast<float>(y));
            all.push_back(triangle(p, p + glm::vec3(0, 0, 1), p + glm::vec3(1, 0, 1)));
            all.push_back(triangle(p, p + glm::vec3(1, 0, 1), p + glm::vec3(1, 0, 0)));
        }
    }
    return all;
}

glm::dvec2 corner(const lightmap& map, std::size_t triangle, std::size_t i) {
    return glm::dvec2(map.corners[3 * triangle + i]) * static_cast<double>(map.size);
}

double area(const gather_triangle& t) {
    return 0.5 * glm::length(glm::cross(glm::dvec3(t.b) - glm::dvec3(t.a),
                                        glm::dvec3(t.c) - glm::dvec3(t.a)));
}

double chart_area(const lightmap& map, std::size_t t) {
    const glm::dvec2 a = corner(map, t, 0);
    const glm::dvec2 b = corner(map, t, 1) - a;
    const glm::dvec2 c = corner(map, t, 2) - a;
    return 0.5 * (b.x * c.y - b.y * c.x);
}

/// Whose texel each is, by its samples and seams; -1: nobody's. Fails where two claim one.
std::vector<int> owners(const lightmap& map) {
    std::vector<int> all(std::size_t{map.size} * map.size, -1);
    for (std::size_t i = 0; i < map.texels.size(); ++i) {
        int& owner = all.at(map.texels[i]);
        EXPECT_EQ(owner, -1) << "texel " << map.texels[i];
        owner = static_cast<int>(map.triangles[i]);
    }
    const std::vector<int> sampled = all;
    for (const glm::uvec2& pair : map.seams) {
        int& owner = all.at(pair.x);
        EXPECT_EQ(owner, -1) << "texel " << pair.x;
        EXPECT_NE(sampled.at(pair.y), -1) << "a seam has the light of a sample";
        owner = sampled.at(pair.y);
    }
    return all;
}

void expect_good(const std::vector<gather_triangle>& triangles, const lightmap& map) {
    const std::vector<int> owner = owners(map);
    // Lookup anywhere on a triangle, corners and edges as well, reads texels of its own chart.
    std::mt19937 random(5);
    std::uniform_real_distribution<float> part(0, 1);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        if (map.corners[3 * t] == map.corners[3 * t + 1]) {
            continue;
        }
        for (int i = 0; i < 24; ++i) {
            glm::vec3 w(part(random), part(random), part(random));
            if (i < 3) {
                w = {i == 0, i == 1, i == 2};
            } else if (i < 12) {
                w[i % 3] = 0;
            }
            w /= w.x + w.y + w.z;
            // In floats, as a renderer interpolates.
            const glm::vec2 uv = w.x * map.corners[3 * t] + w.y * map.corners[3 * t + 1] +
                                 w.z * map.corners[3 * t + 2];
            const glm::vec2 texel = uv * static_cast<float>(map.size) - 0.5f;
            const glm::vec2 low = glm::floor(texel);
            for (int n = 0; n < 4; ++n) {
                const float x = low.x + static_cast<float>(n % 2);
                const float y = low.y + static_cast<float>(n / 2);
                const float weight = (1 - std::abs(texel.x - x)) * (1 - std::abs(texel.y - y));
                if (weight <= 0) {
                    continue;
                }
                ASSERT_GE(x, 0);
                ASSERT_GE(y, 0);
                ASSERT_LT(x, static_cast<float>(map.size));
                ASSERT_LT(y, static_cast<float>(map.size));
                const auto at =
                    static_cast<std::size_t>(y) * map.size + static_cast<std::size_t>(x);
                ASSERT_EQ(owner[at], static_cast<int>(t))
                    << "weight " << weight << " at " << texel.x << ", " << texel.y;
            }
        }
    }
    // Each sample lies where its texel's centre does.
    std::vector<std::size_t> counts(triangles.size());
    for (const std::uint32_t t : map.triangles) {
        ++counts[t];
    }
    for (std::size_t i = 0; i < map.samples.size(); ++i) {
        const std::size_t t = map.triangles[i];
        const gather_triangle& on = triangles[t];
        const glm::dvec3 a(on.a);
        const glm::dvec3 b = glm::dvec3(on.b) - a;
        const glm::dvec3 c = glm::dvec3(on.c) - a;
        const glm::dvec3 normal = glm::normalize(glm::cross(b, c));
        const glm::dvec3 p = glm::dvec3(map.samples[i].position) - a;
        const double reach = glm::length(glm::dvec3(on.a)) + glm::length(b) + glm::length(c);
        ASSERT_NEAR(glm::dot(p, normal), 0, 1e-6 * reach);
        ASSERT_NEAR(glm::distance(glm::dvec3(map.samples[i].normal), normal), 0, 1e-4);
        // Distances in the map are those on the triangle: to its corners, to 1e-3 texels.
        const glm::dvec2 centre(map.texels[i] % map.size + 0.5, map.texels[i] / map.size + 0.5);
        const bool alone = counts[t] == 1;
        const double far = alone ? 1.0 : 2e-3 + 1e-6 * reach * double{map.texels_per_metre};
        const glm::dvec3 corners[3] = {glm::dvec3(0), b, c};
        for (std::size_t k = 0; k < 3; ++k) {
            const double on_triangle = glm::distance(p, corners[k]) * double{map.texels_per_metre};
            ASSERT_NEAR(glm::distance(centre, corner(map, t, k)), on_triangle, far) << i;
        }
    }
}

} // namespace

TEST(lightmap, charts_are_apart_and_hold_what_lookup_reads) {
    const auto triangles = soup(400, 1);
    for (const std::uint32_t size : {64u, 200u, 512u}) {
        const auto map = gather::make_lightmap(triangles, {size});
        ASSERT_TRUE(map) << map.error().message;
        expect_good(triangles, *map);
    }
}

TEST(lightmap, areas_keep_their_proportions) {
    const auto triangles = soup(300, 2);
    const auto map = gather::make_lightmap(triangles, {1024});
    ASSERT_TRUE(map) << map.error().message;
    const double scale = double{map->texels_per_metre} * double{map->texels_per_metre};
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const double expected = area(triangles[t]) * scale;
        // Corners are rounded to 1024 · 2⁻²⁴ texels, over edges of up to 1024 texels.
        EXPECT_NEAR(chart_area(*map, t), expected, 0.1 + 1e-5 * expected);
        EXPECT_GE(chart_area(*map, t), -0.1) << "fronts stay fronts";
    }
    // As many samples as there is area, but for charts about as small as a texel.
    double all = 0;
    for (const auto& t : triangles) {
        all += area(t) * scale;
    }
    EXPECT_NEAR(static_cast<double>(map->samples.size()), all, 0.02 * all + 300);
}

TEST(lightmap, uses_the_room) {
    const auto triangles = squares(16);
    const auto map = gather::make_lightmap(triangles, {1024});
    ASSERT_TRUE(map) << map.error().message;
    expect_good(triangles, *map);
    const double used =
        256.0 * double{map->texels_per_metre} * double{map->texels_per_metre} / (1024.0 * 1024.0);
    EXPECT_GT(used, 0.75) << map->texels_per_metre << " texels a metre";
    RecordProperty("used", std::to_string(used));
}

TEST(lightmap, takes_the_resolution_that_is_asked_for) {
    const auto triangles = squares(4);
    const auto map = gather::make_lightmap(triangles, {256, 20});
    ASSERT_TRUE(map) << map.error().message;
    EXPECT_EQ(map->texels_per_metre, 20.0f);
    expect_good(triangles, *map);
    const auto refused = gather::make_lightmap(triangles, {256, 200});
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("expected 1024"), std::string::npos)
        << refused.error().message;
}

TEST(lightmap, fills_its_seams) {
    const auto triangles = soup(100, 4);
    const auto map = gather::make_lightmap(triangles, {128});
    ASSERT_TRUE(map) << map.error().message;
    const std::vector<int> owner = owners(*map);
    std::vector<int> image(owner.size(), -1);
    for (std::size_t i = 0; i < map->texels.size(); ++i) {
        image[map->texels[i]] = static_cast<int>(map->triangles[i]);
    }
    gather::dilate(*map, std::span(image));
    EXPECT_EQ(image, owner);
}

// A linear function on the surface comes back to within what a seam's constant does.
TEST(lightmap, shows_what_is_put_in) {
    const auto triangles = squares(2);
    const auto map = gather::make_lightmap(triangles, {256});
    ASSERT_TRUE(map) << map.error().message;
    std::vector<float> image(std::size_t{256} * 256, 1e9f);
    for (std::size_t i = 0; i < map->texels.size(); ++i) {
        image[map->texels[i]] = map->samples[i].position.x;
    }
    gather::dilate(*map, std::span(image));
    const double texel = 1 / double{map->texels_per_metre};
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (const glm::vec3 w : {glm::vec3(1, 0, 0), glm::vec3(0.2f, 0.3f, 0.5f),
                                  glm::vec3(0.5f, 0.5f, 0), glm::vec3(0.9f, 0.05f, 0.05f)}) {
            const glm::vec2 uv = w.x * map->corners[3 * t] + w.y * map->corners[3 * t + 1] +
                                 w.z * map->corners[3 * t + 2];
            const glm::vec2 at = uv * 256.0f - 0.5f;
            const glm::vec2 low = glm::floor(at);
            const glm::vec2 part = at - low;
            const auto read = [&](int x, int y) {
                const auto column = static_cast<std::size_t>(low.x) + static_cast<std::size_t>(x);
                const auto row = static_cast<std::size_t>(low.y) + static_cast<std::size_t>(y);
                const float weight =
                    (x == 1 ? part.x : 1 - part.x) * (y == 1 ? part.y : 1 - part.y);
                return weight > 0 ? weight * image.at(row * 256 + column) : 0.0f;
            };
            const float seen = read(0, 0) + read(1, 0) + read(0, 1) + read(1, 1);
            const gather_triangle& g = triangles[t];
            const float expected = w.x * g.a.x + w.y * g.b.x + w.z * g.c.x;
            EXPECT_NEAR(seen, expected, 2 * texel);
        }
    }
}

TEST(lightmap, leaves_out_what_has_no_area) {
    std::vector<gather_triangle> triangles = squares(1);
    triangles.push_back(triangle(glm::vec3(1), glm::vec3(1), glm::vec3(1)));
    triangles.push_back(triangle(glm::vec3(0), glm::vec3(1), glm::vec3(2)));
    const auto map = gather::make_lightmap(triangles, {32});
    ASSERT_TRUE(map) << map.error().message;
    ASSERT_EQ(map->corners.size(), 12u);
    expect_good(triangles, *map);
    for (const std::uint32_t t : map->triangles) {
        EXPECT_LT(t, 2u);
    }
    EXPECT_EQ(map->corners[6], glm::vec2(0));
}

TEST(lightmap, says_what_does_not_fit) {
    const auto complaint = [](const std::vector<gather_triangle>& triangles,
                              gather::lightmap_options options) {
        const auto map = gather::make_lightmap(triangles, options);
        return map ? std::string() : map.error().message;
    };
    EXPECT_NE(complaint(soup(400, 1), {16}).find("400 triangles don't fit in a lightmap of 16"),
              std::string::npos);
    EXPECT_NE(complaint(soup(400, 1), {16}).find("expected 64"), std::string::npos)
        << complaint(soup(400, 1), {16});
    EXPECT_NE(complaint({}, {16}).find("None of 0"), std::string::npos);
    EXPECT_NE(complaint({triangle({}, {}, {})}, {16}).find("None of 1"), std::string::npos);
    EXPECT_NE(complaint(squares(1), {0}).find("expected 1 to 32768"), std::string::npos);
    EXPECT_NE(complaint(squares(1), {40000}).find("40000"), std::string::npos);
    const std::string many = complaint(squares(1), {1024, 0, 1000});
    EXPECT_NE(many.find("asks for light at about"), std::string::npos) << many;
    EXPECT_NE(many.find("at most 1000"), std::string::npos) << many;
    auto broken = squares(1);
    broken[1].b.x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(complaint(broken, {16}).find("Triangle 1"), std::string::npos);
}

TEST(lightmap, holds_one_triangle) {
    const std::vector<gather_triangle> one{triangle({0, 0, 0}, {100, 0, 0}, {0, 100, 0})};
    for (const std::uint32_t size : {2u, 3u, 8u, 100u}) {
        const auto map = gather::make_lightmap(one, {size});
        ASSERT_TRUE(map) << map.error().message;
        EXPECT_GE(map->samples.size(), 1u);
        expect_good(one, *map);
    }
}
