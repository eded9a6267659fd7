// The kernels of gathered light, alone: what they add up, and what their sums say.

#include <skybark/kernels/directional_light.hpp>
#include <skybark/kernels/gather_light.hpp>
#include <skybark/kernels/gather_sun.hpp>
#include <skybark/kernels/gathered_harmonics.hpp>
#include <skybark/kernels/gathered_irradiance.hpp>
#include <skybark/kernels/patch_samples.hpp>
#include <skybark/kernels/surface_light.hpp>
#include <skybark/kernels/surface_triangles.hpp>

#include "support/random.hpp"

#include <array>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

using namespace skybark;
using glm::dvec3;
using glm::vec2;
using glm::vec3;
using glm::vec4;

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

gather_sample looking(vec3 normal, vec3 position = vec3(0)) {
    gather_sample made;
    made.position = position;
    made.normal = normal;
    return made;
}

gather_hit hit_of(std::uint32_t surface, float u = 0.2f, float v = 0.3f) {
    gather_hit made;
    made.distance = 1;
    made.surface = surface;
    made.u = u;
    made.v = v;
    return made;
}

/// Two triangles: the first of four patches in front (0…3) and one side, the second of one patch a
/// side (4 and 5).
const std::array<patch_table, 2> tables{patch_table{0, no_surface, 2, 0}, patch_table{4, 5, 1, 0}};
const std::array<vec4, 6> radiance{vec4(1, 0, 0, 0), vec4(2, 0, 0, 0), vec4(3, 0, 0, 0),
                                   vec4(4, 0, 0, 0), vec4(0, 5, 0, 0), vec4(0, 0, 6, 0)};

/// What a sample of this normal adds where it has met this.
template <class Kernel = kernels::gather_light>
vec4 added(const gather_sample& at, const gather_hit& hit, vec4 before = vec4(0)) {
    Kernel kernel;
    kernel.direction = vec4(0, 0.6f, 0.8f, 0);
    kernel.sky_along = vec4(7, 7, 7, 0);
    kernel.sky_against = vec4(9, 9, 9, 0);
    kernel.first = 1;
    const std::array<gather_sample, 1> samples{at};
    const std::array<gather_hit, 1> hits{hit};
    std::array<vec4, 3> sums{vec4(-1), before, vec4(-1)};
    kernel.map(0, samples, hits, tables, radiance, sums, sums);
    EXPECT_EQ(sums[0], vec4(-1));
    EXPECT_EQ(sums[2], vec4(-1));
    return sums[1];
}

} // namespace

TEST(gather_light, adds_what_is_seen_by_the_cosine) {
    const auto front = looking(vec3(0, 0, 1));
    const float c = 0.8f;
    EXPECT_EQ(added(front, hit_of(2)), vec4(0, 5 * c, 0, c));
    EXPECT_EQ(added(front, hit_of(3)), vec4(0, 0, 6 * c, c));
    EXPECT_EQ(added(front, hit_of(1)), vec4(0, 0, 0, c)); // a back that is black
    EXPECT_EQ(added(front, hit_of(2), vec4(1, 2, 3, 4)), vec4(1, 2 + 5 * c, 3, 4 + c));
}

TEST(gather_light, finds_the_patch) {
    const auto front = looking(vec3(0, 0, 1));
    // Two rows: along ab first the lower ones with the upper one between, then the one at c.
    EXPECT_NEAR(added(front, hit_of(0, 0.1f, 0.1f)).x / 0.8f, 1, 1e-6);
    EXPECT_NEAR(added(front, hit_of(0, 0.4f, 0.4f)).x / 0.8f, 2, 1e-6);
    EXPECT_NEAR(added(front, hit_of(0, 0.8f, 0.1f)).x / 0.8f, 3, 1e-6);
    EXPECT_NEAR(added(front, hit_of(0, 0.1f, 0.8f)).x / 0.8f, 4, 1e-6);
}

TEST(gather_light, sees_the_sky_of_its_side) {
    const gather_hit nothing;
    EXPECT_EQ(added(looking(vec3(0, 0, 1)), nothing), vec4(7 * 0.8f, 7 * 0.8f, 7 * 0.8f, 0.8f));
    EXPECT_EQ(added(looking(vec3(0, 0, -1)), nothing), vec4(9 * 0.8f, 9 * 0.8f, 9 * 0.8f, 0.8f));
    EXPECT_EQ(added(looking(vec3(1, 0, 0)), nothing), vec4(0));
}

