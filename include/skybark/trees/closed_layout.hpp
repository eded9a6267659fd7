#pragma once
// From the skeleton to one closed surface a tree: chains of segments, and where each chain joins
// the one that it grows from.
//
// It starts from `layout_branches` and changes what a closed surface can't have:
//  - Radii and lengths are at least a few dozen roundings of a float at that place, so that the
//    corners of all rings are places of their own.
//  - A branch begins outside its parent, where the tube between its first ring and the parent's
//    surface is short, in place of inside it. That first ring moves with the parent's segment.
//  - Chains stay whole. Segments that layout_branches takes out of a chain because they fold keep
//    their ring: on a closed surface a fold is a wrinkle.
//  - Ends at the very same place (a scan that has a branch twice) are set a little apart.

#include <skybark/core/when_used.hpp>
#include <skybark/kernels/unit_polygon.hpp>
#include <skybark/trees/branch_layout.hpp>

#include <cstring>
#include <optional>
#include <unordered_map>

namespace skybark::trees {

struct closed_mesh_options {
    std::uint32_t sides = 8; ///< of a ring, 3 … 1024
    std::uint32_t rings = 4; ///< a segment, both ends included, 2 … 1024
    kernels::branch_frame frame = kernels::branch_frame::slerp;
};

/// A segment, its continuation, that one's, …: one tube.
struct branch_chain {
    std::uint32_t first = 0; ///< of closed_layout::order
    std::uint32_t count = 0; ///< segments
};

/// Where a chain joins its parent: a loop of `sides` points on the parent's tube around a centre.
/// Places are (turns around the parent, m along its chords from its start), counter-clockwise seen
/// from outside.
struct branch_collar {
    std::uint32_t parent = 0; ///< a chain
    std::uint32_t child = 0;  ///< a chain
    glm::vec2 centre{0};
};

struct closed_layout {
    std::vector<branch_end> ends;
    std::vector<branch_segment> segments; ///< one a segment of the skeleton, in its order
    std::vector<end_carrier> carriers;    ///< one an end; segments of the skeleton move it
    std::vector<std::uint32_t> order;     ///< all segments, chain after chain
    std::vector<branch_chain> chains;     ///< each before all that grow from it, tree after tree
    /// Those of a parent are consecutive, in the order of the chains.
    std::vector<branch_collar> collars;
    std::vector<glm::vec2> loops; ///< `sides` places a collar
};

namespace detail {

/// Walks the chains of one skeleton, parents before children.
template <class = when_used>
class closed_layout_builder {
  public:
    closed_layout_builder(const skeleton& from, const closed_mesh_options& options)
        : from_(from), options_(options), corners_(kernels::unit_polygon(options.sides)) {
        branch_layout layout = layout_branches(from, options.frame);
        layout_.ends = std::move(layout.ends);
        layout_.segments = std::move(layout.segments);
        layout_.carriers = std::move(layout.carriers);
    }

    [[nodiscard]] closed_layout build() {
        rejoin();
        measure();
        thicken();
        gather_chains();
        along_.resize(from_.size());
        std::size_t collar = 0;
        for (std::uint32_t c = 0; c < layout_.chains.size(); ++c) {
            add_up_lengths(layout_.chains[c]);
            if (collar < layout_.collars.size() && layout_.collars[collar].parent == c) {
                mesh(layout_.chains[c]);
            }
            for (; collar < layout_.collars.size() && layout_.collars[collar].parent == c;
                 ++collar) {
                set_outside(layout_.collars[collar], collar);
            }
        }
        part_duplicates();
        return std::move(layout_);
    }

  private:
    [[nodiscard]] branch_end& start_of(std::uint32_t segment) {
        return layout_.ends[layout_.segments[segment].start];
    }
    [[nodiscard]] branch_end& end_of(std::uint32_t segment) {
        return layout_.ends[layout_.segments[segment].end];
    }

