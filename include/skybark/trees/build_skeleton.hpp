#pragma once
// build_skeleton: segments in any order become a skeleton in level order.
//
// Everything here is linear in the number of segments and free of recursion, because a scan of a
// stand has millions of segments and a vine is one chain of them.
// Frames: the smallest rotation from each segment to its child, applied from the root outwards,
// which is parallel transport along the tree (Wang et al. 2008 say why that is wanted).

#include <skybark/core/when_used.hpp>
#include <skybark/trees/skeleton.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace skybark::trees {

/// An axis-aligned box in metres. An empty skeleton has the box {0, 0}.
struct bounding_box {
    glm::vec3 min{0};
    glm::vec3 max{0};
};

namespace detail::from_segments {

/// Directions whose cosines to the parent differ by less than this are equally well aligned: the
/// two arms of a symmetric fork must not be told apart by rounding.
inline constexpr double alignment_tolerance = 1e-6;

template <class = when_used>
[[nodiscard]] std::string number_text(double value) {
    char buffer[32];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
    return std::string(buffer, end);
}

[[nodiscard]] inline bool is_finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

template <class = when_used>
[[nodiscard]] std::string vector_text(const glm::vec3& v) {
    std::string text = number_text(v.x); // "(" + a temporary makes g++ 12 see an overlap
    return text.insert(0, 1, '(') + ", " + number_text(v.y) + ", " + number_text(v.z) + ")";
}

[[nodiscard]] inline glm::dvec3 chord(const segment& s) {
    return glm::dvec3(s.tip) - glm::dvec3(s.base);
}

/// What is wrong with segment `i` alone, or an empty string.
template <class = when_used>
[[nodiscard]] std::string segment_complaint(std::span<const segment> segments, std::size_t i) {
    const segment& s = segments[i];
    const std::string who = "Segment " + std::to_string(i);
    if (!is_finite(s.base))
        return who + " has the base " + vector_text(s.base) + "; expected finite metres.";
    if (!is_finite(s.tip))
        return who + " has the tip " + vector_text(s.tip) + "; expected finite metres.";
    if (!(s.base_radius >= 0) || !std::isfinite(s.base_radius))
        return who + " has the base radius " + number_text(s.base_radius) +
               "; expected a finite number of metres, zero or more.";
    if (!(s.radius >= 0) || !std::isfinite(s.radius))
        return who + " has the radius " + number_text(s.radius) +
               "; expected a finite number of metres, zero or more.";
    if (s.parent == i)
        return who + " is its own parent.";
    if (s.parent != none && s.parent >= segments.size())
        return who + " has the parent " + std::to_string(s.parent) + ", but there are only " +
               std::to_string(segments.size()) + " segments.";
    const double length = glm::length(chord(s));
    if (length > static_cast<double>(std::numeric_limits<float>::max()))
        return who + " is " + number_text(length) + " m long, more than a float can hold.";
    return {};
}

/// Names the segments of one cycle, given that some segments were never reached from a root.
template <class = when_used>
[[nodiscard]] std::string cycle_complaint(std::span<const segment> segments,
                                          const std::vector<std::uint32_t>& order) {
    std::vector<std::uint8_t> seen(segments.size(), 0);
    for (const std::uint32_t i : order)
        seen[i] = 1;
    const auto start = std::find(seen.begin(), seen.end(), std::uint8_t{0});
    auto i = static_cast<std::uint32_t>(start - seen.begin());
    while (seen[i] == 0) { // walk up: what is not reached from a root leads into a cycle
        seen[i] = 1;
        i = segments[i].parent;
    }
    constexpr int most_named = 8;
    std::string names = std::to_string(i);
    int named = 1;
    for (std::uint32_t j = segments[i].parent; j != i; j = segments[j].parent) {
        if (named == most_named) {
            names += ", …";
            break;
        }
        names += ", " + std::to_string(j);
        ++named;
    }
    return "Segments " + names + " are each other's ancestors; expected parents that lead to a " +
           "root.";
}

/// Offsets into the children of each segment, sorted by parent; roots are listed separately.
struct child_lists {
    std::vector<std::uint32_t> first; ///< size n + 1
    std::vector<std::uint32_t> child;
    std::vector<std::uint32_t> root;
};

/// Counting sort by parent: stable, so siblings keep their input order.
template <class = when_used>
[[nodiscard]] child_lists list_children(std::span<const segment> segments) {
    const std::size_t n = segments.size();
    child_lists lists;
    lists.first.assign(n + 1, 0);
    for (const segment& s : segments)
        if (s.parent != none)
            ++lists.first[s.parent + std::size_t{1}];
    for (std::size_t i = 0; i < n; ++i)
        lists.first[i + 1] += lists.first[i];
    lists.child.resize(lists.first[n]);
    std::vector<std::uint32_t> next(lists.first.begin(), lists.first.end() - 1);
    for (std::size_t i = 0; i < n; ++i) {
        const auto own = static_cast<std::uint32_t>(i);
        if (segments[i].parent == none)
            lists.root.push_back(own);
        else
            lists.child[next[segments[i].parent]++] = own;
    }
    return lists;
}

/// The smallest rotation from +Y to the unit vector `d`. Straight down is reached by half a turn
/// about +X, and from there by the smallest rotation: next to straight down the smallest rotation
/// from +Y has an axis made of rounding errors.
[[nodiscard]] inline glm::dquat rotation_from_up(const glm::dvec3& d) {
    const double lateral = d.x * d.x + d.z * d.z;
    if (d.y < 0 && lateral < 1e-10) {
        const glm::dvec3 turned(d.x, -d.y, -d.z);
        return glm::dquat(0, 1, 0, 0) * rotation_from_up(turned);
    }
    // 1 + d.y, without cancellation where d.y is near -1
    const double w = d.y < 0 ? lateral / (1 - d.y) : 1 + d.y;
    return glm::normalize(glm::dquat(w, d.z, 0, -d.x));
}

/// The frame of a child that points along the unit vector `direction`. Works from where the
/// parent's rounded quaternion really points, so that errors don't add up along a long chain.
[[nodiscard]] inline glm::dquat transport(const glm::dquat& parent, const glm::dvec3& direction) {
    const glm::dvec3 local = glm::normalize(glm::conjugate(parent) * direction);
    return glm::normalize(parent * rotation_from_up(local));
}

/// Whether the child's base is close enough to the parent's tip for one ring to serve both.
[[nodiscard]] inline bool joins(const segment& parent, const segment& child) {
    const double gap = glm::length(glm::dvec3(child.base) - glm::dvec3(parent.tip));
    const double rounding = 1e-6 * (1 + glm::length(glm::dvec3(parent.tip)));
    return gap <= std::max(static_cast<double>(parent.radius), rounding);
}

} // namespace detail::from_segments

