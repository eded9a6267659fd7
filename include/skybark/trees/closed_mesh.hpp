#pragma once
// The branches of a tree, or of a stand, as one closed surface a tree, meshed on a device anew
// every time: forks joined to their parents, tips and bases closed. No edge lies at the border,
// none has more than two triangles, and each tree is one component without handles, in every pose.
//
//     auto mesh = trees::closed_mesh<B>::create(device, skeleton, {});
//     run(device, [&](auto& recorder) { mesh->record(recorder, poses); });
//
// Which vertices a triangle has depends on the skeleton alone and is settled once, by `create`. The
// vertices are made by the device: tubes like those of branch_mesh; the points of the collars, each
// on one of the tube's triangles; the points in which tips are closed.
//
// Vertices come in copies that agree in position, bit for bit, where texture coordinates don't: at
// the seam of a tube, along a collar (u and v of the parent and of the child), at a tip. `places`
// tells which are one. On collars and at tips tangent.w is 0: there u grows in no one direction.
// Around a hole across the seam u is below 0 or above 1: it means the same a whole turn on.
//
// What the surface may do: cross itself, where the skeleton does or a joint bends a lot.

#include <skybark/core/backend.hpp>
#include <skybark/core/when_used.hpp>
#include <skybark/kernels/branch_join.hpp>
#include <skybark/kernels/branch_tip.hpp>
#include <skybark/kernels/hermite_branch.hpp>
#include <skybark/kernels/pose_ends.hpp>
#include <skybark/kernels/unit_polygon.hpp>
#include <skybark/trees/branch_mesh.hpp>
#include <skybark/trees/chain_surface.hpp>
#include <skybark/trees/closed_layout.hpp>

#include <map>
#include <numeric>
#include <optional>

namespace skybark::trees {

namespace detail {

/// What the device needs for a part of the surface, and which places its vertices are at.
struct closed_part {
    std::vector<branch_segment> segments;
    std::vector<branch_end> ends;
    std::vector<end_carrier> carriers;
    std::vector<kernels::join_point> points;
    std::vector<std::uint32_t> tips;
    std::vector<std::uint32_t> indices;
    /// The first place of each segment, the place of each point and of each tip.
    std::vector<std::uint32_t> segment_places, point_places, tip_places;
};

/// Cuts the surface into parts, each with all the vertices that its triangles have.
template <class = when_used>
class closed_part_builder {
  public:
    /// `most_bytes` is the largest buffer, `alignment` what offsets into the vertices are multiples
    /// of.
    closed_part_builder(const closed_layout& layout, const closed_mesh_options& options,
                        std::uint64_t most_bytes, std::uint64_t alignment)
        : layout_(layout), options_(options), tube_{options.sides, options.rings, options.frame},
          most_bytes_(most_bytes), alignment_(alignment) {
        local_segment_.assign(layout.segments.size(), none);
        local_end_.assign(layout.ends.size(), none);
        first_place_.resize(layout.segments.size());
        pattern_.resize(std::size_t{3} * tube_.ring_triangles());
        for (std::uint32_t k = 0; k < pattern_.size(); ++k) {
            pattern_[k] = tube_.ring_index(k);
        }
        is_child_.resize(layout.chains.size());
        for (const branch_collar& collar : layout.collars) {
            is_child_[collar.child] = true;
        }
    }

    /// Calls `take(part)` for each part in turn until one gives an error.
    template <class Take>
    [[nodiscard]] result<void> build(Take&& take) {
        number_places();
        std::uint32_t collar = 0;
        for (std::uint32_t c = 0; c < layout_.chains.size(); ++c) {
            const std::uint32_t first = collar;
            while (collar < layout_.collars.size() && layout_.collars[collar].parent == c) {
                ++collar;
            }
            if (auto done = add_chain(c, first, collar, take); !done) {
                return done;
            }
        }
        return part_.indices.empty() ? result<void>{} : finish(take);
    }

  private:
    using vertex_key = std::pair<std::uint32_t, std::int32_t>; // chain_surface's vertex and wrap

    // Kinds of vertices, in the top bits of an index until the part is complete.
    static constexpr std::uint32_t point_bit = 0x40000000u;
    static constexpr std::uint32_t tip_bit = 0x80000000u;
    static constexpr std::uint32_t most_vertices = 0x3fffffffu;

