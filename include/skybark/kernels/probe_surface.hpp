#pragma once
// probe_surface: a draw that exists to be checked, of vertices that are in clip space already.

#include <skybark/core/kernel.hpp>

namespace skybark::kernels {

struct probe_vertex {
    glm::vec4 position{0}; ///< in clip space
    glm::vec4 color{0};
};
static_assert(sizeof(probe_vertex) == 32);

/// What a probe's fragment shows.
enum class probe_show : std::uint32_t {
    color, ///< the vertices' colour · tints[tint]
    place, ///< the pixel's x and y, 1 where the front is seen, 1
};

/// Buffers: vertices; tints, which the fragments read.
struct probe_surface {
    using buffers = buffer_list<readonly<probe_vertex>, readonly<glm::vec4>>;
    using vertices_span = std::span<const probe_vertex>;
    using tints_span = std::span<const glm::vec4>;
    static constexpr std::uint32_t varyings = 1;
    static constexpr std::uint32_t images = 0;

    probe_show show = probe_show::color;
    std::uint32_t tint = 0;
    float cutoff = 0; ///< fragments with less alpha than this are discarded

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, varyings>& out,
                     vertices_span vertices, tints_span) const {
        out[0] = vertices[index].color;
        return vertices[index].position;
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, varyings>& in, glm::vec2 pixel, bool front,
                             const Images&, vertices_span, tints_span tints) const {
        if (show == probe_show::place) {
            return {{pixel.x, pixel.y, front ? 1.0f : 0.0f, 1.0f}, true};
        }
        const glm::vec4 color = in[0] * tints[tint];
        return {color, color.w >= cutoff};
    }
};

} // namespace skybark::kernels