/// Sorts `segments` into a skeleton: all roots, then all their children, and so on; the children
/// of one segment are consecutive and in input order. Several roots are a stand of trees.
///
/// - `position`, `length`, `radius`: as given; `length` is the distance from base to tip.
/// - `orientation`: local +Y runs from base to tip. A root turns by the smallest rotation from
///   world +Y, a child by the smallest rotation from its parent (no twist). A child that points
///   straight back turns half a turn about the parent's local +X. A segment of zero length takes
///   its parent's orientation, at a root the identity.
/// - `continuation`: of the children that start at the tip (within the tip's radius of it) and
///   turn by at most 90°, the one best aligned; of equally aligned ones the thickest, then the
///   first. Else `none`.
/// - `base_radius`: for a continuing child its parent's `radius`, since they share a ring; for
///   every other segment as given.
///
/// `input_index`, if not null, receives for each skeleton entry the index of its segment in
/// `segments` (size = segments.size()).
///
/// Zero lengths and radii are legal. Errors (`bad_input`, naming the segment and the value):
/// nothing given, more than 2³² − 2 segments, a value that isn't finite, a negative radius, a
/// length beyond float, a parent that doesn't exist, a cycle of parents.
///
/// Linear time, no recursion; needs about 60 bytes a segment besides the skeleton.
/// Source: Akagi and Kitajima, section 2.1.
template <class = when_used>
[[nodiscard]] result<skeleton> build_skeleton(std::span<const segment> segments,
                                              std::vector<std::uint32_t>* input_index = nullptr) {
    const std::size_t n = segments.size();
    if (n == 0)
        return fail(error_code::bad_input, "A skeleton needs at least one segment; got none.");
    if (n > std::size_t{none} - 1)
        return fail(error_code::bad_input,
                    "A skeleton holds at most 4294967294 segments; got " + std::to_string(n) + ".");
    for (std::size_t i = 0; i < n; ++i)
        if (std::string complaint = detail::from_segments::segment_complaint(segments, i);
            !complaint.empty())
            return fail(error_code::bad_input, std::move(complaint));

    skeleton s;
    s.parent.reserve(n);
    s.first_child.resize(n);
    s.child_count.resize(n);
    std::vector<std::uint32_t> order;
    order.reserve(n);
    {
        const detail::from_segments::child_lists lists =
            detail::from_segments::list_children(segments);
        for (const std::uint32_t r : lists.root) {
            order.push_back(r);
            s.parent.push_back(none);
        }
        // breadth first; `order` is its own queue
        s.levels.push_back(0);
        std::size_t level_end = order.size();
        for (std::size_t i = 0; i < order.size(); ++i) {
            if (i == level_end) {
                s.levels.push_back(static_cast<std::uint32_t>(i));
                level_end = order.size();
            }
            s.first_child[i] = static_cast<std::uint32_t>(order.size());
            const std::uint32_t own = order[i];
            s.child_count[i] = lists.first[own + std::size_t{1}] - lists.first[own];
            for (std::uint32_t c = lists.first[own]; c < lists.first[own + std::size_t{1}]; ++c) {
                order.push_back(lists.child[c]);
                s.parent.push_back(static_cast<std::uint32_t>(i));
            }
        }
        s.levels.push_back(static_cast<std::uint32_t>(order.size()));
    }
    if (order.size() < n)
        return fail(error_code::bad_input, detail::from_segments::cycle_complaint(segments, order));

    s.continuation.assign(n, none);
    s.orientation.resize(n);
    s.position.resize(n);
    s.length.resize(n);
    s.base_radius.resize(n);
    s.radius.resize(n);
    std::vector<double> alignment(n); // cosine of the turn from the parent
    for (std::size_t i = 0; i < n; ++i) {
        const segment& own = segments[order[i]];
        const glm::dvec3 chord = detail::from_segments::chord(own);
        const double length = glm::length(chord);
        s.position[i] = own.base;
        s.length[i] = static_cast<float>(length);
        s.base_radius[i] = own.base_radius;
        s.radius[i] = own.radius;
        const bool root = s.parent[i] == none;
        const glm::dquat before =
            root ? glm::dquat(1, 0, 0, 0) : glm::normalize(glm::dquat(s.orientation[s.parent[i]]));
        if (length > 0) {
            const glm::dvec3 direction = chord / length;
            s.orientation[i] = glm::quat(detail::from_segments::transport(before, direction));
            alignment[i] = glm::dot(before * glm::dvec3(0, 1, 0), direction);
        } else {
            s.orientation[i] = glm::quat(before);
            alignment[i] = 1;
        }
    }

    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t first = s.first_child[i];
        const std::size_t last = first + s.child_count[i];
        const segment& own = segments[order[i]];
        double best = -1;
        for (std::size_t c = first; c < last; ++c)
            if (detail::from_segments::joins(own, segments[order[c]]))
                best = std::max(best, alignment[c]);
        if (best < -detail::from_segments::alignment_tolerance)
            continue;
        for (std::size_t c = first; c < last; ++c) {
            if (alignment[c] < best - detail::from_segments::alignment_tolerance ||
                !detail::from_segments::joins(own, segments[order[c]]))
                continue;
            const std::uint32_t chosen = s.continuation[i];
            if (chosen == none || s.radius[c] > s.radius[chosen])
                s.continuation[i] = static_cast<std::uint32_t>(c);
        }
        s.base_radius[s.continuation[i]] = own.radius;
    }
    if (input_index != nullptr)
        *input_index = std::move(order);
    return s;
}

