// Orbit, pan and zoom, by where points of the scene are then seen, in double precision.

#include <viewer/camera_control.hpp>

#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <numbers>

namespace skybark::viewer {
namespace {

constexpr double pi = std::numbers::pi;
constexpr float height = 600; // of the window, pixels

float flat(float, float) { return 0; }
/// Hills whose height is known everywhere.
float hills(float x, float z) { return 3 + 0.1f * x - 0.05f * z; }

const orbit_camera somewhere{{1, 2, -3}, 20, 0.4f, 0.3f, 0.7f};

/// Where a point is seen, pixels from the middle of the window (y down).
glm::dvec2 seen(const orbit_camera& from, glm::dvec3 point) {
    const glm::dvec3 eye(eye_of(from));
    const glm::dvec3 ahead = glm::normalize(glm::dvec3(from.target) - eye);
    const glm::dvec3 right = glm::normalize(glm::cross(ahead, glm::dvec3(0, 1, 0)));
    const glm::dvec3 up = glm::cross(right, ahead);
    const glm::dvec3 line = point - eye;
    const double scale = 0.5 * double{height} / std::tan(0.5 * double{from.field});
    return glm::dvec2(glm::dot(line, right), -glm::dot(line, up)) * scale / glm::dot(line, ahead);
}

double distance(const orbit_camera& from) {
    return glm::distance(glm::dvec3(eye_of(from)), glm::dvec3(from.target));
}

TEST(camera_control, a_camera_survives_the_way_there_and_back) {
    const meadow::camera from{{22, 3.4f, 62}, {-4, 7, 0}, 0.7f};
    const meadow::camera back = camera_of(orbit_of(from, hills), hills);
    // Floats of 70 m through a sine and a cosine: a few ulps of 8e-6 m.
    EXPECT_LT(glm::distance(from.eye, back.eye), 1e-4f);
    EXPECT_EQ(from.target, back.target);
    EXPECT_EQ(from.field, back.field);
}

TEST(camera_control, an_azimuth_counts_clockwise_from_north) {
    const orbit_camera north = orbit_of({{0, 0, -10}, {0, 0, 0}, 1}, flat);
    const orbit_camera east = orbit_of({{10, 0, 0}, {0, 0, 0}, 1}, flat);
    EXPECT_NEAR(north.azimuth, 0, 1e-6);
    EXPECT_NEAR(east.azimuth, pi / 2, 1e-6);
}

TEST(camera_control, the_height_of_the_window_is_half_a_turn) {
    const orbit_camera turned = orbit(somewhere, {height, 0}, height);
    const glm::vec3 before = eye_of(somewhere) - somewhere.target;
    const glm::vec3 after = eye_of(turned) - turned.target;
    EXPECT_NEAR(after.x, -before.x, 1e-4);
    EXPECT_NEAR(after.y, before.y, 1e-4);
    EXPECT_NEAR(after.z, -before.z, 1e-4);
    EXPECT_EQ(turned.target, somewhere.target);
}

TEST(camera_control, the_scene_turns_the_way_that_the_pointer_goes) {
    // A point in front of the target, a metre nearer to the eye.
    const glm::dvec3 eye(eye_of(somewhere));
    const glm::dvec3 target(somewhere.target);
    const glm::dvec3 front = target + glm::normalize(eye - target);
    const glm::dvec2 right = seen(orbit(somewhere, {20, 0}, height), front);
    const glm::dvec2 down = seen(orbit(somewhere, {0, 20}, height), front);
    EXPECT_GT(right.x, 1);
    EXPECT_NEAR(right.y, 0, 1);
    EXPECT_GT(down.y, 1);
    EXPECT_NEAR(down.x, 0, 1e-2);
}

TEST(camera_control, an_orbit_keeps_its_distance_and_never_tips_over) {
    orbit_camera camera = somewhere;
    for (const float pixels : {1e5f, -3e5f, 17.0f}) {
        camera = orbit(camera, {pixels, pixels}, height);
        EXPECT_NEAR(distance(camera), 20, 1e-4);
        EXPECT_LT(std::abs(camera.elevation), pi / 2);
        EXPECT_LE(std::abs(camera.azimuth), 1.001 * pi);
    }
}

TEST(camera_control, what_is_panned_stays_under_the_pointer) {
    const glm::dvec3 target(somewhere.target);
    const orbit_camera moved = pan(somewhere, {90, -40}, height);
    const glm::dvec2 at = seen(moved, target);
    EXPECT_NEAR(at.x, 90, 1e-2); // float places of 20 m: 2e-6 m, 6e-5 pixels each
    EXPECT_NEAR(at.y, -40, 1e-2);
    EXPECT_NEAR(distance(moved), 20, 1e-4);
}

TEST(camera_control, a_pan_ends_where_the_scene_does) {
    orbit_camera camera = somewhere;
    for (int i = 0; i < 100; ++i) {
        camera = pan(camera, {1e5f, 1e5f}, height);
    }
    EXPECT_LE(std::abs(camera.target.x), most_reach);
    EXPECT_LE(std::abs(camera.target.y), most_reach);
    EXPECT_LE(std::abs(camera.target.z), most_reach);
}

TEST(camera_control, a_step_of_the_wheel_is_a_tenth_of_the_way) {
    EXPECT_NEAR(distance(zoom(somewhere, 1)), 18, 1e-4);
    EXPECT_NEAR(distance(zoom(somewhere, -1)), 20 / 0.9, 1e-4);
    EXPECT_EQ(zoom(somewhere, 1).target, somewhere.target);
    EXPECT_EQ(zoom(somewhere, 1000).distance, least_distance);
    EXPECT_EQ(zoom(somewhere, -1000).distance, most_distance);
}

TEST(camera_control, an_eye_in_the_ground_is_lifted_out_of_it) {
    const orbit_camera below = orbit(somewhere, {0, -height}, height);
    ASSERT_LT(eye_of(below).y, hills(eye_of(below).x, eye_of(below).z));
    EXPECT_EQ(camera_of(below, hills).eye.y, least_height);
}

TEST(camera_control, a_camera_at_its_own_target_is_moved_off) {
    const orbit_camera camera = orbit_of({{1, 2, 3}, {1, 2, 3}, 0.7f}, flat);
    EXPECT_EQ(camera.distance, least_distance);
    EXPECT_TRUE(std::isfinite(camera.azimuth) && std::isfinite(camera.elevation));
}

} // namespace
} // namespace skybark::viewer
