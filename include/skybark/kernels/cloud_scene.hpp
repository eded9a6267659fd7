#pragma once
// What the kernels that draw clouds share: the light at a place in a cloud.
//
// Three parts: the sun's light that reaches the place through the attenuation
// volume, scattered once by the phase function (or octave after octave); what has been scattered
// more than once, from a volume of its own; and light from the sky and the ground, by two streams
// in the column that an attenuation volume lit from the zenith gives.

#include <skybark/kernels/scene.hpp>
#include <skybark/shared/cloud_lighting.hpp>

namespace skybark::kernels {

using shared::cloud_lighting;
static_assert(sizeof(cloud_lighting) == 3 * 80 + 2 * 16 + 12 * 4);

/// What a kernel's volumes are, in order.
enum cloud_volume_slot : std::uint32_t { sun_volume, sky_volume, diffuse_volume };

template <class Images>
[[nodiscard]] glm::vec3 cloud_texel(std::uint32_t n, const light_grid& grid, glm::vec3 place,
                                    const Images& from) {
    return shared::cloud_texel(grid, glm::vec3(from.volume_size(n)), place);
}

/// The mean radiance of light that is the same from everywhere.
template <class Images>
[[nodiscard]] glm::vec3 cloud_sky(const scene_record& scene, const cloud_lighting& lighting,
                                  glm::vec3 place, const Images& from) {
    const glm::vec3 at = cloud_texel(sky_volume, lighting.sky_grid, place, from);
    const float over = lighting.sky_thickness * from.volume(sky_volume, at);
    const float whole =
        lighting.sky_thickness * from.volume(sky_volume, glm::vec3(at.x, 0.0f, at.z));
    return shared::sky_inside(over, whole, ambient_of(scene, glm::vec3(0, 1, 0)),
                              ambient_of(scene, glm::vec3(0, -1, 0)));
}

/// Radiance that a place in a cloud sends towards the eye where it takes out all light: `single` of
/// the sun's light, by the phase function, and `diffuse` of light from everywhere. `given` is the
/// sun's light where it is known already, below 0 where it is not.
template <class Images>
[[nodiscard]] glm::vec3 cloud_source(const scene_record& scene, const cloud_lighting& lighting,
                                     glm::vec3 place, glm::vec3 direction, float given,
                                     float single, float diffuse, const Images& from) {
    const float cosine = glm::dot(direction, glm::vec3(scene.sky.to_sun));
    float scattered = 0;
    if (given >= 0) {
        scattered = given * shared::phase_value(lighting.phase, cosine);
    } else {
        const glm::vec3 at = cloud_texel(sun_volume, lighting.sun_grid, place, from);
        scattered = shared::octaves_scattered(lighting.octaves, lighting.phase,
                                              from.volume(sun_volume, at), cosine);
    }
    scattered *= single;
    if (lighting.diffuse > 0) {
        const glm::vec3 at = cloud_texel(diffuse_volume, lighting.diffuse_grid, place, from);
        scattered += diffuse * lighting.diffuse * from.volume(diffuse_volume, at);
    }
    const glm::vec3 light = glm::vec3(scene.sky.sunlight) * (3.14159265f * scattered);
    return lighting.sky > 0
               ? light + cloud_sky(scene, lighting, place, from) * (lighting.sky * diffuse)
               : light;
}

} // namespace skybark::kernels
