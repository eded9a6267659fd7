#pragma once
// The triangles of one chain's tube, with a hole for each branch that grows from it.
//
// The tube is unrolled: U counts corners around it (period `sides`), V counts rings along it, and
// the ring kernel's own triangles fill the strip between the first and the last ring. A branch's
// collar is a loop of points in this plane. To let it in, triangles are taken out around its centre
// and a belt of new ones is put between the edge of what was taken out and the loop.
//
// Why the result is always one surface without other holes: what is taken out is a disk, because it
// starts as one triangle, grows over one edge at a time, and stays star-shaped about the centre and
// of different vertices; a disk less a smaller disk is a belt. It never grows over the edge of a
// loop or of the tube. Even a single triangle is enough, with the loop made small, so there is room
// for any number of branches.

#include <skybark/core/when_used.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

namespace skybark::trees::detail {

template <class = when_used>
class chain_surface {
  public:
    static constexpr std::uint32_t nothing = 0xffffffffu;

    /// Corners are vertices and how many periods further on they are seen from this triangle.
    struct triangle {
        std::array<std::uint32_t, 3> vertex{};
        std::array<std::int32_t, 3> wrap{};
        /// The triangle across the edge from corner n to corner n + 1.
        std::array<std::uint32_t, 3> across{};
        std::uint32_t hole = nothing; ///< that has taken it out
    };

    /// A collar's loop is vertices [first_vertex, first_vertex + sides); the belt around it
    /// triangles [first_triangle, first_triangle + triangles), some of which later holes may have
    /// taken out.
    struct hole {
        std::uint32_t first_vertex = 0;
        std::uint32_t first_triangle = 0;
        std::uint32_t triangles = 0;
        double centre_v = 0;
        double fit = 0; ///< size of the loop as a share of what was asked for, where it is smallest
    };

    /// Vertex V · sides + U is corner U of ring V, for V up to `gaps`.
    chain_surface(std::uint32_t sides, std::uint32_t gaps) : sides_(sides), gaps_(gaps) {
        const std::uint32_t grid = (gaps + 1) * sides;
        places_.reserve(grid);
        for (std::uint32_t i = 0; i < grid; ++i) {
            places_.emplace_back(i % sides, i / sides);
        }
        triangles_.resize(std::size_t{2} * sides * gaps);
        for (std::uint32_t i = 0; i < triangles_.size(); i += 2) {
            add_square(i);
        }
    }

    /// Lets in a loop of `sides` places (U, V) around `centre`, counter-clockwise. `metric` is the
    /// size of one U and one V. Where there is not enough room the loop is made smaller, and moved
    /// if it must be.
    const hole& cut(const glm::dvec2& centre, const std::vector<glm::dvec2>& loop,
                    const glm::dvec2& metric) {
        metric_ = metric;
        rays_.clear();
        double size = 0;
        for (const glm::dvec2& p : loop) {
            rays_.push_back((p - centre) * metric);
            size += glm::length(rays_.back()) / static_cast<double>(loop.size());
        }
        make_star(size);
        find_around(centre);
        disk best = grown(containing_, centre_);
        constexpr double enough = 0.5;
        if (best.fit < enough) {
            for (const std::uint32_t t : nearest(size)) {
                disk other = grown(t, middle(t));
                const double away =
                    glm::length((other.centre - nearest_image(other.centre)) * metric_);
                other.score = other.fit / (1 + 0.5 * away / size);
                if (other.score > best.score) {
                    best = std::move(other);
                }
            }
        }
        return take_out(best);
    }

    [[nodiscard]] const std::vector<triangle>& triangles() const { return triangles_; }
    [[nodiscard]] const std::vector<hole>& holes() const { return holes_; }
    /// Of a vertex: (U, V), U in its own period.
    [[nodiscard]] const glm::dvec2& place(std::uint32_t vertex) const { return places_[vertex]; }
    [[nodiscard]] std::uint32_t grid_vertices() const { return (gaps_ + 1) * sides_; }

