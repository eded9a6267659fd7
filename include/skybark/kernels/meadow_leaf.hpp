#pragma once
// meadow_leaf: draws leaves, blades of grass and flowers cut out of their pictures, in sun, shadow,
// clouds' shadow and gathered light, from both sides.

#include <skybark/kernels/meadow_scene.hpp>
#include <skybark/shared/surfaces.hpp>

namespace skybark::kernels {

/// Buffers: vertices, one scene, its surroundings. Images: as lit_leaf's; what is covered less than
/// half is not drawn. Volumes: the sun's attenuation by clouds, and the irradiance volume.
struct meadow_leaf {
    using buffers = buffer_list<readonly<surface_vertex>, readonly<scene_record>,
                                readonly<surroundings_record>>;
    static constexpr std::uint32_t images = 2;
    static constexpr std::uint32_t volumes = 2;
    static constexpr std::uint32_t varyings = 2;

    float through = 0.8f; ///< green light that comes through over what is scattered back

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, varyings>& out,
                     std::span<const surface_vertex> vertices, std::span<const scene_record> scene,
                     std::span<const surroundings_record>) const {
        const surface_vertex& v = vertices[index];
        out = {glm::vec4(v.position, v.u), glm::vec4(v.normal, v.v)};
        return scene[0].to_clip * glm::vec4(v.position, 1.0f);
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, varyings>& in, glm::vec2, bool front,
                             const Images& from, std::span<const surface_vertex>,
                             std::span<const scene_record> scene,
                             std::span<const surroundings_record> around) const {
        const glm::vec4 texel = from.sample(1, glm::vec2(in[0].w, in[1].w));
        if (texel.w < 0.5f) {
            return {{}, false};
        }
        const glm::vec3 position(in[0]);
        const glm::vec3 upper = glm::normalize(glm::vec3(in[1]));
        const glm::vec3 n = front ? upper : -upper;
        const float facing = glm::dot(n, glm::vec3(scene[0].sky.to_sun));
        const float sun = sun_at(scene[0], position, facing > 0.0f ? n : -n, from) *
                          sun_behind_clouds(around[0], position, from);
        const gathered_around gathered = gathered_at(around[0], position, from);
        constexpr float over_pi = 0.318309886f;
        const glm::vec3 light = shared::leaf_surface_lit(
            shared::leaf_surface_of(texel, through), glm::vec3(scene[0].sky.sunlight) * sun, facing,
            gathered.irradiance(n) * over_pi, gathered.irradiance(-n) * over_pi);
        const glm::vec3 away = position - glm::vec3(scene[0].camera);
        return {glm::vec4(shared::meadow_through_air(around[0], scene[0].sky, light, away), 1.0f),
                true};
    }
};

} // namespace skybark::kernels
