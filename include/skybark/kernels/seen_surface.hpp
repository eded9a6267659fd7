#pragma once
// seen_surface: which place of which triangle each pixel sees: where a picture asks for light.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/alpha_map.hpp>

#include <cmath>
#include <glm/geometric.hpp>

namespace skybark::kernels {

/// Three vertices a triangle. Buffers: triangles; alpha: words, as alpha_coordinates says. The
/// target, cleared to (0, 0, 0, −1), becomes u, v (the barycentric weights of b and c), and the
/// triangle's number: its lower 11 bits times 2, + 1 where its back is seen, and the bits above. w
/// stays −1 where nothing is seen.
struct seen_surface {
    using buffers = buffer_list<readonly<gather_triangle>, readonly<std::uint32_t>>;
    static constexpr std::uint32_t images = 0;
    static constexpr std::uint32_t varyings = 2;

    glm::vec4 to_clip_x{1, 0, 0, 0}; ///< rows of the matrix from the world to clip space
    glm::vec4 to_clip_y{0, 1, 0, 0};
    glm::vec4 to_clip_z{0, 0, 1, 0};
    glm::vec4 to_clip_w{0, 0, 0, 1};

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, varyings>& out,
                     std::span<const gather_triangle> triangles,
                     std::span<const std::uint32_t>) const {
        const std::uint32_t number = index / 3;
        const std::uint32_t corner = index % 3;
        const gather_triangle t = triangles[number];
        const glm::vec3 place = corner == 0 ? t.a : corner == 1 ? t.b : t.c;
        // Interpolation rounds: whole numbers of 11 bits survive it.
        out[0] = glm::vec4(corner == 1 ? 1.0f : 0.0f, corner == 2 ? 1.0f : 0.0f,
                           static_cast<float>(number % 2048), static_cast<float>(number / 2048));
        out[1] =
            glm::vec4(static_cast<float>(t.alpha % 2048), static_cast<float>(t.alpha / 2048), 0, 0);
        const glm::vec4 p(place, 1);
        return {glm::dot(to_clip_x, p), glm::dot(to_clip_y, p), glm::dot(to_clip_z, p),
                glm::dot(to_clip_w, p)};
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, varyings>& in, glm::vec2, bool front,
                             const Images&, std::span<const gather_triangle>,
                             std::span<const std::uint32_t> alpha) const {
        const float u = glm::clamp(in[0].x, 0.0f, 1.0f);
        const float v = glm::clamp(in[0].y, 0.0f, 1.0f - u);
        if (is_hole(2048 * whole(in[1].y) + whole(in[1].x), u, v, alpha)) {
            return {{}, false};
        }
        const float low = std::floor(in[0].z + 0.5f);
        const float high = std::floor(in[0].w + 0.5f);
        return {glm::vec4(u, v, 2.0f * low + (front ? 0.0f : 1.0f), high), true};
    }

  private:
    [[nodiscard]] static std::uint32_t whole(float number) {
        return static_cast<std::uint32_t>(number + 0.5f);
    }

    [[nodiscard]] static bool is_hole(std::uint32_t number, float u, float v,
                                      std::span<const std::uint32_t> alpha) {
        if (number == 0) {
            return false;
        }
        const std::size_t at = std::size_t{12} * (number - 1);
        const auto value = [&](std::size_t word) { return glm::uintBitsToFloat(alpha[at + word]); };
        const std::uint32_t size = alpha[at + 7];
        const std::uint32_t column = shared::alpha_texel(
            shared::alpha_place(value(0), value(2), value(4), u, v), size & 0xffffu);
        const std::uint32_t row = shared::alpha_texel(
            shared::alpha_place(value(1), value(3), value(5), u, v), size >> 16);
        const std::size_t texel = alpha[at + 6] + std::size_t{row} * (size & 0xffffu) + column;
        return glm::uintBitsToFloat(alpha[texel]) < value(8);
    }
};
static_assert(sizeof(seen_surface) == 64);

} // namespace skybark::kernels
