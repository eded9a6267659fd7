#pragma once
// probe_map: a map that exists to be checked. Exact on every backend for small integers.

#include <skybark/core/kernel.hpp>

namespace skybark::kernels {

/// Buffers: numbers and vectors in, numbers and vectors out, one of each an element.
struct probe_map {
    using buffers = buffer_list<readonly<std::uint32_t>, readonly<glm::vec4>,
                                writeonly<std::uint32_t>, writeonly<glm::vec4>>;

    std::uint32_t factor = 1; ///< number out: number · factor + offset + i, modulo 2³²
    std::uint32_t offset = 0;
    float scale = 1; ///< vector out: vector · scale + bias
    float bias = 0;

    void map(std::uint32_t i, std::span<const std::uint32_t> numbers,
             std::span<const glm::vec4> vectors, std::span<std::uint32_t> numbers_out,
             std::span<glm::vec4> vectors_out) const {
        numbers_out[i] = numbers[i] * factor + offset + i;
        vectors_out[i] = vectors[i] * scale + bias;
    }
};

} // namespace skybark::kernels
