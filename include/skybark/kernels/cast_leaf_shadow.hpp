#pragma once
// cast_leaf_shadow: draws leaves, cut out of their pictures, into the sun's depth image.

#include <skybark/kernels/scene.hpp>

namespace skybark::kernels {

/// Buffers: vertices, one scene. Image: the leaf's picture, as for lit_leaf.
struct cast_leaf_shadow {
    using buffers = buffer_list<readonly<surface_vertex>, readonly<scene_record>>;
    static constexpr std::uint32_t images = 1;
    static constexpr std::uint32_t varyings = 1;

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, 1>& out,
                     std::span<const surface_vertex> vertices,
                     std::span<const scene_record> scene) const {
        const surface_vertex& v = vertices[index];
        out = {glm::vec4(v.u, v.v, 0, 0)};
        return scene[0].to_shadow * glm::vec4(v.position, 1.0f);
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, 1>& in, glm::vec2, bool,
                             const Images& pictures, std::span<const surface_vertex>,
                             std::span<const scene_record>) const {
        return {{}, pictures.sample(0, glm::vec2(in[0].x, in[0].y)).w >= 0.5f};
    }
};

} // namespace skybark::kernels
