#pragma once
// probe_volume_draw: a draw that exists to be checked, and reads volumes beside an image.

#include <skybark/kernels/probe_surface.hpp>

namespace skybark::kernels {

/// How a probe's fragment reads its volumes.
enum class probe_volume_read : std::uint32_t {
    sample, ///< volumes 0 and 1 at the vertices' colour; the image's red at its x and y; 1
    load,   ///< volumes 0 and 1 at (the pixel's x and y, layer); the image's red at the pixel; 1
    size,   ///< the sides of volume 0, and the width of volume 1
};

/// Buffers: vertices, whose colour's x, y and z are the place in the volumes.
struct probe_volume_draw {
    using buffers = buffer_list<readonly<probe_vertex>>;
    static constexpr std::uint32_t varyings = 1;
    static constexpr std::uint32_t images = 1;
    static constexpr std::uint32_t volumes = 2;

    probe_volume_read read = probe_volume_read::sample;
    std::int32_t layer = 0;

    glm::vec4 vertex(std::uint32_t index, std::array<glm::vec4, varyings>& out,
                     std::span<const probe_vertex> vertices) const {
        out[0] = vertices[index].color;
        return vertices[index].position;
    }

    template <class Images>
    fragment_output fragment(const std::array<glm::vec4, varyings>& in, glm::vec2 pixel, bool,
                             const Images& sources, std::span<const probe_vertex>) const {
        const glm::vec3 place(in[0]);
        const glm::ivec3 cell(static_cast<int>(pixel.x), static_cast<int>(pixel.y), layer);
        switch (read) {
        case probe_volume_read::sample:
            return {{sources.volume(0, place), sources.volume(1, place),
                     sources.sample(0, glm::vec2(place)).x, 1.0f},
                    true};
        case probe_volume_read::load:
            return {{sources.volume_load(0, cell), sources.volume_load(1, cell),
                     sources.fetch(0, glm::ivec2(cell)).x, 1.0f},
                    true};
        case probe_volume_read::size:
            return {glm::vec4(glm::vec3(sources.volume_size(0)),
                              static_cast<float>(sources.volume_size(1).x)),
                    true};
        }
        return {};
    }
};

} // namespace skybark::kernels