  private:
    /// One edge of a disk's boundary: from `vertex` to the next edge's.
    struct edge {
        std::uint32_t vertex = 0;
        std::int32_t wrap = 0;
        std::uint32_t outside = nothing; ///< the triangle beyond
        bool settled = false;            ///< far enough from the loop, or nothing to grow into
    };
    struct disk {
        glm::dvec2 centre{0};
        std::vector<edge> rim; ///< counter-clockwise
        std::vector<std::uint32_t> taken;
        std::vector<double> shrink; ///< of each ray
        double fit = 0;
        double score = 0;
    };

    static double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

    /// The two triangles of a square as hermite_branch::ring_index has them: upper left, lower
    /// right.
    void add_square(std::uint32_t i) {
        const std::uint32_t v = i / (2 * sides_);
        const std::uint32_t u = i / 2 % sides_;
        const std::uint32_t next = (u + 1) % sides_;
        const std::int32_t wrap = u + 1 == sides_ ? 1 : 0;
        const std::uint32_t low = v * sides_;
        const std::uint32_t high = low + sides_;
        const std::uint32_t row = v * 2 * sides_;
        triangle& upper = triangles_[i];
        upper.vertex = {high + u, low + u, high + next};
        upper.wrap = {0, 0, wrap};
        upper.across = {row + 2 * ((u + sides_ - 1) % sides_) + 1, i + 1,
                        v + 1 < gaps_ ? i + 2 * sides_ + 1 : nothing};
        triangle& lower = triangles_[i + 1];
        lower.vertex = {high + next, low + u, low + next};
        lower.wrap = {wrap, 0, wrap};
        lower.across = {i, v > 0 ? i - 2 * sides_ : nothing, row + 2 * next};
    }

    [[nodiscard]] glm::dvec2 corner(const triangle& t, std::size_t n) const {
        return at(t.vertex[n], t.wrap[n]);
    }
    [[nodiscard]] glm::dvec2 at(std::uint32_t vertex, std::int32_t wrap) const {
        return {places_[vertex].x + static_cast<double>(sides_) * wrap, places_[vertex].y};
    }
    [[nodiscard]] glm::dvec2 middle(std::uint32_t t) const {
        // Of the inscribed circle, which has the most room around it.
        std::array<glm::dvec2, 3> p;
        std::array<double, 3> opposite{};
        for (std::size_t n = 0; n < 3; ++n) {
            p[n] = corner(triangles_[t], n);
        }
        double sum = 0;
        for (std::size_t n = 0; n < 3; ++n) {
            opposite[n] = glm::length((p[(n + 1) % 3] - p[(n + 2) % 3]) * metric_);
            sum += opposite[n];
        }
        return (p[0] * opposite[0] + p[1] * opposite[1] + p[2] * opposite[2]) / sum;
    }

    /// A loop that does not go once around the centre, ray after ray, becomes a circle.
    void make_star(double size) {
        const std::size_t n = rays_.size();
        bool star = true;
        for (std::size_t k = 0; k < n; ++k) {
            const glm::dvec2& a = rays_[k];
            const glm::dvec2& b = rays_[(k + 1) % n];
            star = star && cross(a, b) > 1e-3 * glm::length(a) * glm::length(b) / double(n);
        }
        for (std::size_t k = 0; !star && k < n; ++k) {
            const double angle = 6.283185307179586 * double(k) / double(n);
            rays_[k] = glm::dvec2(std::cos(angle), std::sin(angle)) * size;
        }
    }

    // ---- Finding the place
    // -----------------------------------------------------------------------

