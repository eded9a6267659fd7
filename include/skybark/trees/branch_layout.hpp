#pragma once
// From the skeleton to what the branch kernels read: ends, segments and caps.
//
// A chain is a segment, its continuation, that one's continuation, and so on. Inside a chain two
// segments share one end, so their rings agree bit for bit. A chain that is not a root's starts
// inside the segment that it grows from, at its own end, and is capped at both ends.

#include <skybark/core/when_used.hpp>
#include <skybark/kernels/hermite_branch.hpp>
#include <skybark/trees/skeleton.hpp>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace skybark::trees {

/// What is sent to a device for a skeleton; no polygons (Akagi and Kitajima, 3.2).
struct branch_layout {
    std::vector<branch_end> ends;
    std::vector<branch_segment> segments; ///< one a segment of the skeleton, in its order
    std::vector<end_carrier> carriers;    ///< one an end; segments of the skeleton move it
};

namespace detail {

/// The rotation that takes unit vector `from` to unit vector `to` the short way.
[[nodiscard]] inline glm::quat shortest_rotation(const glm::vec3& from, const glm::vec3& to) {
    const float cosine = glm::dot(from, to);
    if (cosine < -0.999999f) {
        const glm::vec3 axis = std::abs(from.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1);
        const glm::vec3 across = glm::normalize(glm::cross(from, axis));
        return {0, across.x, across.y, across.z};
    }
    const glm::vec3 axis = glm::cross(from, to);
    return glm::normalize(glm::quat(1 + cosine, axis.x, axis.y, axis.z));
}

[[nodiscard]] inline glm::vec4 as_vec4(const glm::quat& q) { return {q.x, q.y, q.z, q.w}; }

/// Walks the skeleton once, parents before children.
template <class = when_used>
class branch_layout_builder {
  public:
    branch_layout_builder(const skeleton& from, kernels::branch_frame frame)
        : from_(from), frames_(frame) {
        layout_.segments.resize(from.size());
        layout_.ends.reserve(from.size() + from.size() / 4 + 1);
        layout_.carriers.reserve(from.size() + from.size() / 4 + 1);
        frame_.resize(from.size());
        chord_.resize(from.size());
    }

    [[nodiscard]] branch_layout build() {
        for (std::uint32_t i = 0; i < from_.size(); ++i) {
            if (continues_parent(i)) {
                continue_chain(i);
            } else {
                start_chain(i);
            }
        }
        unfold();
        smooth_slopes();
        lower_slopes();
        return std::move(layout_);
    }

  private:
    /// The continuation, unless a gap in the data makes it turn back on its parent: then the
    /// centreline would fold.
    [[nodiscard]] bool continues_parent(std::uint32_t i) const {
        const std::uint32_t p = from_.parent[i];
        if (p == none || from_.continuation[p] != i) {
            return false;
        }
        const glm::vec3 chord = from_.tip(i) - layout_.ends[layout_.segments[p].end].position;
        return glm::dot(chord, chord_[p]) >= 0;
    }

    void continue_chain(std::uint32_t i) {
        const std::uint32_t p = from_.parent[i];
        layout_.segments[p].caps &= ~cap_end;
        const std::uint32_t joint = layout_.segments[p].end;
        finish(i, joint, frame_[p]);
        // The joint's ring lies half way between the two segments.
        layout_.ends[joint].orientation =
            shared::slerp(as_vec4(frame_[p]), as_vec4(frame_[i]), 0.5f);
        layout_.carriers[joint] = {p, p, i};
    }

    void start_chain(std::uint32_t i) {
        const std::uint32_t p = from_.parent[i];
        branch_end start;
        start.position = from_.position[i];
        start.radius = from_.base_radius[i];
        if (p != none) {
            start_inside(start, p);
        }
        const std::uint32_t index = add_end(start, {i, i, i});
        finish(i, index, from_.orientation[i]);
        layout_.ends[index].orientation = as_vec4(frame_[i]);
        layout_.segments[i].caps |= cap_start;
    }

    /// Moves the start of a side branch to the axis of its parent where it would begin outside,
    /// and makes it no thicker than the parent there.
    void start_inside(branch_end& start, std::uint32_t p) const {
        const branch_end& a = layout_.ends[layout_.segments[p].start];
        const branch_end& b = layout_.ends[layout_.segments[p].end];
        const glm::vec3 axis = b.position - a.position;
        const float l2 = glm::dot(axis, axis);
        const float t =
            l2 > 0 ? std::clamp(glm::dot(start.position - a.position, axis) / l2, 0.0f, 1.0f) : 1;
        const glm::vec3 nearest = a.position + axis * t;
        const float radius = a.radius + (b.radius - a.radius) * t;
        if (glm::distance(start.position, nearest) + start.radius > radius) {
            start.position = nearest;
            start.radius = std::min(start.radius, radius);
        }
        start.path = a.path + (b.path - a.path) * t;
    }