    void number_places() {
        for (const branch_chain& chain : layout_.chains) {
            for (std::uint32_t k = 0; k < chain.count; ++k) {
                first_place_[layout_.order[chain.first + k]] = static_cast<std::uint32_t>(places_);
                places_ += std::uint64_t{options_.sides} * (options_.rings - 1);
            }
            places_ += options_.sides;
        }
        first_point_ = places_;
        places_ += std::uint64_t{options_.sides} * layout_.collars.size();
        first_tip_ = places_;
        places_ += 2 * layout_.chains.size();
    }

    template <class Take>
    [[nodiscard]] result<void> add_chain(std::uint32_t c, std::uint32_t first_collar,
                                         std::uint32_t last_collar, Take&& take) {
        chain_ = layout_.chains[c];
        surface_.reset();
        holes_.clear();
        if (first_collar != last_collar) {
            surface_.emplace(options_.sides, chain_.count * gaps());
            cut_holes(first_collar, last_collar);
        }
        std::size_t next = 0;
        for (std::uint32_t k = 0; k < chain_.count; ++k) {
            std::size_t last = next;
            while (last < holes_.size() && holes_[last].owner == k) {
                ++last;
            }
            const std::size_t first = next;
            next = last;
            if (!part_.indices.empty() && !has_room_for(first, last)) {
                if (auto done = finish(take); !done) {
                    return done;
                }
            }
            add_tube(k);
            for (std::size_t h = first; h < last; ++h) {
                add_belt(holes_[h]);
                add_skirt(holes_[h]);
            }
            if (k == 0 && !is_child_[c]) {
                add_tip(k, true, static_cast<std::uint32_t>(first_tip_ + 2 * std::uint64_t{c}));
            }
            if (k + 1 == chain_.count) {
                add_tip(k, false,
                        static_cast<std::uint32_t>(first_tip_ + 2 * std::uint64_t{c} + 1));
            }
        }
        local_point_.clear();
        return {};
    }

    // ---- Holes
    // -----------------------------------------------------------------------------------

    struct placed_hole {
        std::uint32_t owner = 0;    ///< the segment with whose triangles it goes, in the chain
        std::uint32_t number = 0;   ///< of the chain_surface's holes
        std::uint32_t segments = 0; ///< of the chain that its belt may have vertices of
    };

    [[nodiscard]] std::uint32_t gaps() const { return options_.rings - 1; }
    [[nodiscard]] std::uint32_t segment_at(std::uint32_t k) const {
        return layout_.order[chain_.first + k];
    }
    [[nodiscard]] const branch_end& start_of(std::uint32_t segment) const {
        return layout_.ends[layout_.segments[segment].start];
    }
    [[nodiscard]] const branch_end& end_of(std::uint32_t segment) const {
        return layout_.ends[layout_.segments[segment].end];
    }
    [[nodiscard]] std::uint32_t child_segment(std::uint32_t collar) const {
        return layout_.order[layout_.chains[layout_.collars[collar].child].first];
    }

    /// Thick branches first: they need the room most.
    void cut_holes(std::uint32_t first_collar, std::uint32_t last_collar) {
        along_.assign(1, 0);
        for (std::uint32_t k = 0; k < chain_.count; ++k) {
            along_.push_back(along_.back() + double{glm::distance(start_of(segment_at(k)).position,
                                                                  end_of(segment_at(k)).position)});
        }
        collars_.clear();
        for (std::uint32_t q = first_collar; q < last_collar; ++q) {
            collars_.push_back(q);
        }
        std::stable_sort(collars_.begin(), collars_.end(), [&](std::uint32_t a, std::uint32_t b) {
            return start_of(child_segment(a)).radius > start_of(child_segment(b)).radius;
        });
        for (std::uint32_t n = 0; n < collars_.size(); ++n) {
            cut_hole(n);
        }
        // No two holes have one number.
        std::sort(holes_.begin(), holes_.end(), [](const placed_hole& a, const placed_hole& b) {
            return a.owner != b.owner ? a.owner < b.owner : a.number < b.number;
        });
    }

