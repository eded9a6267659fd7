#pragma once
// cloud_layer: puts a picture of clouds that was drawn by itself behind what is there.

#include <skybark/core/kernel.hpp>

#include <glm/vec2.hpp>

namespace skybark::kernels {

/// Three vertices, over all of the screen at the far plane: with a depth test, only where nothing
/// is. Images: premultiplied colour and alpha, of any size. With blend_mode::alpha.
struct cloud_layer {
    using buffers = buffer_list<>;
    static constexpr std::uint32_t images = 1;
    static constexpr std::uint32_t varyings = 1;

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, 1>& out) const {
        const glm::vec4 p(index == 1 ? 3.0f : -1.0f, index == 2 ? 3.0f : -1.0f, 1.0f, 1.0f);
        out[0] = glm::vec4(0.5f + 0.5f * p.x, 0.5f - 0.5f * p.y, 0.0f, 0.0f);
        return p;
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, 1>& in, glm::vec2, bool,
                             const Images& from) const {
        const glm::vec4 cloud = from.sample(0, glm::vec2(in[0]));
        return {cloud, cloud.w > 0.0f};
    }
};

} // namespace skybark::kernels