    /// Gives segments that were taken out of their chain the ring that they share with it.
    void rejoin() {
        for (std::uint32_t p = 0; p < from_.size(); ++p) {
            const std::uint32_t i = from_.continuation[p];
            if (i == none || layout_.segments[i].start == layout_.segments[p].end ||
                start_of(i).position != end_of(p).position) {
                continue;
            }
            const std::uint32_t joint = layout_.segments[p].end;
            layout_.ends[joint].orientation =
                shared::slerp(layout_.ends[joint].orientation, start_of(i).orientation, 0.5f);
            layout_.segments[i].start = joint;
            layout_.carriers[joint] = {p, p, i};
        }
    }

    /// The step that tells two vertices apart anywhere in the tree: 32 to 64 roundings of a float.
    void measure() {
        glm::vec3 low(std::numeric_limits<float>::max());
        glm::vec3 high(std::numeric_limits<float>::lowest());
        for (const branch_end& e : layout_.ends) {
            low = glm::min(low, e.position);
            high = glm::max(high, e.position);
        }
        const glm::vec3 farthest = glm::max(glm::abs(low), glm::abs(high));
        step_ = from_.empty() ? 0 : 4e-6f * std::max({farthest.x, farthest.y, farthest.z, 1e-3f});
    }

    /// No ring so small that its corners, no segment so short that its rings are one place.
    void thicken() {
        const float least_radius = step_ * static_cast<float>(std::max(options_.sides, 6u)) / 6;
        const float least_length = step_ * static_cast<float>(options_.rings - 1);
        for (branch_end& e : layout_.ends) {
            e.radius = std::max(e.radius, least_radius);
        }
        for (std::uint32_t i = 0; i < from_.size(); ++i) {
            const branch_end& a = start_of(i);
            branch_end& b = end_of(i);
            if (glm::distance(a.position, b.position) < least_length) {
                b.position = a.position + shared::quaternion_y(a.orientation) * least_length;
            }
        }
    }

    /// Chains depth first, so that a tree's vertices, and a bough's, lie together.
    void gather_chains() {
        std::vector<std::uint32_t> waiting; // first segments
        std::vector<std::uint32_t> from;    // the chains that they grow from
        std::uint32_t roots = 0;
        while (roots < from_.size() && from_.parent[roots] == none) {
            ++roots;
        }
        joined_.resize(from_.size());
        for (std::uint32_t root = 0; root < roots; ++root) {
            waiting.push_back(root);
            from.push_back(none);
            while (!waiting.empty()) {
                const std::uint32_t chain = add_chain(waiting.back(), from.back());
                waiting.pop_back();
                from.pop_back();
                const branch_chain added = layout_.chains[chain];
                for (std::uint32_t k = added.count; k-- > 0;) {
                    const std::uint32_t s = layout_.order[added.first + k];
                    for (std::uint32_t n = from_.child_count[s]; n-- > 0;) {
                        const std::uint32_t child = from_.first_child[s] + n;
                        if (!continues(child)) {
                            waiting.push_back(child);
                            from.push_back(chain);
                            joined_[child] = k;
                        }
                    }
                }
            }
        }
        gather_collars();
    }

    [[nodiscard]] bool continues(std::uint32_t i) const {
        const std::uint32_t p = from_.parent[i];
        return p != none && layout_.segments[i].start == layout_.segments[p].end;
    }

    std::uint32_t add_chain(std::uint32_t segment, std::uint32_t parent) {
        branch_chain chain{static_cast<std::uint32_t>(layout_.order.size()), 0};
        for (std::uint32_t s = segment; s != none; ++chain.count) {
            layout_.order.push_back(s);
            const std::uint32_t next = from_.continuation[s];
            s = next != none && continues(next) ? next : none;
        }
        layout_.chains.push_back(chain);
        parent_.push_back(parent);
        return static_cast<std::uint32_t>(layout_.chains.size() - 1);
    }

    /// One collar a chain with a parent, sorted by parent.
    void gather_collars() {
        const auto chains = static_cast<std::uint32_t>(layout_.chains.size());
        std::vector<std::uint32_t> place(chains + 1, 0);
        for (const std::uint32_t p : parent_) {
            place[p == none ? chains : p] += 1;
        }
        std::uint32_t sum = 0;
        for (std::uint32_t c = 0; c < chains; ++c) {
            sum += std::exchange(place[c], sum);
        }
        layout_.collars.resize(sum);
        layout_.loops.resize(std::size_t{sum} * options_.sides);
        for (std::uint32_t c = 0; c < chains; ++c) {
            if (parent_[c] != none) {
                layout_.collars[place[parent_[c]]++] = {parent_[c], c, {}};
            }
        }
    }