TEST(gather_light, adds_nothing_for_what_is_no_number) {
    const gather_hit nothing;
    const vec4 before(1, 2, 3, 4);
    EXPECT_EQ(added(looking(vec3(not_a_number, 0, 1)), nothing, before), before);
    EXPECT_EQ(added(looking(vec3(0, 0, 1), vec3(0, not_a_number, 0)), nothing, before), before);
    EXPECT_EQ(added(looking(vec3(0, 0, 1), vec3(0, 0, 3e38f)), nothing, before), before);
    EXPECT_EQ(added(looking(vec3(0)), nothing, before), before);
}

TEST(directional_light, adds_moments_as_well) {
    kernels::directional_light kernel;
    kernel.direction = vec4(0, 0.6f, 0.8f, 0);
    kernel.sky_against = vec4(1, 2, 4, 0);
    const std::array<gather_sample, 2> samples{looking(vec3(0, 0, -1)), looking(vec3(0))};
    const std::array<gather_hit, 2> hits{};
    std::array<vec4, 2> sums{vec4(0), vec4(0)};
    std::array<vec4, 6> moments{vec4(1), vec4(0), vec4(0), vec4(0), vec4(0), vec4(0)};
    for (std::uint32_t i = 0; i < 2; ++i) {
        kernel.map(i, samples, hits, tables, radiance, sums, sums, moments, moments);
    }
    EXPECT_EQ(sums[0], vec4(0.8f, 1.6f, 3.2f, 0.8f));
    EXPECT_EQ(moments[0], vec4(1 + 1, 1, 1 - 0.6f, 1 - 0.8f)); // it looks against the direction
    EXPECT_EQ(moments[1], vec4(2, 0, -1.2f, -1.6f));
    EXPECT_EQ(moments[2], vec4(4, 0, -2.4f, -3.2f));
    EXPECT_EQ(sums[1], vec4(0)); // no normal
    EXPECT_EQ(moments[3], vec4(0));
}

TEST(gather_sun, lights_what_faces_it_and_sees_it) {
    const kernels::gather_sun sun{vec4(0, 0.6f, 0.8f, 0), vec4(10, 20, 30, 0), 0};
    const std::array<gather_sample, 5> samples{
        looking(vec3(0, 0, 1)), looking(vec3(0, 0, -1)), looking(vec3(0, 0, 1)),
        looking(vec3(0, not_a_number, 1)), looking(vec3(0, 0, 1), vec3(not_a_number))};
    std::array<gather_hit, 5> hits{};
    hits[2] = hit_of(0);
    std::array<vec4, 5> direct{};
    direct[0] = vec4(1, 1, 1, 0);
    for (std::uint32_t i = 0; i < 5; ++i) {
        sun.map(i, samples, hits, direct, direct, direct);
    }
    EXPECT_EQ(direct[0], vec4(1, 1, 1, 0) + vec4(10, 20, 30, 0) * 0.8f);
    for (std::size_t i = 1; i < 5; ++i) {
        EXPECT_EQ(direct[i], vec4(0)) << i;
    }
}

TEST(gather_sun, adds_the_part_that_arrives) {
    const kernels::gather_sun sun{vec4(0, 0.6f, 0.8f, 0), vec4(10, 20, 30, 0), 1};
    const std::array<gather_sample, 3> samples{looking(vec3(0, 0, 1)), looking(vec3(0, 0, 1)),
                                               looking(vec3(0, 0, -1))};
    const std::array<gather_hit, 3> hits{};
    const std::array<vec4, 3> arriving{vec4(9, 0.25f, 9, 9), vec4(9, 0, 9, 9), vec4(9, 1, 9, 9)};
    std::array<vec4, 3> direct{};
    for (std::uint32_t i = 0; i < 3; ++i) {
        sun.map(i, samples, hits, arriving, direct, direct);
    }
    EXPECT_EQ(direct[0], vec4(10, 20, 30, 0) * 0.2f);
    EXPECT_EQ(direct[1], vec4(0));
    EXPECT_EQ(direct[2], vec4(0));
}

