#pragma once
// meadow_bark: draws branches with bark from a normal map, in sun, shadow, clouds' shadow and
// gathered light.

#include <skybark/kernels/meadow_scene.hpp>
#include <skybark/shared/surfaces.hpp>

namespace skybark::kernels {

/// Buffers: vertices, one scene, its surroundings. Images and parameters: as lit_bark's. Volumes:
/// the sun's attenuation by clouds, and the irradiance volume.
struct meadow_bark {
    using buffers = buffer_list<readonly<surface_vertex>, readonly<scene_record>,
                                readonly<surroundings_record>>;
    static constexpr std::uint32_t images = 2;
    static constexpr std::uint32_t volumes = 2;
    static constexpr std::uint32_t varyings = 3;

    glm::vec4 low{0.055f, 0.042f, 0.032f, 0}; ///< albedo at height 0
    glm::vec4 high{0.31f, 0.255f, 0.205f, 0}; ///< albedo at height 1
    float repeats_around = 1;                 ///< of the map for u from 0 to 1: a whole number
    float repeats_along = 1;                  ///< of the map for each metre of v
    float strength = 1;                       ///< of the normal map's slopes

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, varyings>& out,
                     std::span<const surface_vertex> vertices, std::span<const scene_record> scene,
                     std::span<const surroundings_record>) const {
        const surface_vertex& v = vertices[index];
        out = {glm::vec4(v.position, v.u), glm::vec4(v.normal, v.v), v.tangent};
        return scene[0].to_clip * glm::vec4(v.position, 1.0f);
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, varyings>& in, glm::vec2, bool,
                             const Images& from, std::span<const surface_vertex>,
                             std::span<const scene_record> scene,
                             std::span<const surroundings_record> around) const {
        const glm::vec3 position(in[0]);
        const glm::vec3 geometric = glm::normalize(glm::vec3(in[1]));
        const glm::vec4 texel =
            from.sample(1, glm::vec2(in[0].w * repeats_around, in[1].w * repeats_along));
        const auto surface = shared::bark_surface_of(texel, geometric, in[2], glm::vec3(low),
                                                     glm::vec3(high), strength);
        const bool faces = glm::dot(geometric, glm::vec3(scene[0].sky.to_sun)) > 0.0f;
        const float sun = faces ? sun_at(scene[0], position, geometric, from) *
                                      sun_behind_clouds(around[0], position, from)
                                : 0.0f;
        const glm::vec3 gathered =
            gathered_at(around[0], position, from).irradiance(surface.normal);
        const glm::vec3 light =
            shared::meadow_lit(surface.albedo, surface.normal, scene[0].sky, sun, gathered);
        const glm::vec3 away = position - glm::vec3(scene[0].camera);
        return {glm::vec4(shared::meadow_through_air(around[0], scene[0].sky, light, away), 1.0f),
                true};
    }
};

} // namespace skybark::kernels