    void cut_hole(std::uint32_t n) {
        const std::uint32_t q = collars_[n];
        const glm::dvec2 centre = unrolled(layout_.collars[q].centre);
        loop_.clear();
        for (std::uint32_t k = 0; k < options_.sides; ++k) {
            loop_.push_back(unrolled(layout_.loops[std::size_t{q} * options_.sides + k]));
        }
        const std::uint32_t around = segment_of(centre.y);
        const std::uint32_t s = segment_at(around);
        const double radius = (double{start_of(s).radius} + double{end_of(s).radius}) / 2;
        const glm::dvec2 metric(6.283185307179586 * radius / options_.sides,
                                (along_[around + 1] - along_[around]) / gaps());
        const chain_surface<>::hole& hole = surface_->cut(centre, loop_, metric);
        double low = hole.centre_v;
        double high = low;
        for (std::uint32_t t = 0; t < hole.triangles; ++t) {
            for (const std::uint32_t v : surface_->triangles()[hole.first_triangle + t].vertex) {
                low = std::min(low, surface_->place(v).y);
                high = std::max(high, surface_->place(v).y);
            }
        }
        holes_.push_back({segment_of(hole.centre_v), n, segment_of(high) - segment_of(low) + 1});
    }

    /// Turns and m along the chain as corners and rings.
    [[nodiscard]] glm::dvec2 unrolled(const glm::vec2& place) const {
        const auto after = std::upper_bound(along_.begin() + 1, along_.end() - 1, double{place.y});
        const auto k = static_cast<std::size_t>(after - along_.begin() - 1);
        const double t = (double{place.y} - along_[k]) / (along_[k + 1] - along_[k]);
        return {double{place.x} * options_.sides, (static_cast<double>(k) + t) * gaps()};
    }

    /// The segment of the chain that height V of its surface is on.
    [[nodiscard]] std::uint32_t segment_of(double v) const {
        const auto k = static_cast<std::uint32_t>(std::max(v, 0.0) / gaps());
        return std::min(k, chain_.count - 1);
    }

    // ---- Vertices
    // --------------------------------------------------------------------------------

    /// The first vertex of a segment's tube in this part, which has it from now on.
    std::uint32_t tube(std::uint32_t segment) {
        std::uint32_t& local = local_segment_[segment];
        if (local == none) {
            local = static_cast<std::uint32_t>(part_.segments.size());
            const branch_segment& s = layout_.segments[segment];
            const std::uint32_t start = end(s.start);
            part_.segments.push_back({start, end(s.end), 0, 0});
            part_.segment_places.push_back(first_place_[segment]);
            used_segments_.push_back(segment);
        }
        return local * tube_.ring_vertices();
    }

    std::uint32_t end(std::uint32_t number) {
        std::uint32_t& local = local_end_[number];
        if (local == none) {
            local = static_cast<std::uint32_t>(part_.ends.size());
            part_.ends.push_back(layout_.ends[number]);
            part_.carriers.push_back(layout_.carriers[number]);
            used_ends_.push_back(number);
        }
        return local;
    }

    /// Corner 0 … sides of ring `ring` of the chain.
    std::uint32_t ring_vertex(std::uint32_t ring, std::uint32_t corner) {
        const std::uint32_t k = std::min(ring / gaps(), chain_.count - 1);
        return tube(segment_at(k)) + (ring - k * gaps()) * (options_.sides + 1) + corner;
    }

    std::uint32_t add_point(const kernels::join_point& p, std::uint64_t place) {
        part_.points.push_back(p);
        part_.point_places.push_back(static_cast<std::uint32_t>(place));
        return point_bit | static_cast<std::uint32_t>(2 * (part_.points.size() - 1));
    }

