#pragma once
// cast_shadow: draws surfaces into the sun's depth image.

#include <skybark/kernels/scene.hpp>

namespace skybark::kernels {

/// Buffers: vertices, one scene.
struct cast_shadow {
    using buffers = buffer_list<readonly<surface_vertex>, readonly<scene_record>>;
    static constexpr std::uint32_t images = 0;
    static constexpr std::uint32_t varyings = 1;

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, 1>&,
                     std::span<const surface_vertex> vertices,
                     std::span<const scene_record> scene) const {
        return scene[0].to_shadow * glm::vec4(vertices[index].position, 1.0f);
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, 1>&, glm::vec2, bool, const Images&,
                             std::span<const surface_vertex>, std::span<const scene_record>) const {
        return {};
    }
};

} // namespace skybark::kernels