    /// The far end of segment `i`, and its frame: the frame before it, turned the short way.
    void finish(std::uint32_t i, std::uint32_t start, const glm::quat& before) {
        const branch_end from = layout_.ends[start];
        branch_end end;
        end.position = from_.tip(i);
        end.radius = from_.radius[i];
        if (is_rounding(end.position - from.position, end.position)) {
            end.position = from.position;
        }
        chord_[i] = end.position - from.position;
        const float length = glm::length(chord_[i]);
        end.path = from.path + length;
        const glm::vec3 up = before * glm::vec3(0, 1, 0);
        frame_[i] = length > 0 ? glm::normalize(shortest_rotation(up, chord_[i] / length) * before)
                               : before;
        end.orientation = as_vec4(frame_[i]);
        layout_.segments[i] = {start, add_end(end, {i, i, i}), cap_end, 0};
    }

    std::uint32_t add_end(const branch_end& end, const end_carrier& carrier) {
        layout_.ends.push_back(end);
        layout_.carriers.push_back(carrier);
        return static_cast<std::uint32_t>(layout_.ends.size() - 1);
    }

    /// Whether a chord is no more than what floats near `place` leave of one without length. Its
    /// direction would be noise.
    [[nodiscard]] static bool is_rounding(const glm::vec3& chord, const glm::vec3& place) {
        constexpr float ulps = 4 * std::numeric_limits<float>::epsilon();
        const glm::vec3 p = glm::abs(place);
        return glm::length(chord) <= ulps * std::max({p.x, p.y, p.z});
    }

    /// Turns joints, and takes chains apart where that is not enough, until no segment folds.
    void unfold() {
        constexpr int turns = 16;
        for (int i = 0; i < turns && for_each_fold([this](std::uint32_t s) { straighten(s); });
             ++i) {
        }
        // A segment of its own is straight and cannot fold, so this ends.
        while (for_each_fold([this](std::uint32_t s) { isolate(s); })) {
        }
    }

    template <class Mend>
    bool for_each_fold(Mend&& mend) {
        bool any = false;
        for (std::uint32_t i = 0; i < layout_.segments.size(); ++i) {
            if (folds(i)) {
                mend(i);
                any = true;
            }
        }
        return any;
    }

    /// Whether the centreline of segment `i` turns back (its Bézier points do not, as long as both
    /// ends look along the chord), a ring reaches through the next, or normals lean so far that a
    /// side faces against them. Rings k and k + 1 with centres a distance d apart and normals y at
    /// an angle of delta stay clear of each other all around if
    /// d · (y_k + y_k+1) > (r_k + r_k+1) sin delta. A slope s leaves
    /// 2 s (r_k+1 - r_k) - |s| |d x (y_k + y_k+1)| more of it.
    [[nodiscard]] bool folds(std::uint32_t i) const {
        const branch_segment& segment = layout_.segments[i];
        const branch_end& a = layout_.ends[segment.start];
        const branch_end& b = layout_.ends[segment.end];
        const bool parallel = a.orientation == b.orientation;
        const bool alone = parallel && segment.caps == (cap_start | cap_end); // and so straight
        if (glm::dot(chord_[i], chord_[i]) == 0 || (alone && a.slope == 0 && b.slope == 0)) {
            return !parallel;
        }
        const shared::branch_curve curve = shared::branch_curve_between(a, b);
        if (glm::dot(curve.n1, chord_[i]) < 0 || glm::dot(curve.n2, chord_[i]) < 0) {
            return true;
        }
        constexpr std::uint32_t gaps = 8;
        shared::branch_ring ring = shared::branch_ring_slerp(a, b, curve, 0);
        for (std::uint32_t k = 1; k <= gaps; ++k) {
            const shared::branch_ring next =
                frames_ == kernels::branch_frame::slerp
                    ? shared::branch_ring_slerp(a, b, curve, static_cast<float>(k) / gaps)
                    : shared::branch_ring_rotation_minimising(a, b, curve, k, gaps);
            const glm::vec3 d = next.centre - ring.centre;
            const glm::vec3 y = ring.y + next.y;
            const float clear = glm::dot(d, y) - (ring.radius + next.radius) *
                                                     glm::length(glm::cross(ring.y, next.y));
            const float step = 2 * (next.radius - ring.radius);
            const float across = glm::length(glm::cross(d, y));
            for (const std::uint32_t at : {k - 1, k}) {
                const float slope = glm::mix(a.slope, b.slope, static_cast<float>(at) / gaps);
                if (clear + slope * step - std::abs(slope) * across <= 0) {
                    return true;
                }
            }
            ring = next;
        }
        return false;
    }