/// Y_0 = 1/2 √(1/π) and √(3/4π) times y, z, x, in double precision; three colours of two samples.
TEST(gathered_harmonics, are_the_moments_by_the_solid_angle) {
    std::vector<vec4> moments;
    for (int i = 0; i < 6; ++i) {
        const auto at = static_cast<float>(i);
        moments.emplace_back(1 + at, 2 - at, 0.5f * at, -at);
    }
    std::vector<vec4> found(6);
    for (std::uint32_t i = 0; i < 2; ++i) {
        kernels::gathered_harmonics{0.25f}.map(i, moments, found);
    }
    const double y0 = std::sqrt(1 / (4 * pi));
    const double y1 = std::sqrt(3 / (4 * pi));
    for (std::size_t i = 0; i < 6; ++i) {
        const glm::dvec4 m(moments[i]);
        const glm::dvec4 expected = 0.25 * glm::dvec4(y0 * m.x, y1 * m.z, y1 * m.w, y1 * m.y);
        EXPECT_LT(length(glm::dvec4(found[i]) - expected), 1e-6 * length(expected)) << i;
    }
}

/// E = π ΣL c / Σc, and the ratio estimator's standard error, in double precision.
TEST(gathered_irradiance, is_the_ratio_and_its_error) {
    support::random_source random(4);
    constexpr std::uint32_t samples = 3;
    std::vector<vec4> sums;
    for (std::uint32_t i = 0; i < 8 * samples; ++i) {
        const double c = random.between(5, 6);
        sums.emplace_back(c * random.between(1, 2), c * random.between(0, 1),
                          c * random.between(3, 4), c);
    }
    const std::vector<vec4> direct{vec4(0), vec4(1, 2, 3, 0), vec4(0)};
    std::vector<vec4> found(samples);
    for (std::uint32_t i = 0; i < samples; ++i) {
        kernels::gathered_irradiance{samples, 8}.map(i, sums, direct, found);
        dvec3 light(0);
        double weight = 0;
        for (std::uint32_t j = 0; j < 8; ++j) {
            light += dvec3(sums[j * samples + i]);
            weight += static_cast<double>(sums[j * samples + i].w);
        }
        const dvec3 expected = pi * light / weight + dvec3(direct[i]);
        EXPECT_LT(length(dvec3(found[i]) - expected), 2e-6 * length(expected));
        const dvec3 shares(0.2126, 0.7152, 0.0722);
        double squares = 0;
        for (std::uint32_t j = 0; j < 8; ++j) {
            const vec4& s = sums[j * samples + i];
            const double off = dot(dvec3(s), shares) * pi -
                               pi * dot(light, shares) / weight * static_cast<double>(s.w);
            squares += off * off;
        }
        EXPECT_NEAR(found[i].w, std::sqrt(8.0 / 7 * squares) / weight, 1e-5);
    }
}

TEST(gathered_irradiance, is_the_direct_light_where_nothing_was_gathered) {
    const std::vector<vec4> sums(8);
    const std::vector<vec4> direct{vec4(1, 2, 3, 0)};
    std::vector<vec4> found(1);
    kernels::gathered_irradiance{1, 8}.map(0, sums, direct, found);
    EXPECT_EQ(found[0], vec4(1, 2, 3, 1e30f));
}

/// Patches' middles lie in their own patch, cover the triangle evenly (their mean is its middle),
/// and both sides have them.
TEST(patch_samples, are_the_middles_of_patches) {
    gather_triangle t;
    t.a = vec3(1, 0, 0);
    t.b = vec3(3, 0, 1);
    t.c = vec3(1, 2, 0);
    const std::array<gather_triangle, 1> triangles{t};
    for (const std::uint32_t rows : {1u, 2u, 3u, 7u, 64u}) {
        const std::uint32_t count = rows * rows;
        const std::array<patch_table, 1> table{patch_table{0, count, rows, 0}};
        std::vector<std::uint32_t> owners(2 * count, 0);
        std::fill(owners.begin() + count, owners.end(), 1u);
        std::vector<gather_sample> samples(2 * count);
        dvec3 mean(0);
        const dvec3 normal = normalize(cross(dvec3(t.b - t.a), dvec3(t.c - t.a)));
        for (std::uint32_t i = 0; i < 2 * count; ++i) {
            kernels::patch_samples{}.map(i, owners, table, triangles, samples);
            const double side = i < count ? 1 : -1;
            EXPECT_LT(length(dvec3(samples[i].normal) - side * normal), 1e-6);
            // From the place back to weights.
            const dvec3 from = dvec3(samples[i].position) - dvec3(t.a);
            const dvec3 ab(t.b - t.a);
            const dvec3 ac(t.c - t.a);
            const double area = dot(cross(ab, ac), normal);
            const double u = dot(cross(from, ac), normal) / area;
            const double v = dot(cross(ab, from), normal) / area;
            EXPECT_EQ(shared::patch_at(rows, static_cast<float>(u), static_cast<float>(v)),
                      i % count);
            mean += dvec3(samples[i].position) / (2.0 * count);
        }
        EXPECT_LT(length(mean - (dvec3(t.a) + dvec3(t.b) + dvec3(t.c)) / 3.0), 1e-5) << rows;
    }
}

