#pragma once
// clear_sky: draws a clear day's sky behind everything (Preetham, Shirley and Smits 1999).

#include <skybark/kernels/scene.hpp>

namespace skybark::kernels {

/// Three vertices. Buffers: one scene.
struct clear_sky {
    using buffers = buffer_list<readonly<scene_record>>;
    static constexpr std::uint32_t images = 0;
    static constexpr std::uint32_t varyings = 1;

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, 1>& out,
                     std::span<const scene_record> scene) const {
        const glm::vec4 p(index == 1 ? 3.0f : -1.0f, index == 2 ? 3.0f : -1.0f, 1.0f, 1.0f);
        out[0] = scene[0].from_clip * p;
        return p;
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, 1>& in, glm::vec2, bool, const Images&,
                             std::span<const scene_record> scene) const {
        const glm::vec3 to =
            glm::normalize(glm::vec3(in[0]) * (1.0f / in[0].w) - glm::vec3(scene[0].camera));
        return {glm::vec4(shared::sky_radiance(scene[0].sky, to), 1.0f), true};
    }
};

} // namespace skybark::kernels
