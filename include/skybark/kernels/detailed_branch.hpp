#pragma once
// detailed_branch: hermite_branch with as many sides and rings as are to be seen.

#include <skybark/kernels/hermite_branch.hpp>
#include <skybark/kernels/segment_rings.hpp>

namespace skybark::kernels {

/// Buffers: segments, ends, the polygon's corners (`unit_polygon(sides)`), the ends' detail and the
/// segments' detail. Strips as hermite_branch has them: caps first and last, gaps in between.
///
/// Where both ends and the segment have full detail, the bits are hermite_branch's. Between levels
/// new corners and rings rise from the chord that stands for them without, so that none appears at
/// a distance. Two segments that share an end have the same outline there; where one has more
/// corners, they lie on the other's chords to within rounding.
struct detailed_branch {
    using vertex = surface_vertex;
    using buffers = buffer_list<readonly<branch_segment>, readonly<branch_end>, readonly<glm::vec4>,
                                readonly<end_detail>, readonly<segment_detail>>;
    using segments_span = std::span<const branch_segment>;
    using ends_span = std::span<const branch_end>;
    using corners_span = std::span<const glm::vec4>;
    using details_span = std::span<const end_detail>;
    using rings_span = std::span<const segment_detail>;

    std::uint32_t sides = 8; ///< of full detail
    std::uint32_t rings = 4; ///< of full detail, both ends included
    branch_frame frame = branch_frame::slerp;
    std::uint32_t fewest_sides = 4; ///< least_sides(sides)

    [[nodiscard]] std::uint32_t strips() const { return rings + 1; }
    [[nodiscard]] std::uint32_t strip_triangles() const { return 2 * sides; }
    [[nodiscard]] std::uint32_t triangles(std::uint32_t i, std::uint32_t strip, segments_span,
                                          ends_span, corners_span, details_span,
                                          rings_span made_of) const {
        const segment_detail& d = made_of[i];
        if (strip == 0 || strip == rings) {
            return (d.caps & (strip == 0 ? cap_start : cap_end)) != 0 ? d.sides - 2 : 0;
        }
        return strip <= d.gaps ? 2 * d.sides : 0;
    }

    template <class Sink>
    void strip(std::uint32_t i, std::uint32_t strip, std::uint32_t first, std::uint32_t count,
               Sink&& sink, segments_span segments, ends_span ends, corners_span corners,
               details_span details, rings_span made_of) const {
        const branch_segment& segment = segments[i];
        const segment_detail& d = made_of[i];
        const end_detail& da = details[segment.start];
        const end_detail& db = details[segment.end];
        branch_end a = ends[segment.start];
        branch_end b = ends[segment.end];
        a.radius = a.radius * da.scale;
        b.radius = b.radius * db.scale;
        const shared::ring_outline outline_a = shared::outline_of(da.sides, fewest_sides, sides);
        const shared::ring_outline outline_b = shared::outline_of(db.sides, fewest_sides, sides);
        const std::uint32_t step = sides / d.sides;
        if (strip == 0 || strip == rings) {
            const bool base = strip == 0;
            const shared::branch_ring r = shared::branch_ring_at_end(base ? a : b);
            const shared::ring_outline& outline = base ? outline_a : outline_b;
            for (std::uint32_t j = first; j < first + count; ++j) {
                const std::uint32_t corner = shared::branch_cap_corner(j, d.sides, base) * step;
                sink(shared::outline_cap_vertex(r, point_at(outline, corner, corners), base));
            }
            return;
        }
        const shared::branch_curve curve = shared::branch_curve_between(a, b);
        const moving_ring lower = moving_ring_at(a, b, curve, strip - 1, d);
        const moving_ring upper = moving_ring_at(a, b, curve, strip, d);
        for (std::uint32_t j = first; j < first + count; ++j) {
            const std::uint32_t corner = j / 2 * step;
            const glm::vec2 p = point_at(outline_a, corner, corners);
            const glm::vec2 q = point_at(outline_b, corner, corners);
            sink(vertex_of(j % 2 == 0 ? upper : lower, p, q, corners[corner]));
        }
    }

  private:
    /// A ring of the segment, or where it is on its way to the chord between two others.
    struct moving_ring {
        shared::branch_ring own;
        shared::branch_ring before{};
        shared::branch_ring after{};
        float weight = 0; ///< of the outline at the segment's end
        float before_weight = 0;
        float after_weight = 0;
        float w = 0;
        float fraction = 1;
    };

    [[nodiscard]] static glm::vec2 point_at(const shared::ring_outline& outline,
                                            std::uint32_t corner, corners_span corners) {
        return shared::point_of_outline(outline, corner,
                                        corners[shared::outline_before(outline, corner)],
                                        corners[shared::outline_after(outline, corner)]);
    }

    /// Ring k of those that the segment has. Of all its gaps, every so-many-th was there before.
    [[nodiscard]] moving_ring moving_ring_at(const branch_end& a, const branch_end& b,
                                             const shared::branch_curve& curve, std::uint32_t k,
                                             const segment_detail& d) const {
        const std::uint32_t step = (rings - 1) / d.gaps;
        const std::uint32_t kept = shared::least_factor(d.gaps);
        moving_ring m{ring_at(a, b, curve, k * step)};
        m.weight = shared::outline_weight(m.own, b, part(k * step));
        if (d.fraction < 1 && k % kept != 0) {
            const std::uint32_t first = k / kept * kept;
            m.before = ring_at(a, b, curve, first * step);
            m.after = ring_at(a, b, curve, (first + kept) * step);
            m.before_weight = shared::outline_weight(m.before, b, part(first * step));
            m.after_weight = shared::outline_weight(m.after, b, part((first + kept) * step));
            m.w = static_cast<float>(k - first) / static_cast<float>(kept);
            m.fraction = d.fraction;
        }
        return m;
    }

    [[nodiscard]] static surface_vertex vertex_of(const moving_ring& m, const glm::vec2& p,
                                                  const glm::vec2& q, const glm::vec4& corner) {
        const surface_vertex own =
            shared::outline_vertex(m.own, shared::mix_outlines(p, q, m.weight), corner);
        if (!(m.fraction < 1)) {
            return own;
        }
        return shared::between_vertices(
            own,
            shared::outline_vertex(m.before, shared::mix_outlines(p, q, m.before_weight), corner),
            shared::outline_vertex(m.after, shared::mix_outlines(p, q, m.after_weight), corner),
            m.w, m.fraction);
    }

    [[nodiscard]] float part(std::uint32_t k) const {
        return static_cast<float>(k) / static_cast<float>(rings - 1);
    }

    [[nodiscard]] shared::branch_ring ring_at(const branch_end& a, const branch_end& b,
                                              const shared::branch_curve& curve,
                                              std::uint32_t k) const {
        if (frame == branch_frame::slerp) {
            return shared::branch_ring_slerp(a, b, curve, part(k));
        }
        return shared::branch_ring_rotation_minimising(a, b, curve, k, rings - 1);
    }
};

} // namespace skybark::kernels
