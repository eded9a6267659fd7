#pragma once
// How the CPU backend runs a kernel: with the kernel's own functions, or faster where there is a
// specialisation (hermite_branch.hpp beside this). Both give the same bits.

#include <skybark/cpu/sinks.hpp>

namespace skybark::cpu {

template <class K>
struct program {
    /// Writes the vertices of consecutive elements from `to` on.
    template <class... Spans>
    static void rings(const K& kernel, range elements, std::byte* to, Spans... spans) {
        vertex_sink<typename K::vertex> sink{to};
        const std::uint32_t vertices = kernel.ring_vertices();
        for (std::uint32_t i = elements.first; i < elements.first + elements.count; ++i) {
            kernel.ring(i, 0, vertices, sink, spans...);
        }
    }
};

} // namespace skybark::cpu