    /// A loop's vertex: the place on the tube's triangle that it lies on, and the child's ring.
    [[nodiscard]] kernels::join_point loop_point(std::uint32_t vertex) {
        const glm::dvec2 at = surface_->place(vertex);
        const double period = options_.sides;
        const double turns = std::floor(at.x / period);
        const double u = at.x - turns * period;
        const auto ring =
            std::min(static_cast<std::uint32_t>(std::max(at.y, 0.0)), chain_.count * gaps() - 1);
        const auto corner = std::min(static_cast<std::uint32_t>(u), options_.sides - 1);
        const double fu = u - corner;
        const double fv = at.y - ring;
        kernels::join_point p{};
        p.a = ring_in_segment(ring, 0, corner);
        p.b = ring_in_segment(ring, 1, corner + 1);
        if (fu >= fv) { // lower right
            p.c = ring_in_segment(ring, 0, corner + 1);
            p.at_a = static_cast<float>(1 - fu);
            p.at_b = static_cast<float>(fv);
            p.at_c = static_cast<float>(fu - fv);
        } else { // upper left
            p.c = ring_in_segment(ring, 1, corner);
            p.at_a = static_cast<float>(1 - fv);
            p.at_b = static_cast<float>(fu);
            p.at_c = static_cast<float>(fv - fu);
        }
        p.turn = static_cast<float>(turns);
        const std::uint32_t loop = vertex - surface_->grid_vertices();
        p.child = tube(child_segment(collars_[loop / options_.sides])) + loop % options_.sides;
        return p;
    }
    /// Ring `ring` + `more` as a vertex of the segment that has both.
    std::uint32_t ring_in_segment(std::uint32_t ring, std::uint32_t more, std::uint32_t corner) {
        const std::uint32_t k = ring / gaps();
        return tube(segment_at(k)) + (ring - k * gaps() + more) * (options_.sides + 1) + corner;
    }

    [[nodiscard]] std::uint64_t loop_place(std::uint32_t vertex) const {
        const std::uint32_t loop = vertex - surface_->grid_vertices();
        return first_point_ + std::uint64_t{options_.sides} * collars_[loop / options_.sides] +
               loop % options_.sides;
    }

    /// A vertex of the unrolled surface, seen `wrap` periods further on.
    std::uint32_t surface_vertex_of(std::uint32_t vertex, std::int32_t wrap) {
        if (is_of_tube(vertex, wrap)) {
            return ring_vertex(vertex / options_.sides,
                               vertex % options_.sides + (wrap == 1 ? options_.sides : 0));
        }
        const auto [place, added] = local_point_.try_emplace({vertex, wrap}, 0);
        if (added) {
            if (vertex < surface_->grid_vertices()) {
                const std::uint32_t own =
                    ring_vertex(vertex / options_.sides, vertex % options_.sides);
                place->second =
                    add_point({own, own, own, kernels::no_child, 1, 0, 0, static_cast<float>(wrap)},
                              first_place_[segment_at(0)] + std::uint64_t{vertex});
            } else {
                kernels::join_point p = loop_point(vertex);
                p.turn += static_cast<float>(wrap);
                place->second = add_point(p, loop_place(vertex));
            }
        }
        return place->second;
    }

    [[nodiscard]] bool is_of_tube(std::uint32_t vertex, std::int32_t wrap) const {
        return vertex < surface_->grid_vertices() &&
               (wrap == 0 || (wrap == 1 && vertex % options_.sides == 0));
    }

    // ---- Triangles
    // -------------------------------------------------------------------------------

    void add_tube(std::uint32_t k) {
        const std::uint32_t base = tube(segment_at(k));
        const std::uint32_t triangles = tube_.ring_triangles();
        for (std::uint32_t t = 0; t < triangles; ++t) {
            if (surface_ && surface_->triangles()[std::size_t{k} * triangles + t].hole !=
                                chain_surface<>::nothing) {
                continue;
            }
            for (std::uint32_t n = 0; n < 3; ++n) {
                part_.indices.push_back(base + pattern_[std::size_t{3} * t + n]);
            }
        }
    }

    /// The triangles around a hole, as far as other holes have left them.
    void add_belt(const placed_hole& placed) {
        const chain_surface<>::hole& hole = surface_->holes()[placed.number];
        for (std::uint32_t n = 0; n < hole.triangles; ++n) {
            const chain_surface<>::triangle t = surface_->triangles()[hole.first_triangle + n];
            if (t.hole != chain_surface<>::nothing) {
                continue;
            }
            const std::int32_t shift = best_shift(t);
            for (std::size_t i = 0; i < 3; ++i) {
                part_.indices.push_back(surface_vertex_of(t.vertex[i], t.wrap[i] + shift));
            }
        }
    }