    /// The triangle that `centre` lies in, and those nearby that a loop may be put into instead.
    void find_around(const glm::dvec2& centre) {
        const double v = std::clamp(centre.y, 0.0, static_cast<double>(gaps_));
        const double turns = std::floor(centre.x / sides_);
        const double u = centre.x - turns * sides_;
        wanted_ = {u, v};
        const auto row = std::min(static_cast<std::uint32_t>(v), gaps_ - 1);
        const auto column = std::min(static_cast<std::uint32_t>(u), sides_ - 1);
        candidates_.clear();
        containing_ = nothing;
        visits_.resize(holes_.size(), 0);
        ++visit_;
        const std::uint32_t square = 2 * (row * sides_ + column);
        look_into(square);
        look_into(square + 1);
        if (containing_ == nothing) { // in another's hole, or on an edge
            const std::vector<std::uint32_t> around = nearest(1e-9);
            containing_ = around.empty() ? any_triangle(square) : around.front();
            centre_ = middle(containing_);
        }
    }

    /// Follows what holes have put in the place of a triangle. Whatever lay in it and is in no hole
    /// lies in a triangle of their belts.
    void look_into(std::uint32_t t) {
        if (triangles_[t].hole == nothing) {
            candidates_.push_back(t);
            if (containing_ == nothing && contains(t)) {
                containing_ = t;
            }
            return;
        }
        std::uint32_t& visit = visits_[triangles_[t].hole];
        if (visit == visit_) {
            return;
        }
        visit = visit_;
        const hole h = holes_[triangles_[t].hole];
        for (std::uint32_t n = 0; n < h.triangles; ++n) {
            look_into(h.first_triangle + n);
        }
    }

    /// Any that is still there: every belt is larger than what the next hole takes of it.
    [[nodiscard]] std::uint32_t any_triangle(std::uint32_t start) const {
        std::uint32_t t = start;
        while (triangles_[t].hole != nothing) {
            t = (t + 1) % static_cast<std::uint32_t>(triangles_.size());
        }
        return t;
    }

    /// `p`'s image of `wanted_`: the one closest to `p` around the tube.
    [[nodiscard]] glm::dvec2 nearest_image(const glm::dvec2& p) const {
        const double period = sides_;
        return {wanted_.x + period * std::round((p.x - wanted_.x) / period), wanted_.y};
    }

    [[nodiscard]] bool contains(std::uint32_t t) {
        for (int images = -1; images <= 1; ++images) {
            glm::dvec2 c = nearest_image(corner(triangles_[t], 0));
            c.x += images * static_cast<double>(sides_);
            if (least_distance(t, c) > 1e-6 * std::min(metric_.x, metric_.y)) {
                centre_ = c;
                return true;
            }
        }
        return false;
    }

    /// From the nearest edge to `c`, positive inside.
    [[nodiscard]] double least_distance(std::uint32_t t, const glm::dvec2& c) const {
        double least = 1e300;
        for (std::size_t n = 0; n < 3; ++n) {
            const glm::dvec2 a = (corner(triangles_[t], n) - c) * metric_;
            const glm::dvec2 b = (corner(triangles_[t], (n + 1) % 3) - c) * metric_;
            least = std::min(least, cross(a, b) / std::max(glm::length(b - a), 1e-300));
        }
        return least;
    }

    /// Up to six candidates, best first: near the place, and wide in measures of `size`.
    [[nodiscard]] std::vector<std::uint32_t> nearest(double size) const {
        constexpr std::size_t most = 6;
        std::vector<std::pair<double, std::uint32_t>> scored;
        scored.reserve(candidates_.size());
        for (const std::uint32_t t : candidates_) {
            const glm::dvec2 m = middle(t);
            const double width = least_distance(t, m);
            const double away = glm::length((m - nearest_image(m)) * metric_);
            scored.emplace_back(-std::min(width, size) / (size + 0.5 * away), t);
        }
        const std::size_t count = std::min(most, scored.size());
        std::partial_sort(scored.begin(), scored.begin() + static_cast<std::ptrdiff_t>(count),
                          scored.end());
        std::vector<std::uint32_t> best;
        for (std::size_t n = 0; n < count; ++n) {
            best.push_back(scored[n].second);
        }
        return best;
    }

