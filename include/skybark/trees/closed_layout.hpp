#pragma once
// From the skeleton to one closed surface a tree: chains of segments, and where each chain joins
// the one that it grows from.
//
// It starts from `layout_branches` and changes what a closed surface can't have:
//  - Radii and lengths are at least a few dozen roundings of a float at that place, so that the
//    corners of all rings are places of their own.
//  - A branch begins outside its parent, where the tube between its first ring and the parent's
//    surface is short, in place of inside it.
//  - Chains stay whole. Segments that layout_branches takes out of a chain because they fold keep
//    their ring: on a closed surface a fold is a wrinkle.
//  - Ends at the very same place (a scan that has a branch twice) are set a little apart.

#include <skybark/trees/branch_layout.hpp>

#include <cstring>
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
class closed_layout_builder {
  public:
    closed_layout_builder(const skeleton& from, const closed_mesh_options& options)
        : from_(from), options_(options) {
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
        for (std::uint32_t c = 0; c < layout_.chains.size(); ++c) {
            if (parent_[c] != none) {
                set_outside(c);
            }
            add_up_lengths(layout_.chains[c]);
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
        const glm::vec3 far = glm::max(glm::abs(low), glm::abs(high));
        step_ = from_.empty() ? 0 : 4e-6f * std::max({far.x, far.y, far.z, 1e-3f});
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
        collar_.assign(chains, none);
        for (std::uint32_t c = 0; c < chains; ++c) {
            if (parent_[c] != none) {
                collar_[c] = place[parent_[c]]++;
                layout_.collars[collar_[c]] = {parent_[c], c, {}};
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

    /// Where a branch comes out of its parent.
    struct outlet {
        std::uint32_t segment = 0; ///< of the parent, counted along its chain
        float along = 0;           ///< m from that segment's start
        float radius = 0;          ///< m, of the parent there
        float depth = 0;           ///< m along the branch from its start
        glm::vec3 axis{0};         ///< unit, of the parent
        glm::vec3 normal{0};       ///< unit, of the parent's surface
    };

    /// Follows a ray that starts inside the parent's segment `k` until it is outside of the cone
    /// that this segment is, or one of its neighbours in the chain.
    [[nodiscard]] outlet find_outlet(const branch_chain& parent, std::uint32_t k,
                                     const glm::vec3& start, const glm::vec3& direction) {
        constexpr int most_segments = 32;
        outlet out;
        int heading = 0;
        for (int n = 0; n < most_segments; ++n) {
            out = outlet_of_segment(parent, k, start, direction);
            const float length = chord_length(layout_.order[parent.first + k]);
            int next = 0;
            if (out.along > length && k + 1 < parent.count) {
                next = 1;
            } else if (out.along < 0 && k > 0) {
                next = -1;
            }
            if (next == 0 || next == -heading) {
                break;
            }
            heading = next;
            k = next > 0 ? k + 1 : k - 1;
        }
        return out;
    }

    [[nodiscard]] float chord_length(std::uint32_t s) {
        return glm::distance(start_of(s).position, end_of(s).position);
    }

    [[nodiscard]] outlet outlet_of_segment(const branch_chain& parent, std::uint32_t k,
                                           const glm::vec3& start, const glm::vec3& direction) {
        const std::uint32_t s = layout_.order[parent.first + k];
        const branch_end& a = start_of(s);
        const branch_end& b = end_of(s);
        const float length = chord_length(s);
        outlet out;
        out.segment = k;
        out.axis = (b.position - a.position) / length;
        const float y0 = glm::dot(start - a.position, out.axis);
        const glm::vec3 off = start - a.position - out.axis * y0;
        const float forward = glm::dot(direction, out.axis);
        const glm::vec3 side = direction - out.axis * forward;
        const float side2 = glm::dot(side, side);
        out.along = y0;
        for (int n = 0; n < 3; ++n) { // the radius where it comes out
            out.radius = glm::mix(a.radius, b.radius, std::clamp(out.along / length, 0.0f, 1.0f));
            const float middle = -glm::dot(off, side);
            const float square =
                middle * middle + side2 * (out.radius * out.radius - glm::dot(off, off));
            out.depth = side2 > 1e-6f
                            ? std::max(0.0f, (middle + std::sqrt(std::max(0.0f, square))) / side2)
                            : 0.0f;
            out.along = y0 + out.depth * forward;
        }
        const glm::vec3 outwards = off + side * out.depth;
        const glm::vec3 any = shared::quaternion_x(a.orientation);
        const glm::vec3 across = any - out.axis * glm::dot(any, out.axis);
        out.normal = glm::length(outwards) > 0.01f * out.radius ? glm::normalize(outwards)
                     : side2 > 1e-6f                            ? side / std::sqrt(side2)
                                                                : glm::normalize(across);
        return out;
    }

    /// Moves the start of a chain out of its parent, and puts its collar where it comes out.
    void set_outside(std::uint32_t chain) {
        const std::uint32_t first = layout_.order[layout_.chains[chain].first];
        branch_end& start = start_of(first);
        const branch_chain& parent = layout_.chains[parent_[chain]];
        const glm::vec3 chord = end_of(first).position - start.position;
        const float length = glm::length(chord);
        const glm::vec3 direction = chord / length;
        const outlet out = find_outlet(parent, joined_[first], start.position, direction);
        place_collar(chain, parent, start, direction, out);
        // As far that no point of the first ring is inside, if the branch is long enough for it.
        const float steep = glm::dot(direction, out.normal);
        const float flat = std::sqrt(std::max(0.0f, 1 - steep * steep));
        const float clear =
            out.depth + start.radius * (flat + 0.15f) / std::max(steep, least_steepness);
        const float most = std::max(0.0f, std::min(0.6f * length, length - 2 * least_length()));
        const float by = std::min(clear, most);
        start.position += direction * by;
        start.path += by;
    }

    [[nodiscard]] float least_length() const {
        return step_ * static_cast<float>(options_.rings - 1);
    }

    /// The child's ring, a little wider, projected along it onto the plane that touches the parent,
    /// and wrapped around the parent.
    void place_collar(std::uint32_t chain, const branch_chain& parent, const branch_end& start,
                      const glm::vec3& direction, const outlet& out) {
        constexpr float flare = 1.2f;
        const glm::vec3 along = steep_enough(direction, out.normal, out.axis);
        const glm::vec3 east = glm::cross(out.axis, out.normal);
        const glm::vec3 x = shared::quaternion_x(start.orientation);
        const glm::vec3 z = shared::quaternion_z(start.orientation);
        const std::span<glm::vec2> loop =
            std::span(layout_.loops)
                .subspan(std::size_t{collar_[chain]} * options_.sides, options_.sides);
        glm::vec2 most(0);
        for (std::uint32_t c = 0; c < loop.size(); ++c) {
            const float angle = static_cast<float>(c) / static_cast<float>(loop.size()) * two_pi;
            const glm::vec3 ring = (x * std::cos(angle) - z * std::sin(angle)) * start.radius;
            const float down = glm::dot(ring, out.normal) / glm::dot(along, out.normal);
            const glm::vec3 foot = (ring - along * down) * flare;
            loop[c] = {glm::dot(foot, east), glm::dot(foot, out.axis)};
            most = glm::max(most, glm::abs(loop[c]));
        }
        const std::uint32_t last = layout_.order[parent.first + parent.count - 1];
        const float total = along_[last] + chord_length(last);
        const float widest = 0.9f * out.radius;
        const glm::vec2 shrink(std::min(1.0f, widest / most.x),
                               std::min(1.0f, 0.45f * total / most.y));
        const std::uint32_t s = layout_.order[parent.first + out.segment];
        const float t = std::clamp(out.along / chord_length(s), 0.0f, 1.0f);
        const float room = most.y * shrink.y * 1.1f;
        glm::vec2& centre = layout_.collars[collar_[chain]].centre;
        centre = {turn_of(s, t, out.normal),
                  std::clamp(along_[s] + out.along, room, std::max(room, total - room))};
        for (glm::vec2& p : loop) {
            p *= shrink;
            p.x = std::asin(p.x / out.radius) / two_pi;
            p += centre;
        }
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
    static constexpr float least_steepness = 0.4f;

    const skeleton& from_;
    const closed_mesh_options& options_;
    closed_layout layout_;
    std::vector<std::uint32_t> parent_; ///< of each chain
    std::vector<std::uint32_t> collar_; ///< of each chain
    std::vector<std::uint32_t> joined_; ///< of a chain's first segment: place in the parent's chain
    std::vector<float> along_;          ///< m, see add_up_lengths
    float step_ = 0;                    ///< m
};

} // namespace detail

/// The chains of a skeleton and how they join. Nearly linear time.
[[nodiscard]] inline closed_layout layout_closed(const skeleton& from,
                                                 const closed_mesh_options& options) {
    return detail::closed_layout_builder(from, options).build();
}

} // namespace skybark::trees
