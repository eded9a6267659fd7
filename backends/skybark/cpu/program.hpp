#pragma once
// How the CPU backend runs a kernel: with the kernel's own functions, or faster where there is a
// specialisation (hermite_branch.hpp, bark.hpp and wave_wind.hpp beside this). Both give the same
// bits.

#include <skybark/cpu/sinks.hpp>

namespace skybark::cpu {

/// What there is without a specialisation. One that says `keeps_what_it_counts` also has `keep`,
/// which writes the triangles of a few elements to memory in the caches and counts them by that:
/// for kernels whose count costs as much as their triangles.
template <class K>
struct plain_program {
    /// Maps over consecutive elements.
    template <class... Spans>
    static void map(const K& kernel, range elements, Spans... spans) {
        for (std::uint32_t i = elements.first; i < elements.first + elements.count; ++i) {
            kernel.map(i, spans...);
        }
    }

    /// Writes the vertices of consecutive elements from `to` on.
    template <class... Spans>
    static void rings(const K& kernel, range elements, std::byte* to, Spans... spans) {
        vertex_sink<typename K::vertex> sink{to};
        const std::uint32_t vertices = kernel.ring_vertices();
        for (std::uint32_t i = elements.first; i < elements.first + elements.count; ++i) {
            kernel.ring(i, 0, vertices, sink, spans...);
        }
    }

    /// How many triangles consecutive elements become.
    template <class... Spans>
    [[nodiscard]] static std::uint64_t count(const K& kernel, range elements, Spans... spans) {
        std::uint64_t triangles = 0;
        for (std::uint32_t i = elements.first; i < elements.first + elements.count; ++i) {
            for (std::uint32_t s = 0; s < kernel.strips(); ++s) {
                triangles += kernel.triangles(i, s, spans...);
            }
        }
        return triangles;
    }

    /// Hands the triangles of consecutive elements to the sink.
    template <class Sink, class... Spans>
    static void triangles(const K& kernel, range elements, Sink& sink, Spans... spans) {
        for (std::uint32_t i = elements.first; i < elements.first + elements.count; ++i) {
            for (std::uint32_t s = 0; s < kernel.strips(); ++s) {
                strip(kernel, i, s, sink, spans...);
            }
        }
    }

    /// Hands those of one strip to the sink, and says how many.
    template <class Sink, class... Spans>
    static std::uint32_t strip(const K& kernel, std::uint32_t element, std::uint32_t strip,
                               Sink& sink, Spans... spans) {
        const std::uint32_t triangles = kernel.triangles(element, strip, spans...);
        if (triangles != 0) {
            sink.begin_strip();
            kernel.strip(element, strip, 0, triangles + 2, sink, spans...);
        }
        return triangles;
    }
};

template <class K>
struct program : plain_program<K> {};

} // namespace skybark::cpu
