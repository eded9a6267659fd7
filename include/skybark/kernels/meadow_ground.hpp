#pragma once
// meadow_ground: draws a level meadow up to the horizon, with the shadows that fall on it.

#include <skybark/kernels/scene.hpp>

namespace skybark::kernels {

/// Six vertices, two triangles. Buffers: one scene. Images: the shadow map.
struct meadow_ground {
    using buffers = buffer_list<readonly<scene_record>>;
    static constexpr std::uint32_t images = 1;
    static constexpr std::uint32_t varyings = 1;

    float height = 0;     ///< m, y of the ground
    float extent = 10000; ///< m from under the eye to each side

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, 1>& out,
                     std::span<const scene_record> scene) const {
        const std::uint32_t corner = index < 3 ? index : (index == 3 ? 2 : (index == 4 ? 1 : 3));
        const glm::vec3 p(scene[0].camera.x + ((corner & 1) != 0 ? extent : -extent), height,
                          scene[0].camera.z + ((corner & 2) != 0 ? -extent : extent));
        out[0] = glm::vec4(p, 0.0f);
        return scene[0].to_clip * glm::vec4(p, 1.0f);
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, 1>& in, glm::vec2, bool,
                             const Images& shadow_map, std::span<const scene_record> scene) const {
        const glm::vec3 p(in[0]);
        const glm::vec3 up(0, 1, 0);
        const float sun = sun_at(scene[0], p, up, shadow_map);
        const glm::vec3 light = shared::lit(shared::grass_albedo(p.x, p.z), up, scene[0].sky, sun,
                                            ambient_of(scene[0], up));
        const glm::vec3 away = p - glm::vec3(scene[0].camera);
        const float distance = glm::length(away);
        const glm::vec3 air = shared::sky_radiance(scene[0].sky, away * (1.0f / distance));
        return {glm::vec4(glm::mix(light, air, shared::haze(distance)), 1.0f), true};
    }
};

} // namespace skybark::kernels
