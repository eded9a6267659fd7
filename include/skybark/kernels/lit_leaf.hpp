#pragma once
// lit_leaf: draws leaves cut out of their pictures, in sun, shadow and sky light, from both sides.

#include <skybark/kernels/scene.hpp>
#include <skybark/shared/surfaces.hpp>

namespace skybark::kernels {

/// Buffers: vertices, one scene. Images: the shadow map, and the leaf's picture: sRGB and coverage,
/// its first row at the stalk. What is covered less than half is not drawn.
struct lit_leaf {
    using buffers = buffer_list<readonly<surface_vertex>, readonly<scene_record>>;
    static constexpr std::uint32_t images = 2;
    static constexpr std::uint32_t varyings = 2;

    float through = 0.8f; ///< green light that comes through over what is scattered back
    float sky = 0.75f;    ///< of the sky's light, what other leaves leave of it

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, 2>& out,
                     std::span<const surface_vertex> vertices,
                     std::span<const scene_record> scene) const {
        const surface_vertex& v = vertices[index];
        out = {glm::vec4(v.position, v.u), glm::vec4(v.normal, v.v)};
        return scene[0].to_clip * glm::vec4(v.position, 1.0f);
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, 2>& in, glm::vec2, bool front,
                             const Images& pictures, std::span<const surface_vertex>,
                             std::span<const scene_record> scene) const {
        const glm::vec4 texel = pictures.sample(1, glm::vec2(in[0].w, in[1].w));
        if (texel.w < 0.5f) {
            return {{}, false};
        }
        const glm::vec3 position(in[0]);
        const glm::vec3 upper = glm::normalize(glm::vec3(in[1]));
        const glm::vec3 n = front ? upper : -upper;
        const float facing = glm::dot(n, glm::vec3(scene[0].sky.to_sun));
        const float sun = sun_at(scene[0], position, facing > 0.0f ? n : -n, pictures);
        const glm::vec3 here = ambient_of(scene[0], n) * sky;
        const glm::vec3 behind = ambient_of(scene[0], -n) * sky;
        const glm::vec3 light = glm::vec3(scene[0].sky.sunlight) * sun;
        return {glm::vec4(shared::leaf_surface_lit(shared::leaf_surface_of(texel, through), light,
                                                   facing, here, behind),
                          1.0f),
                true};
    }
};

} // namespace skybark::kernels
