#pragma once
// How the CPU backend runs a kernel: with the kernel's own functions, or faster where there is a
// specialisation (hermite_branch.hpp, bark.hpp and wave_wind.hpp beside this). Both give the same
// bits.

#include <skybark/cpu/sinks.hpp>

#include <algorithm>

namespace skybark::cpu {

/// A layer of constant z of a volume of int32, x fastest.
struct layer_sums {
    std::int32_t* sums;
    std::uint32_t width;
    std::uint32_t height;
    std::uint32_t stride; ///< from a row to the next

    /// Adds; what leaves the 32 bits comes back in at their other end, as on GPUs.
    void add(std::uint64_t at, std::int32_t amount) const {
        sums[at] = static_cast<std::int32_t>(static_cast<std::uint32_t>(sums[at]) +
                                             static_cast<std::uint32_t>(amount));
    }
};

/// What there is without a specialisation. One that says `keeps_what_it_counts` also has `keep`,
/// which writes the triangles of a few elements to memory in the caches and counts them by that:
/// for kernels whose count costs as much as their triangles. One with a type `bins` accumulates by
/// that in place of slab_bins (layers.hpp).
template <class K>
struct plain_program {
    /// Maps over consecutive elements. Where the kernel names volumes, the first of the spans is
    /// the `grids` that read and write them.
    template <class... Spans>
    static void map(const K& kernel, range elements, Spans... spans) {
        for (std::uint32_t i = elements.first; i < elements.first + elements.count; ++i) {
            kernel.map(i, spans...);
        }
    }

    /// Maps over `count` voxels in a row, from `first` along x.
    template <class Grids, class... Spans>
    static void voxels(const K& kernel, glm::ivec3 first, std::uint32_t count, const Grids& grids,
                       Spans... spans) {
        for (std::uint32_t i = 0; i < count; ++i) {
            kernel.voxel({first.x + static_cast<int>(i), first.y, first.z}, grids, spans...);
        }
    }

    /// Adds one slab to the layer that it lies in.
    template <class... Spans>
    static void add_slab(const K& kernel, std::uint32_t element, std::uint32_t slab,
                         const layer_sums& to, Spans... spans) {
        const voxel_slab s = kernel.slab(element, slab, spans...);
        const int left = std::max(s.low.x, 0);
        const int right = std::min(s.high.x, static_cast<int>(to.width));
        const int low = std::max(s.low.y, 0);
        const int high = std::min(s.high.y, static_cast<int>(to.height));
        // Some columns at a time, so that the inner loop runs over neighbours.
        constexpr int some = 32;
        float lateral[some];
        for (int x = left; x < right; x += some) {
            const int columns = std::min(some, right - x);
            for (int i = 0; i < columns; ++i) {
                lateral[i] = kernel.lateral(element, x + i, s.slice, spans...);
            }
            float row = low < high ? kernel.row(element, low, spans...) : 0.0f;
            for (int y = low; y < high; ++y) {
                const float above = kernel.row(element, y + 1, spans...);
                const std::uint64_t first =
                    static_cast<std::uint64_t>(y) * to.stride + static_cast<std::uint64_t>(x);
                for (int i = 0; i < columns; ++i) {
                    to.add(first + static_cast<std::uint64_t>(i),
                           kernel.amount(lateral[i], row, above));
                }
                row = above;
            }
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
