#pragma once
// The light of a clear day for a direction to the sun: what shaders/shared/daylight.glsl evaluates.

#include <skybark/kernels/scene.hpp>

#include <glm/geometric.hpp>

namespace skybark::picture {

/// Direction to the sun from its compass azimuth (0 is north, −Z; 90° is east, +X) and elevation,
/// in degrees.
[[nodiscard]] glm::vec3 direction_to_sun(double azimuth, double elevation);

/// Sky and sunlight at a turbidity of 2 (very clear) to 10 (haze); 3 is a fine day. The sun is
/// taken to be at least one degree up. Its light is that at `altitude` m: of the air and of the
/// haze less and less is above (scale heights of 8.4 and 1.25 km).
[[nodiscard]] shared::daylight_sky daylight(glm::vec3 to_sun, double turbidity,
                                            double altitude = 0);

/// Brings a sky nearer to measured ones. How bright: as the CIE's standard clear sky (ISO
/// 15469:2004, type 12), of which a level surface gets 0.8 + 15.5 √sin e klx, e the sun's elevation
/// (IES, "Recommended practice for the calculation of daylight availability", 1984); Preetham's
/// model by itself gives twice that, at sunset three times. What colour: that of daylight, on the
/// CIE's locus y = −3x² + 2.87x − 0.275 as nearly as Perez' formula can have it, and by day bluer
/// at the horizon; Preetham's is as warm at noon as at sunset, and pink.
void set_clear_day(shared::daylight_sky& sky);

/// Sets `scene.ambient` to the irradiance of the scene's sky and of sunlit ground of this albedo.
void set_ambient(kernels::scene_record& scene, glm::vec3 ground_albedo);

/// The land that clouds see below them.
struct land_below {
    glm::vec3 albedo{0};
    float sunlit = 1; ///< the part of it that clouds let have the sun
    float veil = 0;   ///< what of its light the air hides; that air sends the sky's mean radiance
};

/// Sets `scene.ambient` to what comes to a level surface from above and to one from below, and to
/// the mean of both on upright ones: exact where clouds need it. (set_ambient is as near as
/// harmonics come for every normal; of a bright horizon's light some reaches what faces down.)
void set_level_ambient(kernels::scene_record& scene, const land_below& land);

} // namespace skybark::picture
