#pragma once
// ring_indices: the index buffer that elements of equal topology share.

#include <skybark/core/kernel.hpp>

namespace skybark::kernels {

/// Buffers: one element's indices (`pattern_size` of them), the index buffer. Maps over indices.
struct ring_indices {
    using buffers = buffer_list<readonly<std::uint32_t>, writeonly<std::uint32_t>>;

    std::uint32_t pattern_size = 0;  ///< 3 · ring_triangles() of the ring kernel
    std::uint32_t ring_vertices = 0; ///< ring_vertices() of the ring kernel
    std::uint32_t base_vertex = 0;   ///< added to every index

    void map(std::uint32_t i, std::span<const std::uint32_t> pattern,
             std::span<std::uint32_t> indices) const {
        indices[i] = base_vertex + i / pattern_size * ring_vertices + pattern[i % pattern_size];
    }
};

} // namespace skybark::kernels