/// The box around both ends of every segment, each as a ball of the radius there (m).
template <class = when_used>
[[nodiscard]] bounding_box bounds(const skeleton& s) {
    if (s.empty())
        return {};
    bounding_box box{glm::vec3(std::numeric_limits<float>::max()),
                     glm::vec3(std::numeric_limits<float>::lowest())};
    for (std::size_t i = 0; i < s.size(); ++i) {
        const glm::vec3 tip = s.tip(i);
        const glm::vec3 at_base(s.base_radius[i]);
        const glm::vec3 at_tip(s.radius[i]);
        box.min = glm::min(box.min, glm::min(s.position[i] - at_base, tip - at_tip));
        box.max = glm::max(box.max, glm::max(s.position[i] + at_base, tip + at_tip));
    }
    return box;
}

/// From the lowest end of a segment to the highest one (m), radii left out; 0 if empty.
template <class = when_used>
[[nodiscard]] float height(const skeleton& s) {
    if (s.empty())
        return 0;
    float low = std::numeric_limits<float>::max();
    float high = std::numeric_limits<float>::lowest();
    for (std::size_t i = 0; i < s.size(); ++i) {
        const float tip = s.tip(i).y;
        low = std::min({low, s.position[i].y, tip});
        high = std::max({high, s.position[i].y, tip});
    }
    return high - low;
}

} // namespace skybark::trees
