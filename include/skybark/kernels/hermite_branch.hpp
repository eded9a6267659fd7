#pragma once
// hermite_branch: a branch segment becomes rings of a polygon along a cubic Hermite curve.
// Source: Akagi and Kitajima, sections 2.2 and 3.3, equations 1 and 2.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/branch.hpp>

namespace skybark::kernels {

/// How the rings between a segment's two ends are turned.
enum class branch_frame : std::uint32_t {
    slerp,              ///< spherical interpolation of the ends' orientations (the paper's way)
    rotation_minimising ///< no twist but what the ends ask for (Wang et al. 2008)
};

/// Buffers: segments, ends, and the polygon's corners (`unit_polygon(sides)`).
///
/// As rings: rings · (sides + 1) vertices a segment, the seam's twice, and the tube's triangles.
/// As a list: rings + 1 strips a segment, of which the first and last are caps where the segment
/// asks for them.
struct hermite_branch {
    using vertex = surface_vertex;
    using buffers =
        buffer_list<readonly<branch_segment>, readonly<branch_end>, readonly<glm::vec4>>;
    using segments_span = std::span<const branch_segment>;
    using ends_span = std::span<const branch_end>;
    using corners_span = std::span<const glm::vec4>;

    std::uint32_t sides = 8; ///< of the polygon, at least 3
    std::uint32_t rings = 4; ///< along a segment, both ends included, at least 2
    branch_frame frame = branch_frame::slerp;

    [[nodiscard]] std::uint32_t ring_vertices() const { return rings * (sides + 1); }
    [[nodiscard]] std::uint32_t ring_triangles() const { return 2 * sides * (rings - 1); }
    [[nodiscard]] std::uint32_t ring_index(std::uint32_t k) const {
        const std::uint32_t triangle = k / 3;
        const std::uint32_t gap = triangle / (2 * sides);
        const std::uint32_t t = triangle % (2 * sides);
        // Vertex i of the strip between rings `gap` and `gap + 1`: upper, lower, upper, …
        const std::uint32_t swapped = k % 3 < 2 && t % 2 == 1 ? 1 - k % 3 : k % 3;
        const std::uint32_t i = t + swapped;
        return (gap + 1 - i % 2) * (sides + 1) + i / 2;
    }

    template <class Sink>
    void ring(std::uint32_t i, std::uint32_t first, std::uint32_t count, Sink&& sink,
              segments_span segments, ends_span ends, corners_span corners) const {
        const branch_end& a = ends[segments[i].start];
        const branch_end& b = ends[segments[i].end];
        const shared::branch_curve curve = shared::branch_curve_between(a, b);
        const std::uint32_t around = sides + 1;
        const std::uint32_t last = first + count;
        for (std::uint32_t k = first / around; k * around < last; ++k) {
            const shared::branch_ring r = ring_at(a, b, curve, k);
            const std::uint32_t corner_last = std::min(last - k * around, around);
            for (std::uint32_t c = std::max(first, k * around) - k * around; c < corner_last; ++c) {
                sink(shared::branch_vertex(r, corners[c]));
            }
        }
    }

    [[nodiscard]] std::uint32_t strips() const { return rings + 1; }
    [[nodiscard]] std::uint32_t strip_triangles() const { return 2 * sides; }
    [[nodiscard]] std::uint32_t triangles(std::uint32_t i, std::uint32_t strip,
                                          segments_span segments, ends_span, corners_span) const {
        if (strip == 0 || strip == rings) {
            const std::uint32_t cap = strip == 0 ? cap_start : cap_end;
            return (segments[i].caps & cap) != 0 ? sides - 2 : 0;
        }
        return 2 * sides;
    }

    template <class Sink>
    void strip(std::uint32_t i, std::uint32_t strip, std::uint32_t first, std::uint32_t count,
               Sink&& sink, segments_span segments, ends_span ends, corners_span corners) const {
        const branch_end& a = ends[segments[i].start];
        const branch_end& b = ends[segments[i].end];
        if (strip == 0 || strip == rings) {
            const bool base = strip == 0;
            const shared::branch_ring r = shared::branch_ring_at_end(base ? a : b);
            for (std::uint32_t j = first; j < first + count; ++j) {
                const std::uint32_t corner = shared::branch_cap_corner(j, sides, base);
                sink(shared::branch_cap_vertex(r, corners[corner], base));
            }
            return;
        }
        const shared::branch_curve curve = shared::branch_curve_between(a, b);
        const shared::branch_ring lower = ring_at(a, b, curve, strip - 1);
        const shared::branch_ring upper = ring_at(a, b, curve, strip);
        for (std::uint32_t j = first; j < first + count; ++j) {
            sink(shared::branch_vertex(j % 2 == 0 ? upper : lower, corners[j / 2]));
        }
    }

  private:
    [[nodiscard]] shared::branch_ring ring_at(const branch_end& a, const branch_end& b,
                                              const shared::branch_curve& curve,
                                              std::uint32_t k) const {
        if (frame == branch_frame::slerp) {
            const float t = static_cast<float>(k) / static_cast<float>(rings - 1);
            return shared::branch_ring_slerp(a, b, curve, t);
        }
        return shared::branch_ring_rotation_minimising(a, b, curve, k, rings - 1);
    }
};

} // namespace skybark::kernels