    /// m along the chain at which each of its segments starts. Chords, as collars measure.
    void add_up_lengths(const branch_chain& chain) {
        float sum = 0;
        for (std::uint32_t k = 0; k < chain.count; ++k) {
            const std::uint32_t s = layout_.order[chain.first + k];
            along_[s] = sum;
            sum += glm::distance(start_of(s).position, end_of(s).position);
        }
    }

    /// The rings of a chain as its tube will have them, `sides` points each.
    void mesh(const branch_chain& chain) {
        const kernels::hermite_branch tube{options_.sides, options_.rings, options_.frame};
        tube_.clear();
        for (std::uint32_t k = 0; k < chain.count; ++k) {
            std::uint32_t vertex = k == 0 ? 0 : options_.sides + 1;
            const auto take = [&](const surface_vertex& v) {
                if (vertex++ % (options_.sides + 1) != options_.sides) {
                    tube_.push_back(v.position);
                }
            };
            tube.ring(layout_.order[chain.first + k], vertex, tube.ring_vertices() - vertex, take,
                      layout_.segments, layout_.ends, corners_);
        }
    }

    /// Where a branch comes out of its parent.
    struct outlet {
        std::uint32_t segment = 0; ///< of the parent, counted along its chain
        float depth = 0;           ///< m along the branch from its start
        float radius = 0;          ///< m, of the parent there
        float turn = 0;            ///< around the parent
        float along = 0;           ///< m along the parent's chain
        glm::vec3 axis{0};         ///< unit, of the parent
        glm::vec3 normal{0};       ///< unit, of the parent's surface
    };

    /// Follows a ray from inside the parent's segment `k` out of its tube, if it is inside.
    [[nodiscard]] std::optional<outlet> find_outlet(const branch_chain& parent, std::uint32_t k,
                                                    const glm::vec3& start,
                                                    const glm::vec3& direction) {
        outlet out;
        out.depth = std::numeric_limits<float>::max();
        const glm::vec3 chord = end_of(layout_.order[parent.first + k]).position -
                                start_of(layout_.order[parent.first + k]).position;
        const bool forth = glm::dot(chord, direction) >= 0;
        constexpr std::uint32_t farthest = 8; // segments
        bool found = meet_tube(parent, k, start, direction, out);
        for (std::uint32_t n = 1; n <= farthest && (n == 1 || !found); ++n) {
            for (const bool on : {forth, !forth}) {
                const bool there = on ? k + n < parent.count : k >= n;
                if (there && meet_tube(parent, on ? k + n : k - n, start, direction, out)) {
                    found = true;
                }
            }
        }
        return found ? std::optional(out) : std::nullopt;
    }

    /// The first triangle of the parent's segment `k` that the ray leaves through, if that is
    /// before `out` yet.
    bool meet_tube(const branch_chain& parent, std::uint32_t k, const glm::vec3& start,
                   const glm::vec3& direction, outlet& out) {
        const std::uint32_t gaps = options_.rings - 1;
        const std::uint32_t sides = options_.sides;
        bool found = false;
        for (std::uint32_t ring = k * gaps; ring < (k + 1) * gaps; ++ring) {
            const glm::vec3* low = tube_.data() + std::size_t{ring} * sides;
            const glm::vec3* high = low + sides;
            for (std::uint32_t c = 0; c < sides; ++c) {
                const std::uint32_t next = c + 1 < sides ? c + 1 : 0;
                glm::vec2 at;
                // Upper left and lower right, as hermite_branch has them; `at` from the corner low.
                if (meets(start, direction, low[c], high[next], high[c], out, at)) {
                    set_outlet(
                        parent, k,
                        {static_cast<float>(c) + at.x, static_cast<float>(ring) + at.x + at.y},
                        out);
                    found = true;
                }
                if (meets(start, direction, low[c], low[next], high[next], out, at)) {
                    set_outlet(
                        parent, k,
                        {static_cast<float>(c) + at.x + at.y, static_cast<float>(ring) + at.y},
                        out);
                    found = true;
                }
            }
        }
        return found;
    }