    /// Turns both ends of segment `i` towards each other; all the way where nothing is between.
    void straighten(std::uint32_t i) {
        branch_end& a = layout_.ends[layout_.segments[i].start];
        branch_end& b = layout_.ends[layout_.segments[i].end];
        const glm::vec4 before = a.orientation;
        if (glm::dot(chord_[i], chord_[i]) == 0) {
            a.orientation = b.orientation = shared::slerp(before, b.orientation, 0.5f);
            return;
        }
        a.orientation = shared::slerp(before, b.orientation, 0.375f);
        b.orientation = shared::slerp(before, b.orientation, 0.625f);
    }

    /// Makes segment `i` a chain of its own, straight from end to end. Its continuation, if it has
    /// one, starts anew where it ends.
    void isolate(std::uint32_t i) {
        branch_segment& segment = layout_.segments[i];
        const std::uint32_t p = from_.parent[i];
        if (p != none && layout_.segments[p].end == segment.start) {
            layout_.carriers[segment.start] = {p, p, p};
            segment.start = copy_of_end(segment.start);
            layout_.carriers[segment.start] = {p, i, i};
            layout_.segments[p].caps |= cap_end;
        }
        const std::uint32_t next = from_.continuation[i];
        if (next != none && layout_.segments[next].start == segment.end) {
            const std::uint32_t start = copy_of_end(segment.end);
            layout_.carriers[segment.end] = {i, i, i};
            layout_.carriers[start] = {i, next, next};
            layout_.segments[next].start = start;
            layout_.segments[next].caps |= cap_start;
            layout_.ends[start].orientation = as_vec4(frame_[next]);
        }
        segment.caps = cap_start | cap_end;
        layout_.ends[segment.start].orientation = as_vec4(frame_[i]);
        layout_.ends[segment.end].orientation = as_vec4(frame_[i]);
    }

    [[nodiscard]] std::uint32_t copy_of_end(std::uint32_t end) {
        const branch_end copy = layout_.ends[end];
        return add_end(copy, layout_.carriers[end]);
    }

    /// The change of radius along the growth at each end: the mean of the segments that meet there.
    void smooth_slopes() {
        std::vector<glm::vec2> sums(layout_.ends.size(), glm::vec2(0));
        for (const branch_segment& s : layout_.segments) {
            const branch_end& a = layout_.ends[s.start];
            const branch_end& b = layout_.ends[s.end];
            const glm::vec2 change(b.radius - a.radius, b.path - a.path);
            sums[s.start] += change;
            sums[s.end] += change;
        }
        // A slope of 2 leans the normal by 63 degrees: steeper steps in a scan are noise.
        constexpr float steepest = 2;
        for (std::size_t i = 0; i < sums.size(); ++i) {
            const float slope = sums[i].y > 0 ? sums[i].x / sums[i].y : 0;
            layout_.ends[i].slope = std::clamp(slope, -steepest, steepest);
        }
    }

    /// Lowers slopes that a neighbour brings about and that turn a normal against a side. Without a
    /// slope no segment folds, and what is clear at a slope stays so at a lower one.
    void lower_slopes() {
        constexpr int halvings = 4;
        for (std::uint32_t i = 0; i < layout_.segments.size(); ++i) {
            for (int n = 0; folds(i); ++n) {
                const float by = n < halvings ? 0.5f : 0.0f;
                layout_.ends[layout_.segments[i].start].slope *= by;
                layout_.ends[layout_.segments[i].end].slope *= by;
                if (by == 0) {
                    break;
                }
            }
        }
    }

    const skeleton& from_;
    kernels::branch_frame frames_;
    branch_layout layout_;
    std::vector<glm::quat> frame_; ///< of each segment's chord
    std::vector<glm::vec3> chord_;
};

} // namespace detail

/// The ends and segments of a skeleton. Linear time. Every segment keeps its place; an end is
/// shared by a segment and its continuation. `frame` is how the rings between two ends will be
/// turned: it decides which joints would fold.
template <class = when_used>
[[nodiscard]] branch_layout layout_branches(const skeleton& from, kernels::branch_frame frame) {
    return detail::branch_layout_builder<>(from, frame).build();
}

} // namespace skybark::trees