    /// By how many periods to see a triangle so that most of its vertices are there already.
    [[nodiscard]] std::int32_t best_shift(const chain_surface<>::triangle& t) const {
        std::int32_t best = 0;
        int most = -1;
        for (const std::int32_t wrap : t.wrap) {
            for (const std::int32_t shift : {-wrap, 1 - wrap}) {
                int there = 0;
                for (std::size_t i = 0; i < 3; ++i) {
                    const std::int32_t seen = t.wrap[i] + shift;
                    there += t.vertex[i] < surface_->grid_vertices()
                                 ? (is_of_tube(t.vertex[i], seen) ? 1 : 0)
                                 : (seen == 0 ? 1 : 0);
                }
                if (there > most) {
                    most = there;
                    best = shift;
                }
            }
        }
        return best;
    }

    /// From the loop, with the child's texture coordinates, to the child's first ring.
    void add_skirt(const placed_hole& placed) {
        const chain_surface<>::hole& hole = surface_->holes()[placed.number];
        const std::uint32_t ring = tube(child_segment(collars_[placed.number]));
        loop_vertices_.clear();
        for (std::uint32_t c = 0; c <= options_.sides; ++c) {
            const std::uint32_t vertex = hole.first_vertex + c % options_.sides;
            std::uint32_t point = 0;
            if (c < options_.sides) {
                point = surface_vertex_of(vertex, 0);
            } else { // the child's seam
                kernels::join_point p = loop_point(vertex);
                p.child = ring + c;
                point = add_point(p, loop_place(vertex));
            }
            loop_vertices_.push_back(point + 1);
        }
        for (std::uint32_t c = 0; c < options_.sides; ++c) {
            const std::uint32_t low = loop_vertices_[c];
            const std::uint32_t low_next = loop_vertices_[c + 1];
            for (const std::uint32_t index :
                 {ring + c, low, ring + c + 1, ring + c + 1, low, low_next}) {
                part_.indices.push_back(index);
            }
        }
    }

    /// Closes the chain at the start or the end of its segment `k`.
    void add_tip(std::uint32_t k, bool base, std::uint32_t place) {
        const branch_segment& s = layout_.segments[segment_at(k)];
        const std::uint32_t ring = tube(segment_at(k)) + (base ? 0 : gaps() * (options_.sides + 1));
        const std::uint32_t point =
            tip_bit | static_cast<std::uint32_t>(part_.tips.size() * options_.sides);
        part_.tips.push_back(2 * end(base ? s.start : s.end) + (base ? 1 : 0));
        part_.tip_places.push_back(place);
        for (std::uint32_t c = 0; c < options_.sides; ++c) {
            part_.indices.push_back(ring + c + (base ? 1 : 0));
            part_.indices.push_back(ring + c + (base ? 0 : 1));
            part_.indices.push_back(point + c);
        }
    }

    // ---- Parts
    // -----------------------------------------------------------------------------------

    /// Whether one more segment, with its holes from `first` to `last`, leaves every buffer small
    /// enough.
    [[nodiscard]] bool has_room_for(std::size_t first, std::size_t last) const {
        std::uint64_t segments = part_.segments.size() + 1;
        std::uint64_t points = part_.points.size();
        std::uint64_t triangles =
            part_.indices.size() / 3 + tube_.ring_triangles() + std::uint64_t{2} * options_.sides;
        for (std::size_t h = first; h < last; ++h) {
            const placed_hole& placed = holes_[h];
            const std::uint64_t belt = surface_->holes()[placed.number].triangles;
            segments += placed.segments + 1;
            points += 3 * belt + options_.sides + 1;
            triangles += belt + std::uint64_t{2} * options_.sides;
        }
        const std::uint64_t vertices = segments * tube_.ring_vertices() + 2 * points +
                                       (part_.tips.size() + 2) * options_.sides + 64;
        return vertices < most_vertices && vertices * sizeof(surface_vertex) <= most_bytes_ &&
               triangles * 12 <= most_bytes_;
    }

