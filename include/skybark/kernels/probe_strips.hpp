#pragma once
// probe_strips: an expansion into a list that exists to be checked. Every vertex says where in the
// output it belongs.

#include <skybark/core/kernel.hpp>

namespace skybark::kernels {

struct probe_strip_vertex {
    glm::vec4 place{0};   ///< element, strip, vertex of the strip, 1
    glm::vec4 payload{0}; ///< the element's own
};
static_assert(sizeof(probe_strip_vertex) == 32);

/// Buffers: how many triangles each strip of each element has (`strip_count` an element, 0 to
/// `most` each), and a payload an element.
struct probe_strips {
    using vertex = probe_strip_vertex;
    using buffers = buffer_list<readonly<std::uint32_t>, readonly<glm::vec4>>;
    using counts_span = std::span<const std::uint32_t>;
    using payloads_span = std::span<const glm::vec4>;

    std::uint32_t strip_count = 1; ///< strips an element
    std::uint32_t most = 1;        ///< triangles a strip, the upper bound

    [[nodiscard]] std::uint32_t strips() const { return strip_count; }
    [[nodiscard]] std::uint32_t strip_triangles() const { return most; }
    [[nodiscard]] std::uint32_t triangles(std::uint32_t i, std::uint32_t strip, counts_span counts,
                                          payloads_span) const {
        return counts[i * strip_count + strip];
    }

    template <class Sink>
    void strip(std::uint32_t i, std::uint32_t strip, std::uint32_t first, std::uint32_t count,
               Sink&& sink, counts_span, payloads_span payloads) const {
        for (std::uint32_t j = first; j < first + count; ++j) {
            sink(vertex{
                {static_cast<float>(i), static_cast<float>(strip), static_cast<float>(j), 1.0f},
                payloads[i]});
        }
    }
};

} // namespace skybark::kernels
