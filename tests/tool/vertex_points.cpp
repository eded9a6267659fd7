// Vertices as points that ask for light.

#include <tool/vertex_points.hpp>

#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <set>

using namespace skybark;
using tool::find_vertices;

namespace {

gather_triangle triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    gather_triangle t;
    t.a = a;
    t.b = b;
    t.c = c;
    return t;
}

/// Two triangles of a quad.
void add_quad(std::vector<gather_triangle>& to, glm::vec3 a, glm::vec3 b, glm::vec3 c,
              glm::vec3 d) {
    to.push_back(triangle(a, b, c));
    to.push_back(triangle(a, c, d));
}

std::vector<glm::vec3> none(const std::vector<gather_triangle>& of) {
    return std::vector<glm::vec3>(3 * of.size(), glm::vec3(0));
}

} // namespace

TEST(vertex_points, edges_have_a_point_for_each_face) {
    // A floor and a wall that meet at a right angle along x.
    std::vector<gather_triangle> triangles;
    add_quad(triangles, {0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0});
    add_quad(triangles, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
    const auto found = find_vertices(triangles, none(triangles), 0);
    ASSERT_EQ(found.samples.size(), 8u);
    ASSERT_EQ(found.places.size(), 8u);
    ASSERT_EQ(found.triangles.size(), 4u);
    for (std::size_t i = 0; i < 8; ++i) {
        const glm::vec3 n = found.samples[i].normal;
        EXPECT_TRUE(n == glm::vec3(0, 1, 0) || n == glm::vec3(0, 0, 1)) << n.x << n.y << n.z;
        // Off the other face, and within its own.
        const glm::vec3 p = found.samples[i].position;
        EXPECT_EQ(glm::dot(p - found.places[i], n), 0);
        EXPECT_GT(n.y == 1 ? p.z : p.y, 0);
        EXPECT_LT(glm::distance(p, found.places[i]), 2e-4f);
        EXPECT_GT(glm::distance(p, found.places[i]), 2e-5f);
    }
    for (std::size_t t = 0; t < 4; ++t) {
        EXPECT_EQ(found.places[found.triangles[t].x], triangles[t].a);
        EXPECT_EQ(found.places[found.triangles[t].z], triangles[t].c);
    }
}

TEST(vertex_points, curved_surfaces_are_smooth) {
    // A cylinder of 24 sides: 15° between faces.
    std::vector<gather_triangle> triangles;
    for (int i = 0; i < 24; ++i) {
        const auto at = [](int k, float y) {
            const float angle = 0.2617994f * static_cast<float>(k % 24);
            return glm::vec3(std::sin(angle), y, std::cos(angle));
        };
        add_quad(triangles, at(i, 0), at(i + 1, 0), at(i + 1, 1), at(i, 1));
    }
    const auto found = find_vertices(triangles, none(triangles), 0);
    EXPECT_LE(found.samples.size(), 2 * 48u) << "diagonals weigh one side more than the other";
    for (const gather_sample& s : found.samples) {
        const glm::vec3 out = glm::normalize(glm::vec3(s.position.x, 0, s.position.z));
        EXPECT_GT(glm::dot(s.normal, out), 0.998f);
    }
}

TEST(vertex_points, given_normals_are_kept) {
    const std::vector<gather_triangle> triangles{triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                                                 triangle({0, 0, 0}, {0, 1, 0}, {-1, 0, 0})};
    const glm::vec3 tilted = glm::normalize(glm::vec3(0, 1, 2));
    const auto found = find_vertices(triangles, std::vector<glm::vec3>(6, tilted), 0);
    ASSERT_EQ(found.samples.size(), 4u) << "the shared corners are one point each";
    for (const gather_sample& s : found.samples) {
        EXPECT_EQ(s.normal, tilted);
    }
    EXPECT_EQ(found.places[0], glm::vec3(0)) << "in the order in which triangles name them";
    EXPECT_EQ(found.places[1], glm::vec3(1, 0, 0));
}

TEST(vertex_points, stand_off_by_the_lift_at_least) {
    const std::vector<gather_triangle> small{triangle({0, 0, 0}, {0.01f, 0, 0}, {0, 0.01f, 0})};
    const double step = static_cast<double>(
        glm::distance(find_vertices(small, none(small), 1e-3f).samples[0].position, glm::vec3(0)));
    EXPECT_NEAR(step, std::sqrt(2.0) / 900, 1e-7) << "a third of the way, as 2e-3 would be farther";
    const auto far = find_vertices(small, none(small), 1e-4f);
    EXPECT_NEAR(glm::distance(far.samples[0].position, glm::vec3(0)), 2e-4, 1e-8);
}

TEST(vertex_points, leaves_out_what_has_no_normal) {
    std::vector<gather_triangle> triangles{triangle({0, 0, 0}, {1, 1, 1}, {2, 2, 2})};
    EXPECT_TRUE(find_vertices(triangles, none(triangles), 0).samples.empty());
    EXPECT_TRUE(find_vertices(triangles, none(triangles), 0).triangles.empty());
    EXPECT_TRUE(find_vertices({}, {}, 0).samples.empty());
    triangles.push_back(triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
    EXPECT_EQ(find_vertices(triangles, none(triangles), 0).samples.size(), 3u);
}

// A fan of so many triangles that not every pair of them is looked at.
TEST(vertex_points, takes_a_crowd_at_one_place) {
    std::vector<gather_triangle> triangles;
    for (int i = 0; i < 20000; ++i) {
        const auto at = [](int k) {
            const float angle = 3.1415927e-4f * static_cast<float>(k);
            return glm::vec3(std::cos(angle), std::sin(angle), 0);
        };
        triangles.push_back(triangle(glm::vec3(0), at(i), at(i + 1)));
    }
    const auto found = find_vertices(triangles, none(triangles), 0);
    EXPECT_EQ(found.triangles.size(), triangles.size());
    for (const gather_sample& s : found.samples) {
        EXPECT_NEAR(s.normal.z, 1, 1e-5);
    }
}