TEST(patch_samples, of_a_triangle_without_an_area_have_no_normal) {
    gather_triangle t;
    t.a = t.b = t.c = vec3(1);
    const std::array<gather_triangle, 1> triangles{t};
    const std::array<patch_table, 1> table{patch_table{0, no_surface, 1, 0}};
    const std::array<std::uint32_t, 1> owners{0};
    std::array<gather_sample, 1> samples{looking(vec3(1))};
    kernels::patch_samples{}.map(0, owners, table, triangles, samples);
    EXPECT_EQ(samples[0].normal, vec3(0));
}

/// emission + (diffuse · here + transmission · behind) / π, on both sides of a leaf.
TEST(surface_light, is_emitted_reflected_and_let_through) {
    gather_material leaf;
    leaf.diffuse = vec3(0.25f, 0.5f, 0.125f);
    leaf.emission = vec3(1, 2, 3);
    leaf.transmission = vec3(0.5f, 0.25f, 0);
    leaf.two_sided = 1;
    gather_material wall = leaf;
    wall.two_sided = 0;
    const std::array<gather_material, 2> materials{leaf, wall};
    std::array<gather_triangle, 2> triangles{};
    triangles[1].material = 1;
    // Four patches a side of the leaf: 0…3, 5…8; the wall's one is 4.
    const std::array<patch_table, 2> table{patch_table{0, 5, 2, 0},
                                           patch_table{4, no_surface, 1, 0}};
    const std::array<std::uint32_t, 9> owners{0, 0, 0, 0, 2, 1, 1, 1, 1};
    std::array<vec4, 9> irradiance;
    for (std::size_t i = 0; i < 9; ++i) {
        irradiance[i] = vec4(static_cast<float>(i + 1)) * vec4(1, 2, 3, 0);
    }
    std::array<vec4, 9> found{};
    for (std::uint32_t i = 0; i < 9; ++i) {
        kernels::surface_light{}.map(i, owners, table, triangles, materials, irradiance, found);
        const std::size_t other = i < 4 ? i + 5 : i - 5;
        const dvec3 behind = i == 4 ? dvec3(0) : dvec3(irradiance[other]);
        const dvec3 expected =
            dvec3(leaf.emission) +
            (dvec3(leaf.diffuse) * dvec3(irradiance[i]) + dvec3(leaf.transmission) * behind) / pi;
        EXPECT_LT(length(dvec3(found[i]) - expected), 1e-6 * length(expected)) << i;
    }
}

TEST(surface_triangles, are_those_of_a_mesh) {
    std::vector<surface_vertex> vertices(6);
    for (std::size_t i = 0; i < 6; ++i) {
        vertices[i].position = vec3(static_cast<float>(i), 1, 2);
    }
    const std::vector<std::uint32_t> indices{5, 3, 1, 0, 2, 4};
    std::vector<gather_triangle> made(4);
    kernels::surface_triangles kernel;
    kernel.first = 1;
    kernel.material = 7;
    for (std::uint32_t i = 0; i < 2; ++i) {
        kernel.map(i, vertices, indices, made);
    }
    EXPECT_EQ(made[1].a.x, 0);
    EXPECT_EQ(made[2].c.x, 5);
    EXPECT_EQ(made[2].material, 7u);
    EXPECT_EQ(made[2].alpha, 0u);
    kernel.indexed = 1;
    kernel.alpha = 3;
    for (std::uint32_t i = 0; i < 2; ++i) {
        kernel.map(i, vertices, indices, made);
    }
    EXPECT_EQ(made[1].a.x, 5);
    EXPECT_EQ(made[1].b.x, 3);
    EXPECT_EQ(made[2].c.x, 4);
    EXPECT_EQ(made[1].alpha, 3u);
    EXPECT_EQ(made[2].alpha, 4u);
    EXPECT_EQ(made[0].material, 0u); // before `first`, and beyond the mesh: as it was
    EXPECT_EQ(made[3].material, 0u);
}
