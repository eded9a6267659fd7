// The land: heights without steps, normals that belong to them, and the mesh that shows both.

#include <meadow/land.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <utility>

using namespace skybark;
using meadow::land;

namespace {

/// Places in the stand, in the hills and beyond, and where these begin and end.
std::vector<glm::vec2> places() {
    std::vector<glm::vec2> all{{0, 0}, {110, 0}, {0, -110}, {2200, 0}, {77.8f, -77.8f}};
    std::mt19937 engine(5);
    for (const float reach : {80.0f, 130.0f, 2000.0f, 8000.0f}) {
        std::uniform_real_distribution<float> within(-reach, reach);
        for (int i = 0; i < 200; ++i) {
            const float x = within(engine);
            all.emplace_back(x, within(engine));
        }
    }
    return all;
}

} // namespace

TEST(land, normals_match_finite_differences_of_the_height) {
    for (const std::uint64_t seed : {1u, 2u, 77u}) {
        const land ground(seed);
        for (const glm::vec2 at : places()) {
            // Differences of 1 m steps: half the third derivative, below 4e-3 for the shortest
            // swell of 12 m and 4 cm; heights of 200 m are rounded to 1.5e-5 m.
            const auto height = [&](float x, float z) {
                return static_cast<double>(ground.height(x, z));
            };
            const double dx = (height(at.x + 0.5f, at.y) - height(at.x - 0.5f, at.y));
            const double dz = (height(at.x, at.y + 0.5f) - height(at.x, at.y - 0.5f));
            const glm::dvec3 wanted = glm::normalize(glm::dvec3(-dx, 1, -dz));
            const glm::dvec3 normal(ground.normal(at.x, at.y));
            EXPECT_NEAR(glm::length(normal), 1, 1e-6);
            EXPECT_LT(glm::distance(normal, wanted), 0.004) << at.x << ", " << at.y;
        }
    }
}

TEST(land, heights_have_no_steps) {
    const land ground(1);
    for (const glm::vec2 at : places()) {
        // No slope anywhere is steeper than 1 : 1.
        const float here = ground.height(at.x, at.y);
        const float step = 1e-3f * std::max(1.0f, 0.01f * glm::length(at));
        EXPECT_NEAR(ground.height(at.x + step, at.y), here, step + 3e-5f);
        EXPECT_NEAR(ground.height(at.x, at.y + step), here, step + 3e-5f);
    }
}

TEST(land, is_gentle_in_the_stand_and_hilly_around) {
    for (const std::uint64_t seed : {1u, 2u, 3u, 12345u}) {
        const land ground(seed);
        for (float x = -80; x <= 80; x += 4) {
            for (float z = -80; z <= 80; z += 4) {
                EXPECT_LE(std::abs(ground.height(x, z)), 2.0f);
            }
        }
        float low = 1e9f;
        float high = -1e9f;
        for (float a = 0; a < 6.28f; a += 0.02f) {
            for (float r = 1000; r <= 8000; r += 100) {
                const float h = ground.height(r * std::cos(a), r * std::sin(a));
                low = std::min(low, h);
                high = std::max(high, h);
            }
        }
        EXPECT_GE(high - low, 60) << seed;
        EXPECT_LE(high - low, 300) << seed;
    }
    EXPECT_NE(land(1).height(10, 10), land(2).height(10, 10));
}

TEST(land, mesh_is_one_surface_out_to_the_horizon) {
    const land ground(1);
    const meadow::land_mesh mesh = ground.mesh();
    const std::uint32_t n = land::points;
    const std::size_t border = 4 * (std::size_t{n} - 1);
    ASSERT_EQ(mesh.vertices.size(), std::size_t{n} * n + land::rings * border);
    // Every edge has two triangles, once in each direction, but the last ring's.
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const auto corner = [&](std::size_t k) {
            return mesh.vertices[mesh.indices[i + k % 3]].position;
        };
        EXPECT_GT(glm::cross(corner(1) - corner(0), corner(2) - corner(0)).y, 0);
        for (std::size_t k = 0; k < 3; ++k) {
            ++edges[{mesh.indices[i + k], mesh.indices[i + (k + 1) % 3]}];
        }
    }
    std::size_t open = 0;
    for (const auto& [edge, count] : edges) {
        EXPECT_EQ(count, 1);
        open += edges.contains({edge.second, edge.first}) ? 0 : 1;
    }
    EXPECT_EQ(open, border);
    float far = 0;
    for (const surface_vertex& v : mesh.vertices) {
        far = std::max(far, std::max(std::abs(v.position.x), std::abs(v.position.z)));
    }
    EXPECT_NEAR(far, land::horizon, 1);
}

TEST(land, vertices_show_the_light_of_the_nearest_inner_one) {
    const land ground(1);
    const meadow::land_mesh mesh = ground.mesh();
    const std::uint32_t inner = land::points * land::points;
    for (std::uint32_t i = 0; i < mesh.vertices.size(); i += i < inner ? 1 : 37) {
        const surface_vertex& v = mesh.vertices[i];
        const auto shown = static_cast<std::uint32_t>(v.u);
        if (i < inner) {
            ASSERT_EQ(shown, i);
            continue;
        }
        // Outwards along a ray from the middle.
        ASSERT_LT(shown, inner);
        const glm::vec3 from = mesh.vertices[shown].position;
        const float times = glm::length(glm::vec2(v.position.x, v.position.z)) /
                            glm::length(glm::vec2(from.x, from.z));
        EXPECT_GT(times, 1);
        EXPECT_NEAR(v.position.x, from.x * times, 1e-2f);
        EXPECT_NEAR(v.position.z, from.z * times, 1e-2f);
        EXPECT_FLOAT_EQ(std::max(std::abs(from.x), std::abs(from.z)), land::side / 2);
    }
}

TEST(land, light_meets_the_whole_square_once) {
    const land ground(1);
    std::vector<gather_triangle> triangles(3);
    ground.add_light_triangles(triangles, 7);
    ASSERT_EQ(triangles.size(), 3 + 2 * land::light_cells * land::light_cells);
    double level = 0;
    for (std::size_t i = 3; i < triangles.size(); ++i) {
        const gather_triangle& t = triangles[i];
        EXPECT_EQ(t.material, 7u);
        const glm::vec3 cross = glm::cross(t.b - t.a, t.c - t.a);
        EXPECT_GT(cross.y, 0);
        level += static_cast<double>(cross.y) / 2;
        EXPECT_FLOAT_EQ(t.b.y, ground.height(t.b.x, t.b.z));
    }
    EXPECT_NEAR(level, 160.0 * 160.0, 0.1);
}
