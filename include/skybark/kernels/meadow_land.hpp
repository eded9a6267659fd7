#pragma once
// meadow_land: draws rolling land in sun, shadow, clouds' shadow and gathered light.

#include <skybark/kernels/meadow_scene.hpp>

namespace skybark::kernels {

/// Buffers: vertices, whose u is the number of the irradiance that they show; one scene; its
/// surroundings; irradiances (rgb). Images: the shadow map. Volumes: the sun's attenuation by
/// clouds.
struct meadow_land {
    using buffers = buffer_list<readonly<surface_vertex>, readonly<scene_record>,
                                readonly<surroundings_record>, readonly<glm::vec4>>;
    static constexpr std::uint32_t images = 1;
    static constexpr std::uint32_t volumes = 1;
    static constexpr std::uint32_t varyings = 3;

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, varyings>& out,
                     std::span<const surface_vertex> vertices, std::span<const scene_record> scene,
                     std::span<const surroundings_record>,
                     std::span<const glm::vec4> irradiance) const {
        const surface_vertex& v = vertices[index];
        out = {glm::vec4(v.position, 0), glm::vec4(v.normal, 0),
               irradiance[static_cast<std::uint32_t>(v.u)]};
        return scene[0].to_clip * glm::vec4(v.position, 1.0f);
    }

    template <class Images>
    fragment_output
    fragment(const std::array<glm::vec4, varyings>& in, glm::vec2, bool, const Images& from,
             std::span<const surface_vertex>, std::span<const scene_record> scene,
             std::span<const surroundings_record> around, std::span<const glm::vec4>) const {
        const glm::vec3 position(in[0]);
        const glm::vec3 normal = glm::normalize(glm::vec3(in[1]));
        const glm::vec3 away = position - glm::vec3(scene[0].camera);
        const glm::vec3 albedo = shared::meadow_albedo(position.x, position.z, glm::length(away));
        const float sun =
            sun_at(scene[0], position, normal, from) * sun_behind_clouds(around[0], position, from);
        const glm::vec3 light =
            shared::meadow_lit(albedo, normal, scene[0].sky, sun, glm::vec3(in[2]));
        return {glm::vec4(shared::meadow_through_air(around[0], scene[0].sky, light, away), 1.0f),
                true};
    }
};

} // namespace skybark::kernels