    // ---- Growing a disk
    // --------------------------------------------------------------------------

    [[nodiscard]] disk grown(std::uint32_t start, const glm::dvec2& centre) const {
        disk d;
        d.centre = centre;
        const triangle& t = triangles_[start];
        for (std::size_t n = 0; n < 3; ++n) {
            d.rim.push_back({t.vertex[n], t.wrap[n], t.across[n], false});
        }
        d.taken.push_back(start);
        constexpr std::size_t most = 4096; // triangles: no branch covers as much of its parent
        for (bool more = true; more && d.taken.size() < most;) {
            more = false;
            for (std::size_t e = 0; e < d.rim.size(); ++e) {
                if (d.rim[e].settled) {
                    continue;
                }
                if (grow(d, e)) {
                    more = true;
                } else {
                    d.rim[e].settled = true;
                }
            }
        }
        fit_loop(d);
        return d;
    }

    [[nodiscard]] glm::dvec2 seen(const disk& d, const edge& e) const {
        return (at(e.vertex, e.wrap) - d.centre) * metric_;
    }

    /// Adds the triangle beyond edge `e` if the loop comes near that edge and it can be added.
    [[nodiscard]] bool grow(disk& d, std::size_t e) const {
        const std::size_t size = d.rim.size();
        const std::size_t after = (e + 1) % size;
        const edge own = d.rim[e];
        if (own.outside == nothing || !is_near(seen(d, own), seen(d, d.rim[after]))) {
            return false;
        }
        const triangle& t = triangles_[own.outside];
        // The edge is run the other way there, from the rim's next vertex to this one.
        const std::size_t n = edge_to(t, own, d.rim[after].vertex);
        const std::int32_t shift = own.wrap - t.wrap[(n + 1) % 3];
        const std::size_t tip = (n + 2) % 3;
        const edge first{own.vertex, own.wrap, t.across[(n + 1) % 3], false};
        const edge second{t.vertex[tip], t.wrap[tip] + shift, t.across[tip], false};
        const std::size_t before = (e + size - 1) % size;
        const std::size_t beyond = (after + 1) % size;
        const auto same = [](const edge& a, const edge& b) {
            return a.vertex == b.vertex && a.wrap == b.wrap;
        };
        if (size > 3 && same(second, d.rim[beyond]) && d.rim[after].outside == own.outside) {
            if (!turns_left(seen(d, own), seen(d, second))) {
                return false;
            }
            d.taken.push_back(own.outside);
            d.rim[e] = first;
            erase(d.rim, after);
            return true;
        }
        if (size > 3 && same(second, d.rim[before]) && d.rim[before].outside == own.outside) {
            if (!turns_left(seen(d, second), seen(d, d.rim[after]))) {
                return false;
            }
            d.taken.push_back(own.outside);
            d.rim[before] = {second.vertex, second.wrap, second.outside, false};
            erase(d.rim, e);
            return true;
        }
        for (const edge& other : d.rim) {
            if (other.vertex == second.vertex) {
                return false;
            }
        }
        if (!turns_left(seen(d, own), seen(d, second)) ||
            !turns_left(seen(d, second), seen(d, d.rim[after]))) {
            return false;
        }
        d.taken.push_back(own.outside);
        d.rim[e] = first;
        d.rim.insert(d.rim.begin() + static_cast<std::ptrdiff_t>(e + 1), second);
        return true;
    }

    static void erase(std::vector<edge>& rim, std::size_t e) {
        rim.erase(rim.begin() + static_cast<std::ptrdiff_t>(e));
    }

    /// Which edge of `t` runs from vertex `from` to the vertex of `to`.
    [[nodiscard]] static std::size_t edge_to(const triangle& t, const edge& to,
                                             std::uint32_t from) {
        std::size_t n = 0;
        while (n < 2 && (t.vertex[n] != from || t.vertex[(n + 1) % 3] != to.vertex)) {
            ++n;
        }
        return n;
    }

