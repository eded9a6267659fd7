#pragma once
// camera_control: a camera that goes around a place, by the mouse. Pure functions of numbers.

#include <meadow/description.hpp>

#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace skybark::viewer {

/// The height of the land at x, z, m.
using land_height = std::function<float(float, float)>;

/// A camera by what it turns around.
struct orbit_camera {
    glm::vec3 target{0}; ///< m
    float distance = 1;  ///< m, from the target to the eye
    float azimuth = 0;   ///< rad, of the eye as the target sees it: from north, clockwise
    float elevation = 0; ///< rad, the same, above the horizon
    float field = 0.7f;  ///< rad, vertical

    [[nodiscard]] bool operator==(const orbit_camera&) const = default;
};

/// Never nearer or farther than this, m; the eye is at least `least_height` above the land.
inline constexpr float least_distance = 0.5f;
inline constexpr float most_distance = 2000;
inline constexpr float least_height = 0.2f;
/// The target stays within this of the middle, m.
inline constexpr float most_reach = 1000;

/// The camera that looks as `from` does, whose eye's height is above the land.
[[nodiscard]] orbit_camera orbit_of(const meadow::camera& from, const land_height& ground);
/// And back. An eye that would be in the ground is lifted out of it.
[[nodiscard]] meadow::camera camera_of(const orbit_camera& from, const land_height& ground);
/// Where the eye is, m, wherever the land is.
[[nodiscard]] glm::vec3 eye_of(const orbit_camera& from);

/// The pointer went `pixels` (y down) in a window `height` pixels high, and the scene turns with
/// it: half a turn for the height of the window. Straight up and straight down are not reached.
[[nodiscard]] orbit_camera orbit(orbit_camera from, glm::vec2 pixels, float height);
/// The same, but the scene moves along: what is as far away as the target stays under the pointer.
[[nodiscard]] orbit_camera pan(orbit_camera from, glm::vec2 pixels, float height);
/// Each step of the wheel towards the screen brings the eye a tenth of the way to the target.
[[nodiscard]] orbit_camera zoom(orbit_camera from, float steps);

} // namespace skybark::viewer
