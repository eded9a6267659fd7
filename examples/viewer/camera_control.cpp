#include "camera_control.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace skybark::viewer {

namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr float steepest = 0.495f * pi;

/// From the target to the eye.
glm::vec3 outward(const orbit_camera& from) {
    return {std::sin(from.azimuth) * std::cos(from.elevation), std::sin(from.elevation),
            -std::cos(from.azimuth) * std::cos(from.elevation)};
}

glm::vec3 within_reach(glm::vec3 place) {
    return glm::clamp(place, glm::vec3(-most_reach), glm::vec3(most_reach));
}

} // namespace

glm::vec3 eye_of(const orbit_camera& from) { return from.target + from.distance * outward(from); }

orbit_camera orbit_of(const meadow::camera& from, const land_height& ground) {
    const glm::vec3 eye = from.eye + glm::vec3(0, ground(from.eye.x, from.eye.z), 0);
    const glm::vec3 line = eye - from.target;
    const float distance = std::max(glm::length(line), least_distance);
    const float sine = std::clamp(line.y / distance, -1.0f, 1.0f);
    return {from.target, distance, std::atan2(line.x, -line.z),
            std::clamp(std::asin(sine), -steepest, steepest), from.field};
}

meadow::camera camera_of(const orbit_camera& from, const land_height& ground) {
    meadow::camera camera{eye_of(from), from.target, from.field};
    camera.eye.y = std::max(camera.eye.y - ground(camera.eye.x, camera.eye.z), least_height);
    return camera;
}

orbit_camera orbit(orbit_camera from, glm::vec2 pixels, float height) {
    const glm::vec2 angles = pixels * (pi / height);
    from.azimuth = std::remainder(from.azimuth + angles.x, 2 * pi);
    from.elevation = std::clamp(from.elevation + angles.y, -steepest, steepest);
    return from;
}

orbit_camera pan(orbit_camera from, glm::vec2 pixels, float height) {
    const glm::vec3 back = outward(from);
    const glm::vec3 right = glm::normalize(glm::cross(glm::vec3(0, 1, 0), back));
    const glm::vec3 up = glm::cross(back, right);
    const float metres = 2 * from.distance * std::tan(0.5f * from.field) / height; // to a pixel
    from.target = within_reach(from.target + metres * (pixels.y * up - pixels.x * right));
    return from;
}

orbit_camera zoom(orbit_camera from, float steps) {
    from.distance =
        std::clamp(from.distance * std::pow(0.9f, steps), least_distance, most_distance);
    return from;
}

} // namespace skybark::viewer