    [[nodiscard]] static bool turns_left(const glm::dvec2& a, const glm::dvec2& b) {
        return cross(a, b) > 1e-2 * glm::length(a) * glm::length(b);
    }

    /// How far the loop reaches in direction `p` from the centre.
    [[nodiscard]] double reach(const glm::dvec2& p) const {
        const std::size_t n = rays_.size();
        for (std::size_t k = 0; k < n; ++k) {
            const glm::dvec2& a = rays_[k];
            const glm::dvec2& b = rays_[(k + 1) % n];
            if (cross(a, p) >= 0 && cross(p, b) >= 0) {
                const double along = cross(b - a, p);
                return std::abs(along) > 1e-300 ? glm::length(p) * cross(b - a, a) / along
                                                : glm::length(a);
            }
        }
        return 0;
    }

    /// Whether the loop comes as near to the edge from `a` to `b` as it may come to none.
    [[nodiscard]] bool is_near(const glm::dvec2& a, const glm::dvec2& b) const {
        if (reach(a) > margin * glm::length(a) || reach(b) > margin * glm::length(b)) {
            return true;
        }
        for (const glm::dvec2& ray : rays_) {
            if (cross(a, ray) >= 0 && cross(ray, b) >= 0 && cross(b - a, ray - a) < 0) {
                return true;
            }
            if (cross(a, ray) >= 0 && cross(ray, b) >= 0 &&
                glm::length(ray) > margin * distance_to(a, b, ray)) {
                return true;
            }
        }
        return false;
    }

    /// From the centre in direction `ray` to the line through `a` and `b`.
    [[nodiscard]] static double distance_to(const glm::dvec2& a, const glm::dvec2& b,
                                            const glm::dvec2& ray) {
        const double along = cross(ray, b - a);
        return along > 0 ? glm::length(ray) * cross(a, b) / along : 1e300;
    }

    /// Shrinks the rays until the loop is inside the rim with some room to it.
    void fit_loop(disk& d) const {
        const std::size_t n = rays_.size();
        d.shrink.assign(n, 1);
        for (std::size_t e = 0; e < d.rim.size(); ++e) {
            const glm::dvec2 a = seen(d, d.rim[e]);
            const glm::dvec2 b = seen(d, d.rim[(e + 1) % d.rim.size()]);
            for (std::size_t k = 0; k < n; ++k) {
                if (cross(a, rays_[k]) >= 0 && cross(rays_[k], b) >= 0) {
                    const double room = margin * distance_to(a, b, rays_[k]);
                    d.shrink[k] = std::min(d.shrink[k], room / glm::length(rays_[k]));
                }
            }
        }
        double all = 1; // for the rim's vertices that come between two rays
        for (const edge& e : d.rim) {
            const glm::dvec2 p = seen(d, e);
            for (std::size_t k = 0; k < n; ++k) {
                const glm::dvec2 a = rays_[k] * d.shrink[k];
                const glm::dvec2 b = rays_[(k + 1) % n] * d.shrink[(k + 1) % n];
                if (cross(a, p) >= 0 && cross(p, b) >= 0) {
                    all = std::min(all, margin * glm::length(p) / distance_to(a, b, p));
                }
            }
        }
        d.fit = 1;
        for (double& s : d.shrink) {
            s *= all;
            d.fit = std::min(d.fit, s);
        }
        d.score = d.fit;
    }

    // ---- Putting the loop in
    // ---------------------------------------------------------------------