    /// Whether the ray leaves through triangle (a, b, c) before `out`, whose depth and normal it
    /// then sets; `at` is how far it is from a towards b and towards c (Moeller and Trumbore).
    [[nodiscard]] static bool meets(const glm::vec3& start, const glm::vec3& direction,
                                    const glm::vec3& a, const glm::vec3& b, const glm::vec3& c,
                                    outlet& out, glm::vec2& at) {
        const glm::vec3 ab = b - a;
        const glm::vec3 ac = c - a;
        const glm::vec3 normal = glm::cross(ab, ac);
        const float facing = glm::dot(normal, direction);
        if (!(facing > 0)) {
            return false;
        }
        const glm::vec3 q = glm::cross(start - a, direction);
        at.x = -glm::dot(ac, q) / facing;
        at.y = glm::dot(ab, q) / facing;
        const float depth = glm::dot(a - start, normal) / facing;
        constexpr float slack = -1e-4f; // rays through an edge
        if (!(at.x >= slack && at.y >= slack && at.x + at.y <= 1 - slack && depth > 0 &&
              depth < out.depth)) {
            return false;
        }
        out.depth = depth;
        out.normal = glm::normalize(normal);
        return true;
    }

    /// What follows from where an outlet is on the unrolled tube: corners around, rings along.
    void set_outlet(const branch_chain& parent, std::uint32_t k, const glm::vec2& place,
                    outlet& out) {
        const std::uint32_t s = layout_.order[parent.first + k];
        const auto gaps = static_cast<float>(options_.rings - 1);
        const float t = std::clamp(place.y / gaps - static_cast<float>(k), 0.0f, 1.0f);
        out.segment = k;
        out.turn = place.x / static_cast<float>(options_.sides);
        out.along = along_[s] + t * chord_length(s);
        out.radius = glm::mix(start_of(s).radius, end_of(s).radius, t);
        out.axis = (end_of(s).position - start_of(s).position) / chord_length(s);
    }

    [[nodiscard]] float chord_length(std::uint32_t s) {
        return glm::distance(start_of(s).position, end_of(s).position);
    }

    /// The place of the parent's segment `k` nearest to where the branch starts.
    [[nodiscard]] outlet outlet_beside(const branch_chain& parent, std::uint32_t k,
                                       const glm::vec3& start, const glm::vec3& direction) {
        const std::uint32_t s = layout_.order[parent.first + k];
        const branch_end& a = start_of(s);
        const float length = chord_length(s);
        outlet out;
        out.axis = (end_of(s).position - a.position) / length;
        const float along = std::clamp(glm::dot(start - a.position, out.axis), 0.0f, length);
        const glm::vec3 side = across(direction, out.axis);
        const glm::vec3 off = across(start - a.position, out.axis);
        const glm::vec3 any = across(shared::quaternion_x(a.orientation), out.axis);
        out.normal = glm::length(side) > 1e-3f            ? glm::normalize(side)
                     : glm::length(off) > 0.1f * a.radius ? glm::normalize(off)
                                                          : glm::normalize(any);
        const float ring =
            (static_cast<float>(k) + along / length) * static_cast<float>(options_.rings - 1);
        set_outlet(
            parent, k,
            {turn_of(s, along / length, out.normal) * static_cast<float>(options_.sides), ring},
            out);
        return out;
    }

    [[nodiscard]] static glm::vec3 across(const glm::vec3& v, const glm::vec3& axis) {
        return v - axis * glm::dot(v, axis);
    }

    [[nodiscard]] glm::vec3 direction_of(std::uint32_t s) {
        return (end_of(s).position - start_of(s).position) / chord_length(s);
    }

    /// The point of a segment's centreline beside `p`.
    [[nodiscard]] glm::vec3 nearest_centre(std::uint32_t s, const glm::vec3& p) {
        const branch_end& a = start_of(s);
        const branch_end& b = end_of(s);
        const float t = glm::dot(p - a.position, direction_of(s)) / chord_length(s);
        const shared::branch_curve c = shared::branch_curve_between(a, b);
        return shared::hermite_point(c.p1, c.n1, c.p2, c.n2, std::clamp(t, 0.0f, 1.0f));
    }

