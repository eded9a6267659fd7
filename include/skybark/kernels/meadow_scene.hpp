#pragma once
// What the kernels share that draw a meadow: its surroundings, in one record, and light from them.
//
// Direct light: the sun, behind the shadow map and the clouds' attenuation volume (Shimada et al.
// 2008, section 5: shadows of clouds on other objects). Indirect light: what has been gathered at
// the land's vertices, or in an irradiance volume (Greger, Shirley, Hubbard and Greenberg 1998).

#include <skybark/kernels/scene.hpp>
#include <skybark/shared/meadow_light.hpp>

namespace skybark::kernels {

/// One a picture, beside the scene_record.
using surroundings_record = shared::surroundings_record;
static_assert(sizeof(surroundings_record) == 80 + 48 + 16);
static_assert(offsetof(surroundings_record, gathered) == 80 &&
              offsetof(surroundings_record, cloud_shadow) == 128);

/// What clouds leave of the sun's light at a place. Volume 0: their attenuation.
template <class Images>
[[nodiscard]] float sun_behind_clouds(const surroundings_record& around, const glm::vec3& place,
                                      const Images& from) {
    if (!(around.cloud_shadow > 0.0f)) {
        return 1.0f;
    }
    const glm::vec3 at = shared::cloud_texel(around.clouds, glm::vec3(from.volume_size(0)), place);
    return shared::meadow_cloud_light(around, from.volume(0, at));
}

/// Light from all around a place, as the irradiance volume has it.
struct gathered_around {
    glm::vec4 red, green, blue; ///< spherical harmonics 1, y, z, x

    [[nodiscard]] glm::vec3 irradiance(const glm::vec3& normal) const {
        return shared::irradiance_of(red, green, blue, normal);
    }
};

/// Twelve samples of volume 1.
template <class Images>
[[nodiscard]] gathered_around gathered_at(const surroundings_record& around, const glm::vec3& place,
                                          const Images& from) {
    const auto color = [&](float first) {
        glm::vec4 c;
        for (int i = 0; i < 4; ++i) {
            c[i] = from.volume(
                1, shared::irradiance_texel(around.gathered, place, first + static_cast<float>(i)));
        }
        return c;
    };
    return {color(0), color(4), color(8)};
}

} // namespace skybark::kernels