    const hole& take_out(const disk& d) {
        hole h;
        h.first_vertex = static_cast<std::uint32_t>(places_.size());
        h.first_triangle = static_cast<std::uint32_t>(triangles_.size());
        h.centre_v = d.centre.y;
        h.fit = d.fit;
        std::vector<glm::dvec2> inner;
        for (std::size_t k = 0; k < rays_.size(); ++k) {
            inner.push_back(rays_[k] * d.shrink[k]);
            places_.push_back(d.centre + inner.back() / metric_);
        }
        for (const std::uint32_t t : d.taken) {
            triangles_[t].hole = static_cast<std::uint32_t>(holes_.size());
        }
        add_belt(d, inner, h);
        holes_.push_back(h);
        return holes_.back();
    }

    /// The loop's vertex nearest in direction to `p`.
    [[nodiscard]] static std::size_t facing(const glm::dvec2& p,
                                            const std::vector<glm::dvec2>& inner) {
        std::size_t best = 0;
        double most = -2;
        for (std::size_t k = 0; k < inner.size(); ++k) {
            const double cosine = glm::dot(glm::normalize(inner[k]), glm::normalize(p));
            if (cosine > most) {
                most = cosine;
                best = k;
            }
        }
        return best;
    }

    /// Triangles between the rim and the loop. Each step goes one vertex on along one of them.
    void add_belt(const disk& d, const std::vector<glm::dvec2>& inner, hole& h) {
        std::vector<glm::dvec2> outer;
        for (const edge& e : d.rim) {
            outer.push_back(seen(d, e));
        }
        std::size_t start = facing(outer[0], inner);
        std::vector<bool> steps;
        if (outer.size() * inner.size() <= most_states) {
            double cost = 0;
            steps = best_steps(outer, inner, start, cost);
            for (std::size_t k = 0; k < inner.size() && cost >= turned_over; ++k) {
                double other = 0;
                std::vector<bool> tried = best_steps(outer, inner, k, other);
                if (other < cost) {
                    cost = other;
                    start = k;
                    steps = std::move(tried);
                }
            }
        }
        if (steps.empty() || !is_simple(steps, outer.size(), inner.size())) {
            start = facing(outer[0], inner);
            steps = even_steps(outer.size(), inner.size());
        }
        write_belt(d, h, steps, start);
    }

    /// True for a step along the rim. The triangles of the lowest cost together, from the edge
    /// between the rim's first vertex and the loop's vertex `start` round to that edge again.
    [[nodiscard]] static std::vector<bool> best_steps(const std::vector<glm::dvec2>& outer,
                                                      const std::vector<glm::dvec2>& inner,
                                                      std::size_t start, double& cost) {
        const std::size_t m = outer.size();
        const std::size_t n = inner.size();
        // costs[i][j]: to have gone i steps along the rim and j along the loop.
        std::vector<double> costs((m + 1) * (n + 1), 1e300);
        std::vector<bool> from_rim(costs.size());
        costs[0] = 0;
        for (std::size_t i = 0; i <= m; ++i) {
            for (std::size_t j = 0; j <= n; ++j) {
                const std::size_t here = i * (n + 1) + j;
                const glm::dvec2& o = outer[i % m];
                const glm::dvec2& p = inner[(start + j) % n];
                if (i < m) {
                    const double next = costs[here] + triangle_cost(o, outer[(i + 1) % m], p);
                    if (next < costs[here + n + 1]) {
                        costs[here + n + 1] = next;
                        from_rim[here + n + 1] = true;
                    }
                }
                if (j < n) {
                    const double next =
                        costs[here] + triangle_cost(inner[(start + j + 1) % n], p, o);
                    if (next < costs[here + 1]) {
                        costs[here + 1] = next;
                        from_rim[here + 1] = false;
                    }
                }
            }
        }
        cost = costs.back();
        std::vector<bool> steps;
        for (std::size_t here = costs.size() - 1; here != 0;) {
            steps.push_back(from_rim[here]);
            here -= from_rim[here] ? n + 1 : 1;
        }
        std::reverse(steps.begin(), steps.end());
        return steps;
    }

