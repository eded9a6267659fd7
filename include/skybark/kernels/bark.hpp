#pragma once
// bark: a triangle becomes one to four, split at the midpoints of its long edges, and each of those
// again, for some levels; the midpoints are moved by a height map along the smooth normal.
// Source: Akagi and Kitajima, sections 2.3 and 3.3, with the normal and the decision of the edge in
// place of the face's, so that neighbours stay together.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/bark.hpp>

namespace skybark::kernels {

/// Buffers: vertices, indices (read where `indexed`; any buffer otherwise), and width · height
/// heights of 0 … 1 in rows, which repeat in both directions. An element is a triangle.
///
/// An edge is split where it is longer than the threshold. Its midpoint stands relief · (height
/// there − mean height at the ends) out of it along the mean normal, at most `steepest` of the
/// edge's length. So after n levels a vertex stands out by its height less what the heights at the
/// corners of the first triangle, interpolated, say there; and those corners stay where they are.
/// Vertices whose tangent.w is 0 have no texture direction: an edge that ends at one is split by
/// the same rule, but its midpoint stays on the chord, and has w = 0 itself.
///
/// `levels` levels in one pass give the triangles of as many passes of one level, in the same order
/// and with the same bits. A strip is one triangle: strip s follows the path whose children are the
/// digits of s to the base 4, the first level's first; what isn't split is its own child 0.
///
/// No cracks: triangles that share an edge, with the same position, normal, v, w and u up to whole
/// numbers / repeats_around at both ends, split it alike.
struct bark {
    using vertex = surface_vertex;
    using buffers = buffer_list<readonly<surface_vertex>, readonly<std::uint32_t>, readonly<float>>;
    using vertices_span = std::span<const surface_vertex>;
    using indices_span = std::span<const std::uint32_t>;
    using heights_span = std::span<const float>;

    std::uint32_t indexed = 0;     ///< 0: triangle t is vertices 3t … 3t + 2, without indices
    std::uint32_t base_vertex = 0; ///< added to each index
    std::uint32_t width = 1;       ///< of the map, texels around the branch
    std::uint32_t height = 1;      ///< of the map, texels along the branch
    float repeats_around = 1;      ///< of the map for u from 0 to 1: a whole number
    float repeats_along = 1;       ///< of the map for each metre of v
    float relief = 0;              ///< m, from height 0 to height 1
    float threshold = 1;           ///< m, > 0; longer edges are split
    float steepest = 0.2f;         ///< a midpoint rises by at most this much of its edge
    float rounding = 0;            ///< 1: midpoints on the curve that the normals ask for; 0: chord
    std::uint32_t levels = 1;      ///< of splitting, 1 … 15

    [[nodiscard]] std::uint32_t strips() const { return 1u << (2 * levels); }
    [[nodiscard]] std::uint32_t strip_triangles() const { return 1; }
    [[nodiscard]] std::uint32_t triangles(std::uint32_t i, std::uint32_t strip,
                                          vertices_span vertices, indices_span indices,
                                          heights_span heights) const {
        triangle t = corners(i, vertices, indices);
        return descend(t, strip, heights) && strip % 4 < shared::bark_triangles(pattern(t)) ? 1 : 0;
    }

    template <class Sink>
    void strip(std::uint32_t i, std::uint32_t strip, std::uint32_t first, std::uint32_t count,
               Sink&& sink, vertices_span vertices, indices_span indices,
               heights_span heights) const {
        triangle t = corners(i, vertices, indices);
        if (descend(t, strip, heights)) {
            const std::uint32_t split = pattern(t);
            const bool other = takes_other_diagonal(t, split, strip % 4, heights);
            for (std::uint32_t j = first; j < first + count; ++j) {
                sink(point(t, shared::bark_corner(split, other, strip % 4, j), heights));
            }
        }
    }

    /// The map at texture coordinates of a vertex.
    [[nodiscard]] float height_at(float u, float v, heights_span heights) const {
        const shared::bark_texels t =
            shared::bark_texels_at(u * repeats_around, v * repeats_along, width, height);
        return shared::bark_between(t, heights[t.row0 + t.x0], heights[t.row0 + t.x1],
                                    heights[t.row1 + t.x0], heights[t.row1 + t.x1]);
    }

  private:
    using triangle = std::array<surface_vertex, 3>;

    [[nodiscard]] triangle corners(std::uint32_t i, vertices_span vertices,
                                   indices_span indices) const {
        triangle t;
        for (std::uint32_t k = 0; k < 3; ++k) {
            t[k] = vertices[indexed != 0 ? base_vertex + indices[3 * i + k] : 3 * i + k];
        }
        return t;
    }

    /// Follows a strip's path through all levels but the last; false where there is no such child.
    [[nodiscard]] bool descend(triangle& t, std::uint32_t strip, heights_span heights) const {
        for (std::uint32_t level = levels; level > 1; --level) {
            const std::uint32_t child = (strip >> (2 * (level - 1))) % 4;
            const std::uint32_t split = pattern(t);
            if (child >= shared::bark_triangles(split)) {
                return false;
            }
            if (split != 0) {
                const bool other = takes_other_diagonal(t, split, child, heights);
                t = {point(t, shared::bark_corner(split, other, child, 0), heights),
                     point(t, shared::bark_corner(split, other, child, 1), heights),
                     point(t, shared::bark_corner(split, other, child, 2), heights)};
            }
        }
        return true;
    }

    [[nodiscard]] std::uint32_t pattern(const triangle& t) const {
        return shared::bark_pattern(t[0].position, t[1].position, t[2].position, threshold);
    }

    /// Corner or midpoint 0 … 5 of the triangle.
    [[nodiscard]] surface_vertex point(const triangle& t, std::uint32_t code,
                                       heights_span heights) const {
        return code < 3 ? t[code] : midpoint(t[code - 3], t[code == 5 ? 0 : code - 2], heights);
    }

    [[nodiscard]] surface_vertex midpoint(const surface_vertex& p, const surface_vertex& q,
                                          heights_span heights) const {
        const bool in_order = shared::bark_in_order(p.position, q.position);
        const surface_vertex& a = in_order ? p : q;
        const surface_vertex& b = in_order ? q : p;
        const surface_vertex m = shared::bark_middle(a, b);
        if (m.tangent.w == 0) {
            return m;
        }
        const float length = shared::sqrt(shared::bark_edge_square(a.position, b.position));
        const float rise =
            shared::bark_rise(length, height_at(a.u, a.v, heights), height_at(b.u, b.v, heights),
                              height_at(m.u, m.v, heights), relief, steepest);
        return shared::bark_raised(m, a, b, rise, rounding);
    }

    /// Whether a child lies at the second diagonal, because that is the shorter one.
    [[nodiscard]] bool takes_other_diagonal(const triangle& t, std::uint32_t split,
                                            std::uint32_t child, heights_span heights) const {
        if (!shared::bark_has_two(split) || child == 0) {
            return false;
        }
        const auto square = [&](bool other) {
            // The two corners that triangle 1 and triangle 2 of this diagonal share.
            const std::uint32_t from = shared::bark_corner(split, other, 1, other ? 0 : 1);
            const std::uint32_t to = shared::bark_corner(split, other, 1, 2);
            return shared::bark_edge_square(point(t, from, heights).position,
                                            point(t, to, heights).position);
        };
        return square(true) < square(false);
    }
};

} // namespace skybark::kernels
