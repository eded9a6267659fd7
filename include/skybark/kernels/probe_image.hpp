#pragma once
// probe_image: a draw that exists to be checked, and reads images.

#include <skybark/kernels/probe_surface.hpp>

namespace skybark::kernels {

/// How a probe's fragment reads its images.
enum class probe_read : std::uint32_t {
    fetch,         ///< image 0 at the pixel + (offset_x, offset_y)
    sample,        ///< image 0 at (u, v)
    size,          ///< the widths and heights of images 0 and 1
    fetch_second,  ///< image 1 as `fetch`
    sample_second, ///< image 1 as `sample`
};

/// Buffers: vertices, whose colour's x and y are the texture coordinates u and v.
struct probe_image {
    using buffers = buffer_list<readonly<probe_vertex>>;
    static constexpr std::uint32_t varyings = 1;
    static constexpr std::uint32_t images = 2;

    probe_read read = probe_read::fetch;
    std::int32_t offset_x = 0;
    std::int32_t offset_y = 0;

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, varyings>& out,
                     std::span<const probe_vertex> vertices) const {
        out[0] = vertices[index].color;
        return vertices[index].position;
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, varyings>& in, glm::vec2 pixel, bool,
                             const Images& sources, std::span<const probe_vertex>) const {
        const glm::ivec2 texel{static_cast<int>(pixel.x) + offset_x,
                               static_cast<int>(pixel.y) + offset_y};
        const glm::vec2 uv{in[0].x, in[0].y};
        switch (read) {
        case probe_read::fetch:
            return {sources.fetch(0, texel), true};
        case probe_read::sample:
            return {sources.sample(0, uv), true};
        case probe_read::size:
            return {{sources.size(0), sources.size(1)}, true};
        case probe_read::fetch_second:
            return {sources.fetch(1, texel), true};
        case probe_read::sample_second:
            return {sources.sample(1, uv), true};
        }
        return {};
    }
};

} // namespace skybark::kernels
