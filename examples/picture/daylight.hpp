#pragma once
// The light of a clear day for a direction to the sun: what shaders/shared/daylight.glsl evaluates.

#include <skybark/kernels/scene.hpp>

#include <glm/geometric.hpp>

namespace skybark::picture {

/// Direction to the sun from its compass azimuth (0 is north, −Z; 90° is east, +X) and elevation,
/// in degrees.
[[nodiscard]] glm::vec3 direction_to_sun(double azimuth, double elevation);

/// Sky and sunlight at a turbidity of 2 (very clear) to 10 (haze); 3 is a fine day. The sun is
/// taken to be at least one degree up.
[[nodiscard]] shared::daylight_sky daylight(glm::vec3 to_sun, double turbidity);

/// Sets `scene.ambient` to the irradiance of the scene's sky and of sunlit ground of this albedo.
void set_ambient(kernels::scene_record& scene, glm::vec3 ground_albedo);

} // namespace skybark::picture