    template <class Take>
    [[nodiscard]] result<void> finish(Take&& take) {
        const auto points = static_cast<std::uint32_t>(
            aligned(std::uint64_t{tube_.ring_vertices()} * part_.segments.size()));
        const auto tips =
            static_cast<std::uint32_t>(aligned(points + std::uint64_t{2} * part_.points.size()));
        for (std::uint32_t& index : part_.indices) {
            if ((index & tip_bit) != 0) {
                index = (index & most_vertices) + tips;
            } else if ((index & point_bit) != 0) {
                index = (index & most_vertices) + points;
            }
        }
        auto done = take(std::as_const(part_), points, tips);
        for (const std::uint32_t s : used_segments_) {
            local_segment_[s] = none;
        }
        for (const std::uint32_t e : used_ends_) {
            local_end_[e] = none;
        }
        used_segments_.clear();
        used_ends_.clear();
        local_point_.clear();
        part_ = {};
        return done;
    }

    /// The first vertex from `vertex` on that a view may start at.
    [[nodiscard]] std::uint64_t aligned(std::uint64_t vertex) const {
        const std::uint64_t step = alignment_ / std::gcd(alignment_, sizeof(surface_vertex));
        return (vertex + step - 1) / step * step;
    }

    const closed_layout& layout_;
    closed_mesh_options options_;
    kernels::hermite_branch tube_;
    std::uint64_t most_bytes_;
    std::uint64_t alignment_;
    std::vector<std::uint32_t> pattern_; ///< indices of one segment's tube
    std::vector<bool> is_child_;         ///< of each chain
    // Places, numbered for the whole surface.
    std::vector<std::uint32_t> first_place_; ///< of each segment
    std::uint64_t first_point_ = 0;
    std::uint64_t first_tip_ = 0;
    std::uint64_t places_ = 0;
    // The chain under way.
    branch_chain chain_;
    std::optional<chain_surface<>> surface_; ///< where branches grow from it
    std::vector<double> along_;              ///< m, at each of its joints
    std::vector<std::uint32_t> collars_;     ///< of each hole
    std::vector<placed_hole> holes_;
    std::vector<glm::dvec2> loop_;
    std::vector<std::uint32_t> loop_vertices_;
    // The part under way, and what it has of the whole.
    closed_part part_;
    std::vector<std::uint32_t> local_segment_, local_end_, used_segments_, used_ends_;
    std::map<vertex_key, std::uint32_t> local_point_;
};

} // namespace detail

/// The branches of a skeleton as closed surfaces in buffers of backend B.
template <backend B>
requires maps<B, kernels::pose_ends> && maps<B, kernels::branch_join> &&
    maps<B, kernels::branch_tip> && expands_rings<B, kernels::hermite_branch>
class closed_mesh {
  public:
    using buffer = typename B::buffer;
    using recorder = typename B::recorder;

    /// Part of the mesh, small enough to be one draw. It has copies of the vertices that it shares
    /// with others, of the same bits.
    struct part {
        buffer segments; ///< branch_segment
        buffer ends;     ///< branch_end: where they are in this frame
        buffer rest;     ///< branch_end: where they are at rest
        buffer carriers; ///< end_carrier
        buffer points;   ///< join_point
        buffer tips;     ///< uint32, see branch_tip
        buffer vertices; ///< surface_vertex: tubes, from first_point on two a point, then tips
        buffer indices;  ///< uint32, three a triangle, counter-clockwise from outside
        std::uint32_t segment_count = 0;
        std::uint32_t end_count = 0;
        std::uint32_t point_count = 0;
        std::uint32_t tip_count = 0;
        std::uint32_t first_point = 0;
        std::uint32_t first_tip = 0;
        std::uint32_t vertex_count = 0;
        std::uint32_t triangles = 0;
        std::vector<std::uint32_t> segment_places, point_places, tip_places;
    };

    /// Settles the triangles and sends all to the device that `record` needs.
    /// Errors: bad_input where the options are out of range or the mesh would have 2^32 vertices or
    /// more; whatever the device says of memory.
    [[nodiscard]] static result<closed_mesh> create(B& device, const skeleton& of,
                                                    closed_mesh_options options) {
        if (auto valid = check(of, options); !valid) {
            return failure(valid.error());
        }
        closed_mesh mesh;
        mesh.options_ = options;
        auto corners = make_buffer<B, glm::vec4>(device, kernels::unit_polygon(options.sides));
        if (!corners) {
            return failure(corners.error());
        }
        mesh.corners_ = std::move(*corners);
        const closed_layout layout = layout_closed(of, options);
        const device_limits limits = device.limits();
        detail::closed_part_builder<> builder(layout, options, limits.max_buffer_bytes,
                                              limits.view_alignment);
        auto built = builder.build(
            [&](const detail::closed_part& p, std::uint32_t first_point, std::uint32_t first_tip) {
                return mesh.add_part(device, p, first_point, first_tip);
            });
        if (!built) {
            return failure(built.error());
        }
        if (mesh.vertices() >= 0xffffffffull) {
            return failure(too_many(mesh.vertices()).error());
        }
        return mesh;
    }

