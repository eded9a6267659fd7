// What the pixels of a picture see, against rays in double precision.

#include "support/devices.hpp"

#include <picture/gather_picture.hpp>
#include <scenes/random.hpp>
#include <scenes/surface_list.hpp>

#include <gtest/gtest.h>

using namespace skybark;
using glm::dvec3;

namespace {

class seen_places : public testing::TestWithParam<const char*> {};

scenes::surface_list some_triangles() {
    scenes::surface_list scene;
    gather_material both;
    both.two_sided = 1;
    both.transmission = glm::vec3(0.3f);
    const std::uint32_t one_sided = scenes::add_paint(scene, glm::vec3(0.5f));
    const std::uint32_t two_sided = scenes::add_material(scene, both);
    scenes::random_numbers random(11);
    // More than 2048, so that both parts of their numbers count.
    for (std::uint32_t i = 0; i < 5000; ++i) {
        const glm::vec3 at = 4.0f * random.in_ball();
        const glm::vec3 a = 0.3f * random.direction();
        const glm::vec3 b = 0.3f * random.direction();
        const glm::vec3 c = 0.3f * random.direction();
        scenes::add_triangle(scene, i % 3 == 0 ? two_sided : one_sided, at + a, at + b, at + c);
    }
    return scene;
}

struct met {
    double distance = 1e300;
    std::uint32_t surface = no_surface;
    double margin = 0; // from the nearest edge, barycentric
};

/// Möller and Trumbore's way, in double.
met nearest(const scenes::surface_list& scene, dvec3 origin, dvec3 along) {
    met best;
    for (std::uint32_t i = 0; i < scene.triangles.size(); ++i) {
        const gather_triangle& t = scene.triangles[i];
        const dvec3 ab = dvec3(t.b) - dvec3(t.a);
        const dvec3 ac = dvec3(t.c) - dvec3(t.a);
        const dvec3 p = glm::cross(along, ac);
        const double det = glm::dot(ab, p);
        const dvec3 s = (origin - dvec3(t.a)) / det;
        const double u = glm::dot(s, p);
        const dvec3 q = glm::cross(s, ab);
        const double v = glm::dot(along, q);
        const double distance = glm::dot(ac, q);
        if (u >= 0 && v >= 0 && u + v <= 1 && distance > 0 && distance < best.distance) {
            best = {distance, 2 * i + (det > 0 ? 0u : 1u), std::min({u, v, 1 - u - v})};
        }
    }
    return best;
}

TEST_P(seen_places, are_where_rays_meet_surfaces) {
    support::with_device(GetParam(), [](auto& device) {
        using backend = std::remove_reference_t<decltype(device)>;
        const scenes::surface_list scene = some_triangles();
        picture::gather_view from;
        from.eye = {2, 3, 9};
        from.target = {0.3f, -0.2f, 0};
        from.field_of_view = 50;
        from.width = 48;
        from.height = 32;
        from.supersampling = 1;
        auto triangles = make_buffer<backend, gather_triangle>(device, scene.triangles);
        ASSERT_TRUE(triangles) << triangles.error().message;
        const auto found = picture::see(device, view<backend>(*triangles), buffer_view<backend>{},
                                        scene.triangles, scene.materials, from);
        ASSERT_TRUE(found) << found.error().message;

        const dvec3 ahead = glm::normalize(dvec3(from.target) - dvec3(from.eye));
        const dvec3 right = glm::normalize(glm::cross(ahead, dvec3(0, 1, 0)));
        const dvec3 up = glm::cross(right, ahead);
        const double half = std::tan(25 * 3.14159265358979323846 / 180);
        int seen = 0;
        int backs = 0;
        int beside = 0;
        for (std::uint32_t i = 0; i < found->places.size(); ++i) {
            const double x = ((i % 48) + 0.5) / 24 - 1;
            const double y = 1 - ((i / 48) + 0.5) / 16;
            const dvec3 along = glm::normalize(ahead + (x * half * 1.5) * right + (y * half) * up);
            const met expected = nearest(scene, dvec3(from.eye), along);
            const auto& place = found->places[i];
            // A raster moves corners by up to 1/256 of a pixel, which is 0.2 % of most edges; it
            // counts for more where triangles are seen edge-on or go through each other.
            if (expected.surface != place.surface) {
                beside += expected.margin > 0.02;
                continue;
            }
            if (expected.surface == no_surface) {
                EXPECT_EQ(place.here, picture::no_sample);
                continue;
            }
            const gather_triangle& t = scene.triangles[expected.surface / 2];
            const bool back = expected.surface % 2 == 1;
            const bool two_sided = scene.materials[t.material].two_sided != 0;
            ASSERT_EQ(place.here == picture::no_sample, back && !two_sided) << "pixel " << i;
            ASSERT_EQ(place.behind == picture::no_sample, !two_sided) << "pixel " << i;
            if (place.here == picture::no_sample) {
                continue;
            }
            ++seen;
            backs += back;
            const gather_sample& s = found->samples[place.here];
            const dvec3 where = dvec3(from.eye) + expected.distance * along;
            const dvec3 normal =
                glm::normalize(glm::cross(dvec3(t.b) - dvec3(t.a), dvec3(t.c) - dvec3(t.a)));
            // 1/256 of a pixel is 2e-4 m across the view, and as much over the cosine in depth.
            const double cosine = std::abs(glm::dot(normal, along));
            EXPECT_LE(glm::distance(dvec3(s.position), where), 1e-3 + 1e-3 / cosine);
            EXPECT_GE(glm::dot(dvec3(s.normal), back ? -normal : normal), 1 - 1e-6);
            EXPECT_LE(glm::dot(dvec3(s.normal), along), 0) << "the side that is seen";
        }
        EXPECT_LE(beside, 2);
        EXPECT_GE(seen, 400);
        EXPECT_GE(backs, 100);
    });
}

TEST_P(seen_places, are_not_in_holes) {
    support::with_device(GetParam(), [](auto& device) {
        using backend = std::remove_reference_t<decltype(device)>;
        scenes::surface_list scene;
        const std::uint32_t paint = scenes::add_paint(scene, glm::vec3(0.5f));
        scenes::add_triangle(scene, paint, {-1, -1, 0}, {3, -1, 0}, {-1, 3, 0});
        scene.triangles[0].alpha = 1;
        // A map of two texels over the square of the picture: its left half is a hole.
        alpha_coordinates holes;
        holes.a = {0, 0};
        holes.b = {2, 0};
        holes.c = {0, 2};
        holes.map = 12;
        holes.size = 2 + 65536;
        std::vector<std::uint32_t> words(14);
        std::memcpy(words.data(), &holes, sizeof(holes));
        words[12] = glm::floatBitsToUint(0.25f);
        words[13] = glm::floatBitsToUint(0.75f);
        picture::gather_view from;
        from.eye = {0, 0, 4};
        from.field_of_view = glm::degrees(2 * std::atan(0.25f)); // −1 … 1 at z = 0
        from.width = from.height = 16;
        from.supersampling = 1;
        auto triangles = make_buffer<backend, gather_triangle>(device, scene.triangles);
        auto alpha = make_buffer<backend, std::uint32_t>(device, words);
        ASSERT_TRUE(triangles && alpha);
        const auto found = picture::see(device, view<backend>(*triangles), view<backend>(*alpha),
                                        scene.triangles, scene.materials, from);
        ASSERT_TRUE(found) << found.error().message;
        for (std::uint32_t i = 0; i < 256; ++i) {
            EXPECT_EQ(found->places[i].surface, i % 16 < 8 ? no_surface : 0u) << i;
        }
    });
}

INSTANTIATE_TEST_SUITE_P(backends, seen_places, testing::Values("cpu", "opengl", "vulkan"),
                         [](const auto& name) { return std::string(name.param); });

} // namespace
