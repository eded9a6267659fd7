#pragma once
// develop: turns a scene-referred image into one for a display, samples × samples texels a pixel.
//
// The image for a display has 8 bits a channel. Before they are rounded, values are shifted by less
// than half a step, by an ordered pattern of 8 × 8 pixels, so that a clear sky has no contours.
// What is a whole number of steps stays so: black, white.

#include <skybark/kernels/scene.hpp>
#include <skybark/shared/dither.hpp>

namespace skybark::kernels {

/// Three vertices. Images: the scene-referred image, `samples` times as wide and high.
struct develop {
    using buffers = buffer_list<>;
    static constexpr std::uint32_t images = 1;
    static constexpr std::uint32_t varyings = 1;

    std::uint32_t samples = 1; ///< texels a pixel in each direction
    float exposure = 1;        ///< display value 1 over radiance

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, 1>&) const {
        return {index == 1 ? 3.0f : -1.0f, index == 2 ? 3.0f : -1.0f, 0.0f, 1.0f};
    }

    /// Each sample is developed before the mean is taken, so that edges against a bright sky stay
    /// smooth.
    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, 1>&, glm::vec2 pixel, bool,
                             const Images& from) const {
        glm::vec3 sum(0);
        const int side = static_cast<int>(samples);
        const glm::ivec2 first = glm::ivec2(pixel) * side;
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                const glm::vec4 c = from.fetch(0, first + glm::ivec2(x, y)) * exposure;
                sum += glm::vec3(shared::display(c.x), shared::display(c.y), shared::display(c.z));
            }
        }
        const glm::ivec2 at(pixel);
        const float shift = shared::ordered_dither(at.x, at.y) * (1.0f / 255.0f);
        return {glm::vec4(sum / static_cast<float>(side * side) + shift, 1.0f), true};
    }
};

} // namespace skybark::kernels