    /// Appends the making of all vertices at rest. Allocates nothing.
    void record(recorder& to) const { record_vertices(to, &part::rest); }

    /// Appends the making of all vertices where `poses`, one segment_pose for each segment of the
    /// skeleton, carry them. Allocates nothing.
    void record(recorder& to, const buffer_view<B>& poses) const {
        for (const part& p : parts_) {
            to.map(kernels::pose_ends{},
                   {view<B>(p.rest), view<B>(p.carriers), poses, view<B>(p.ends)},
                   range{0, p.end_count});
        }
        record_vertices(to, &part::ends);
    }

    /// What to draw: a kernel's vertices are `part.vertices`.
    [[nodiscard]] std::span<const part> parts() const { return parts_; }
    [[nodiscard]] draw_geometry<B> geometry(const part& p) const {
        return {view<B>(p.indices), 0, 3 * p.triangles, 0, {}};
    }

    [[nodiscard]] std::uint64_t triangles() const { return total(&part::triangles); }
    [[nodiscard]] std::uint64_t vertices() const { return total(&part::vertex_count); }
    [[nodiscard]] const closed_mesh_options& options() const { return options_; }

    /// The whole mesh. Not every vertex is a triangle's.
    [[nodiscard]] result<host_mesh> download(B& device) const {
        host_mesh mesh;
        for (const part& p : parts_) {
            const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
            const std::size_t first_index = mesh.indices.size();
            mesh.vertices.resize(std::size_t{first} + p.vertex_count);
            mesh.indices.resize(first_index + std::size_t{3} * p.triangles);
            auto read = device.download(p.vertices, 0, writable_bytes_of(mesh.vertices, first));
            if (!read) {
                return failure(read.error());
            }
            read = device.download(p.indices, 0, writable_bytes_of(mesh.indices, first_index));
            if (!read) {
                return failure(read.error());
            }
            for (std::size_t i = first_index; i < mesh.indices.size(); ++i) {
                mesh.indices[i] += first;
            }
        }
        return mesh;
    }

    /// For each vertex of the downloaded mesh which place it is at: equal numbers, equal positions,
    /// to the bit. `none` for vertices that fill a gap.
    [[nodiscard]] std::vector<std::uint32_t> places() const {
        std::vector<std::uint32_t> all;
        const std::uint32_t sides = options_.sides;
        for (const part& p : parts_) {
            const std::size_t first = all.size();
            all.resize(first + p.vertex_count, none);
            std::uint32_t* to = all.data() + first;
            for (const std::uint32_t place : p.segment_places) {
                for (std::uint32_t i = 0; i < options_.rings * (sides + 1); ++i) {
                    *to++ = place + i / (sides + 1) * sides + i % (sides + 1) % sides;
                }
            }
            to = all.data() + first + p.first_point;
            for (const std::uint32_t place : p.point_places) {
                to = std::fill_n(to, 2, place);
            }
            to = all.data() + first + p.first_tip;
            for (const std::uint32_t place : p.tip_places) {
                to = std::fill_n(to, sides, place);
            }
        }
        return all;
    }

  private:
    closed_mesh() = default;

    [[nodiscard]] static result<void> check(const skeleton& of,
                                            const closed_mesh_options& options) {
        const auto out_of_range = [](const char* what, std::uint32_t value, std::uint32_t least) {
            return fail(error_code::bad_input,
                        std::string("A closed mesh cannot have ") + std::to_string(value) + " " +
                            what + "; it takes " + std::to_string(least) + " to 1024.");
        };
        if (options.sides < 3 || options.sides > 1024) {
            return out_of_range("sides", options.sides, 3);
        }
        if (options.rings < 2 || options.rings > 1024) {
            return out_of_range("rings", options.rings, 2);
        }
        const std::uint64_t vertices =
            std::uint64_t{options.rings} * (options.sides + 1) * of.size();
        return vertices >= 0xffffffffull ? too_many(vertices) : result<void>{};
    }

