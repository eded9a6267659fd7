#pragma once
// lit_branch: draws branch surfaces with furrowed bark in sun, shadow and sky light.

#include <skybark/kernels/scene.hpp>

namespace skybark::kernels {

/// Buffers: vertices, one scene. Images: the shadow map.
struct lit_branch {
    using buffers = buffer_list<readonly<surface_vertex>, readonly<scene_record>>;
    static constexpr std::uint32_t images = 1;
    static constexpr std::uint32_t varyings = 3;

    float relief = 3.0f;     ///< how far the furrows lean the normal
    std::uint32_t plain = 0; ///< 1: no bark, one colour

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, 3>& out,
                     std::span<const surface_vertex> vertices,
                     std::span<const scene_record> scene) const {
        const surface_vertex& v = vertices[index];
        out = {glm::vec4(v.position, v.u), glm::vec4(v.normal, v.v), v.tangent};
        return scene[0].to_clip * glm::vec4(v.position, 1.0f);
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, 3>& in, glm::vec2, bool,
                             const Images& shadow_map, std::span<const surface_vertex>,
                             std::span<const scene_record> scene) const {
        const glm::vec3 position(in[0]);
        const float u = in[0].w;
        const float v = in[1].w;
        const glm::vec3 geometric = glm::normalize(glm::vec3(in[1]));
        glm::vec3 n = geometric;
        glm::vec3 albedo(0.30f, 0.21f, 0.14f);
        if (plain == 0) {
            const float height = shared::bark_height(u, v, 12);
            albedo = shared::bark_albedo(height);
            const glm::vec3 t = glm::normalize(glm::vec3(in[2]));
            const glm::vec3 b = glm::cross(n, t) * in[2].w;
            const float du = shared::bark_height(u + 0.01f, v, 12) - height;
            const float dv = shared::bark_height(u, v + 0.01f, 12) - height;
            n = glm::normalize(n - t * (du * relief) - b * (dv * relief));
        }
        const glm::vec3 to_sun(scene[0].sky.to_sun);
        const float sun = glm::dot(geometric, to_sun) > 0.0f
                              ? sun_at(scene[0], position, geometric, shadow_map)
                              : 0.0f;
        return {glm::vec4(shared::lit(albedo, n, scene[0].sky, sun, ambient_of(scene[0], n)), 1.0f),
                true};
    }
};

} // namespace skybark::kernels