    /// How far a triangle is from an even one; far more where it is turned over.
    [[nodiscard]] static double triangle_cost(const glm::dvec2& a, const glm::dvec2& b,
                                              const glm::dvec2& c) {
        const double area = cross(b - a, c - a);
        const double edges =
            glm::dot(b - a, b - a) + glm::dot(c - b, c - b) + glm::dot(a - c, a - c);
        return area > 1e-6 * edges ? std::sqrt(edges / area) : turned_over;
    }

    [[nodiscard]] static std::vector<bool> even_steps(std::size_t m, std::size_t n) {
        std::vector<bool> steps;
        std::size_t i = 0;
        std::size_t j = 0;
        while (i < m || j < n) {
            const bool out = j >= n || (i < m && (2 * i + 1) * n < (2 * j + 1) * m);
            steps.push_back(out);
            ++(out ? i : j);
        }
        return steps;
    }

    /// Whether no two edges of the belt join the same vertices.
    [[nodiscard]] static bool is_simple(const std::vector<bool>& steps, std::size_t m,
                                        std::size_t n) {
        std::vector<std::pair<std::size_t, std::size_t>> edges;
        std::size_t i = 0;
        std::size_t j = 0;
        for (const bool out : steps) {
            edges.emplace_back(i % m, j % n);
            ++(out ? i : j);
        }
        std::sort(edges.begin(), edges.end());
        return std::adjacent_find(edges.begin(), edges.end()) == edges.end();
    }

    void write_belt(const disk& d, hole& h, const std::vector<bool>& steps, std::size_t start) {
        const auto sides = static_cast<std::uint32_t>(rays_.size());
        const auto first = static_cast<std::uint32_t>(start);
        h.triangles = static_cast<std::uint32_t>(steps.size());
        const auto number = [&](std::size_t n) {
            return h.first_triangle + static_cast<std::uint32_t>(n % steps.size());
        };
        std::size_t i = 0;
        std::uint32_t j = 0;
        for (std::size_t n = 0; n < steps.size(); ++n) {
            const edge& o = d.rim[i % d.rim.size()];
            const std::uint32_t p = h.first_vertex + (first + j) % sides;
            const std::uint32_t before = number(n + steps.size() - 1);
            const std::uint32_t after = number(n + 1);
            triangle t;
            if (steps[n]) {
                const edge& o_next = d.rim[(i + 1) % d.rim.size()];
                t.vertex = {o.vertex, o_next.vertex, p};
                t.wrap = {o.wrap, o_next.wrap, 0};
                t.across = {o.outside, after, before};
                if (o.outside != nothing) {
                    triangle& beyond = triangles_[o.outside];
                    beyond.across[edge_to(beyond, o, o_next.vertex)] = number(n);
                }
                ++i;
            } else {
                const std::uint32_t p_next = h.first_vertex + (first + j + 1) % sides;
                t.vertex = {p_next, p, o.vertex};
                t.wrap = {0, 0, o.wrap};
                t.across = {nothing, before, after};
                ++j;
            }
            triangles_.push_back(t);
        }
    }

    static constexpr double turned_over = 1e6;          ///< the cost of such a triangle
    static constexpr std::size_t most_states = 1 << 14; ///< of the search for the best belt
    static constexpr double margin = 0.8; ///< how much of the way to the rim a loop may go

    std::uint32_t sides_;
    std::uint32_t gaps_;
    std::vector<glm::dvec2> places_;
    std::vector<triangle> triangles_;
    std::vector<hole> holes_;
    // Of the cut under way:
    glm::dvec2 metric_{1};
    std::vector<glm::dvec2> rays_; ///< from the centre to the loop, in the metric
    glm::dvec2 wanted_{0};
    glm::dvec2 centre_{0};
    std::uint32_t containing_ = nothing;
    std::vector<std::uint32_t> candidates_;
    std::vector<std::uint32_t> visits_; ///< of each hole: the last cut that has looked into it
    std::uint32_t visit_ = 0;
};

} // namespace skybark::trees::detail