    [[nodiscard]] static result<void> too_many(std::uint64_t vertices) {
        return fail(error_code::bad_input,
                    std::string("A mesh of ") + std::to_string(vertices) +
                        " vertices is beyond 32-bit indices; mesh the trees one by one.");
    }

    void record_vertices(recorder& to, buffer part::*ends) const {
        const kernels::hermite_branch tube{options_.sides, options_.rings, options_.frame};
        const kernels::branch_tip tip{options_.sides};
        for (const part& p : parts_) {
            const std::uint32_t tubes = p.segment_count * tube.ring_vertices();
            const auto made = view<B, surface_vertex>(p.vertices, 0, tubes);
            to.expand_rings(tube, {view<B>(p.segments), view<B>(p.*ends), view<B>(*corners_)},
                            range{0, p.segment_count}, made);
            if (p.point_count != 0) {
                to.map(kernels::branch_join{},
                       {view<B>(p.points), made,
                        view<B, surface_vertex>(p.vertices, p.first_point,
                                                std::uint64_t{2} * p.point_count)},
                       range{0, p.point_count});
            }
            if (p.tip_count != 0) {
                to.map(tip,
                       {view<B>(p.tips), view<B>(p.*ends), view<B>(*corners_),
                        view<B, surface_vertex>(p.vertices, p.first_tip,
                                                std::uint64_t{options_.sides} * p.tip_count)},
                       range{0, p.tip_count});
            }
        }
    }

    [[nodiscard]] result<void> add_part(B& device, const detail::closed_part& from,
                                        std::uint32_t first_point, std::uint32_t first_tip) {
        const std::uint64_t vertices =
            std::uint64_t{first_tip} + std::uint64_t{options_.sides} * from.tips.size();
        const std::uint64_t most = device.limits().max_buffer_bytes;
        const std::uint64_t largest =
            std::max<std::uint64_t>(vertices * sizeof(surface_vertex), from.indices.size() * 4);
        if (largest > most) {
            return fail(error_code::out_of_memory,
                        std::string("One branch segment and what joins it need a buffer of ") +
                            std::to_string(largest) +
                            " bytes, more than the device can bind; use fewer sides or rings.");
        }
        auto segments = make_buffer<B, branch_segment>(device, from.segments);
        auto rest = make_buffer<B, branch_end>(device, from.ends);
        auto ends = device.create_buffer(from.ends.size() * sizeof(branch_end));
        auto carriers = make_buffer<B, end_carrier>(device, from.carriers);
        auto points = make_buffer<B, kernels::join_point>(device, from.points);
        auto tips = make_buffer<B, std::uint32_t>(device, from.tips);
        auto vertex_buffer = device.create_buffer(vertices * sizeof(surface_vertex));
        auto indices = make_buffer<B, std::uint32_t>(device, from.indices);
        for (const auto* made :
             {&segments, &rest, &ends, &carriers, &points, &tips, &vertex_buffer, &indices}) {
            if (!*made) {
                return failure(made->error());
            }
        }
        parts_.push_back({std::move(*segments), std::move(*ends), std::move(*rest),
                          std::move(*carriers), std::move(*points), std::move(*tips),
                          std::move(*vertex_buffer), std::move(*indices),
                          static_cast<std::uint32_t>(from.segments.size()),
                          static_cast<std::uint32_t>(from.ends.size()),
                          static_cast<std::uint32_t>(from.points.size()),
                          static_cast<std::uint32_t>(from.tips.size()), first_point, first_tip,
                          static_cast<std::uint32_t>(vertices),
                          static_cast<std::uint32_t>(from.indices.size() / 3), from.segment_places,
                          from.point_places, from.tip_places});
        return {};
    }

    [[nodiscard]] std::uint64_t total(std::uint32_t part::*of) const {
        std::uint64_t sum = 0;
        for (const part& p : parts_) {
            sum += p.*of;
        }
        return sum;
    }

    closed_mesh_options options_;
    std::optional<buffer> corners_; // there after create
    std::vector<part> parts_;
};

} // namespace skybark::trees