    /// Moves the start of segment `s`, unless that leaves nothing of it.
    void move_start(std::uint32_t s, const glm::vec3& to) {
        branch_end& start = start_of(s);
        const glm::vec3 before = direction_of(s);
        if (glm::distance(to, end_of(s).position) < 0.1f * chord_length(s)) {
            return;
        }
        start.position = to;
        const glm::vec4 q = start.orientation;
        start.orientation =
            as_vec4(shortest_rotation(before, direction_of(s)) * glm::quat(q.w, q.x, q.y, q.z));
    }

    /// Moves the start of a chain out of its parent, and puts its collar where it comes out.
    void set_outside(branch_collar& collar, std::size_t number) {
        const std::uint32_t first = layout_.order[layout_.chains[collar.child].first];
        branch_end& start = start_of(first);
        const branch_chain& parent = layout_.chains[collar.parent];
        const std::uint32_t k = joined_[first];
        std::optional<outlet> met = find_outlet(parent, k, start.position, direction_of(first));
        if (!met) { // the parent bends so much that the branch starts beside it
            move_start(first, nearest_centre(layout_.order[parent.first + k], start.position));
            met = find_outlet(parent, k, start.position, direction_of(first));
        }
        const glm::vec3 direction = direction_of(first);
        const float length = chord_length(first);
        const outlet out = met ? *met : outlet_beside(parent, k, start.position, direction);
        glm::vec2* const loop = layout_.loops.data() + number * options_.sides;
        collar.centre = place_loop(parent, start, direction, out, loop);
        // As far that no point of the first ring is inside, if the branch is long enough for it.
        const float steep = glm::dot(direction, out.normal);
        const float flat = std::sqrt(std::max(0.0f, 1 - steep * steep));
        const float clear =
            out.depth + start.radius * (flat + 2 * (flare - 1)) / std::max(steep, 0.2f);
        const float most = std::max(0.0f, std::min(0.8f * length, length - 2 * least_length()));
        const float by = std::min(clear, most);
        start.position += direction * by;
        start.path += by;
        // The foot goes with the wood that it stands on; the branch bends above it.
        const std::uint32_t under = layout_.order[parent.first + out.segment];
        layout_.carriers[layout_.segments[first].start] = {under, under, under, 0};
    }

    [[nodiscard]] float least_length() const {
        return step_ * static_cast<float>(options_.rings - 1);
    }

    /// The child's ring, a little wider, projected along it onto the plane that touches the parent,
    /// and wrapped around the parent. Gives the centre.
    [[nodiscard]] glm::vec2 place_loop(const branch_chain& parent, const branch_end& start,
                                       const glm::vec3& direction, const outlet& out,
                                       glm::vec2* loop) {
        const glm::vec3 along = steep_enough(direction, out.normal, out.axis);
        const glm::vec3 east = glm::normalize(glm::cross(out.axis, out.normal));
        const glm::vec3 north = glm::cross(out.normal, east);
        const glm::vec3 x = shared::quaternion_x(start.orientation);
        const glm::vec3 z = shared::quaternion_z(start.orientation);
        glm::vec2 most(0);
        for (std::size_t c = 0; c < options_.sides; ++c) {
            const glm::vec3 ring = (x * corners_[c].x - z * corners_[c].y) * start.radius;
            const float down = glm::dot(ring, out.normal) / glm::dot(along, out.normal);
            const glm::vec3 foot = (ring - along * down) * flare;
            loop[c] = {glm::dot(foot, east), glm::dot(foot, north)};
            most = glm::max(most, glm::abs(loop[c]));
        }
        const std::uint32_t last = layout_.order[parent.first + parent.count - 1];
        const float total = along_[last] + chord_length(last);
        const glm::vec2 shrink(std::min(1.0f, 0.9f * out.radius / most.x),
                               std::min(1.0f, 0.45f * total / most.y));
        const float room = most.y * shrink.y * 1.1f;
        const glm::vec2 centre(out.turn, std::clamp(out.along, room, std::max(room, total - room)));
        for (std::size_t c = 0; c < options_.sides; ++c) {
            glm::vec2& p = loop[c];
            p *= shrink;
            p.x = std::asin(p.x / out.radius) / two_pi;
            p += centre;
        }
        return centre;
    }

