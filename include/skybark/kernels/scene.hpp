#pragma once
// What the kernels that draw pictures share: the camera, the light and the sky, in one record.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/shading.hpp>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

namespace skybark::kernels {

/// One a picture. Lengths in m, radiances in kcd/m².
struct scene_record {
    glm::mat4 to_clip{1};     ///< world to clip space, 0 ≤ z ≤ w
    glm::mat4 from_clip{1};   ///< and back
    glm::mat4 to_shadow{1};   ///< world to the shadow map's clip space, orthographic
    glm::vec4 camera{0};      ///< xyz: the eye
    glm::vec4 shadow{0};      ///< x: side of a texel, m; y: 1 / texels a side; z: bias in texels
    shared::daylight_sky sky; ///< the light
    glm::vec4 ambient[4];     ///< irradiance over π, spherical harmonics 1, x, y, z
};
static_assert(sizeof(scene_record) == 3 * 64 + 2 * 16 + 8 * 16 + 4 * 16);

/// The part of the sun that a point sees: 4 × 4 texels of the shadow map, smoothly weighted.
template <class Images>
[[nodiscard]] float sun_at(const scene_record& scene, const glm::vec3& position,
                           const glm::vec3& normal, const Images& images) {
    const glm::vec3 raised = position + normal * (scene.shadow.x * scene.shadow.z);
    const glm::vec4 p = scene.to_shadow * glm::vec4(raised, 1.0f);
    const glm::vec2 texel = glm::vec2(p.x * 0.5f + 0.5f, 0.5f - p.y * 0.5f) / scene.shadow.y - 0.5f;
    const glm::ivec2 size = images.size(0);
    const glm::vec2 corner = glm::floor(texel);
    const glm::vec2 part = texel - corner;
    float lit_texels = 0;
    for (int y = -1; y <= 2; ++y) {
        for (int x = -1; x <= 2; ++x) {
            const glm::ivec2 at = glm::ivec2(corner) + glm::ivec2(x, y);
            const float wx = x == -1 ? 1.0f - part.x : (x == 2 ? part.x : 1.0f);
            const float wy = y == -1 ? 1.0f - part.y : (y == 2 ? part.y : 1.0f);
            const bool inside = at.x >= 0 && at.y >= 0 && at.x < size.x && at.y < size.y;
            const float depth = inside ? images.fetch(0, at).x : 1.0f;
            lit_texels += glm::min(p.z, 1.0f) <= depth ? wx * wy : 0.0f;
        }
    }
    return lit_texels / 9.0f;
}

[[nodiscard]] inline glm::vec3 ambient_of(const scene_record& scene, const glm::vec3& normal) {
    return shared::ambient_light(scene.ambient[0], scene.ambient[1], scene.ambient[2],
                                 scene.ambient[3], normal);
}

} // namespace skybark::kernels
