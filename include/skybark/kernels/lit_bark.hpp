#pragma once
// lit_bark: draws branch surfaces with bark from a normal map, in sun, shadow and sky light.

#include <skybark/kernels/scene.hpp>
#include <skybark/shared/surfaces.hpp>

namespace skybark::kernels {

/// Buffers: vertices, one scene. Images: the shadow map, and the bark's normal map with its heights
/// in alpha (trees::normal_map; sampled linearly, repeating). Where a vertex has no texture
/// direction (tangent.w is 0) the surface is plain.
struct lit_bark {
    using buffers = buffer_list<readonly<surface_vertex>, readonly<scene_record>>;
    static constexpr std::uint32_t images = 2;
    static constexpr std::uint32_t varyings = 3;

    glm::vec4 low{0.055f, 0.042f, 0.032f, 0}; ///< albedo at height 0
    glm::vec4 high{0.31f, 0.255f, 0.205f, 0}; ///< albedo at height 1
    float repeats_around = 1;                 ///< of the map for u from 0 to 1: a whole number
    float repeats_along = 1;                  ///< of the map for each metre of v
    float strength = 1;                       ///< of the normal map's slopes

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, 3>& out,
                     std::span<const surface_vertex> vertices,
                     std::span<const scene_record> scene) const {
        const surface_vertex& v = vertices[index];
        out = {glm::vec4(v.position, v.u), glm::vec4(v.normal, v.v), v.tangent};
        return scene[0].to_clip * glm::vec4(v.position, 1.0f);
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, 3>& in, glm::vec2, bool,
                             const Images& maps, std::span<const surface_vertex>,
                             std::span<const scene_record> scene) const {
        const glm::vec3 position(in[0]);
        const glm::vec3 geometric = glm::normalize(glm::vec3(in[1]));
        const glm::vec4 texel =
            maps.sample(1, glm::vec2(in[0].w * repeats_around, in[1].w * repeats_along));
        const auto surface = shared::bark_surface_of(texel, geometric, in[2], glm::vec3(low),
                                                     glm::vec3(high), strength);
        const glm::vec3 to_sun(scene[0].sky.to_sun);
        const float sun =
            glm::dot(geometric, to_sun) > 0.0f ? sun_at(scene[0], position, geometric, maps) : 0.0f;
        return {glm::vec4(shared::lit(surface.albedo, surface.normal, scene[0].sky, sun,
                                      ambient_of(scene[0], surface.normal)),
                          1.0f),
                true};
    }
};

} // namespace skybark::kernels