    /// `direction`, lifted off the surface where it runs along it or into it.
    [[nodiscard]] static glm::vec3 steep_enough(const glm::vec3& direction, const glm::vec3& normal,
                                                const glm::vec3& axis) {
        const float steep = glm::dot(direction, normal);
        if (steep >= least_steepness) {
            return direction;
        }
        const glm::vec3 flat = direction - normal * steep;
        const glm::vec3 unit = glm::length(flat) > 1e-3f ? glm::normalize(flat) : axis;
        return unit * std::sqrt(1 - least_steepness * least_steepness) + normal * least_steepness;
    }

    /// Turns around segment `s` from its u = 0 to where it faces `normal`.
    [[nodiscard]] float turn_of(std::uint32_t s, float t, const glm::vec3& normal) {
        const branch_end& a = start_of(s);
        const branch_end& b = end_of(s);
        const shared::branch_curve curve = shared::branch_curve_between(a, b);
        const std::uint32_t last = options_.rings - 1;
        const auto k = static_cast<std::uint32_t>(std::lround(t * static_cast<float>(last)));
        const shared::branch_ring ring =
            options_.frame == kernels::branch_frame::slerp
                ? shared::branch_ring_slerp(a, b, curve, t)
                : shared::branch_ring_rotation_minimising(a, b, curve, k, last);
        const float angle = std::atan2(-glm::dot(normal, ring.z), glm::dot(normal, ring.x));
        const float turn = angle / two_pi;
        return turn < 0 ? turn + 1 : turn;
    }

    /// Ends of different chains at one and the same place: all but the first move, by less than
    /// their radius, along a spiral.
    void part_duplicates() {
        struct hash {
            std::size_t operator()(const std::array<std::uint32_t, 3>& key) const {
                std::uint64_t h = 0;
                for (const std::uint32_t word : key) {
                    h = (h ^ word) * 0x9e3779b97f4a7c15ull;
                    h ^= h >> 29;
                }
                return static_cast<std::size_t>(h);
            }
        };
        std::unordered_map<std::array<std::uint32_t, 3>, std::uint32_t, hash> seen;
        seen.reserve(layout_.ends.size());
        for (const std::uint32_t s : layout_.order) {
            const bool first = !continues(s);
            for (const std::uint32_t e : {layout_.segments[s].start, layout_.segments[s].end}) {
                if (e == layout_.segments[s].start && !first) {
                    continue;
                }
                const glm::vec3 p = layout_.ends[e].position + 0.0f;
                std::array<std::uint32_t, 3> key;
                std::memcpy(key.data(), &p, sizeof key);
                const std::uint32_t before = seen[key]++;
                if (before > 0) {
                    const auto n = static_cast<float>(before);
                    const glm::vec3 spiral(std::cos(2.4f * n), 0.3f, std::sin(2.4f * n));
                    layout_.ends[e].position += spiral * (0.37f * step_ * std::sqrt(n));
                }
            }
        }
    }

    static constexpr float two_pi = 6.28318530718f;
    static constexpr float least_steepness = 0.35f;
    static constexpr float flare = 1.2f; ///< how much wider than the branch its foot is

    const skeleton& from_;
    const closed_mesh_options& options_;
    std::vector<glm::vec4> corners_;
    closed_layout layout_;
    std::vector<std::uint32_t> parent_; ///< of each chain
    std::vector<std::uint32_t> joined_; ///< of a chain's first segment: place in the parent's chain
    std::vector<float> along_;          ///< m, see add_up_lengths
    std::vector<glm::vec3> tube_;       ///< points of the chain under way, see mesh
    float step_ = 0;                    ///< m
};

} // namespace detail

/// The chains of a skeleton and how they join. Nearly linear time.
template <class = when_used>
[[nodiscard]] closed_layout layout_closed(const skeleton& from,
                                          const closed_mesh_options& options) {
    return detail::closed_layout_builder<>(from, options).build();
}

} // namespace skybark::trees
