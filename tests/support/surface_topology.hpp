#pragma once
// Whether triangles over numbered places are closed surfaces, how many, and of which genus.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <unordered_map>
#include <vector>

namespace skybark::support {

/// One connected component: triangles that share places.
struct surface_component {
    std::size_t places = 0;
    std::size_t edges = 0;
    std::size_t triangles = 0;

    /// V − E + F: 2 for a closed surface of genus 0.
    [[nodiscard]] long euler() const {
        return static_cast<long>(places) - static_cast<long>(edges) + static_cast<long>(triangles);
    }
};

struct surface_topology {
    std::size_t boundary_edges = 0;   ///< of one triangle
    std::size_t crowded_edges = 0;    ///< of more than two
    std::size_t unoriented_edges = 0; ///< of two that run it the same way
    std::size_t collapsed = 0;        ///< triangles whose corners are not three places
    std::size_t pinched = 0;          ///< places whose triangles are not one fan
    std::vector<surface_component> components;

    /// Nothing but closed, oriented surfaces without handles.
    [[nodiscard]] bool closed() const {
        return boundary_edges == 0 && crowded_edges == 0 && unoriented_edges == 0 &&
               collapsed == 0 && pinched == 0;
    }
    [[nodiscard]] bool spheres(std::size_t count) const {
        return closed() && components.size() == count &&
               std::all_of(components.begin(), components.end(),
                           [](const surface_component& c) { return c.euler() == 2; });
    }
};

namespace detail {

class union_find {
  public:
    explicit union_find(std::size_t size) : parent_(size) {
        std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    }
    [[nodiscard]] std::size_t find(std::size_t i) {
        while (parent_[i] != i) {
            parent_[i] = parent_[parent_[i]];
            i = parent_[i];
        }
        return i;
    }
    void join(std::size_t a, std::size_t b) { parent_[find(a)] = find(b); }

  private:
    std::vector<std::size_t> parent_;
};

} // namespace detail

/// `places[index]` is the place of a vertex; three indices a triangle. Places that no triangle has
/// count for nothing.
[[nodiscard]] inline surface_topology examine_surface(std::span<const std::uint32_t> places,
                                                      std::span<const std::uint32_t> indices) {
    surface_topology found;
    const std::size_t triangles = indices.size() / 3;
    std::uint32_t most = 0;
    for (const std::uint32_t index : indices) {
        most = std::max(most, places[index]);
    }
    struct half_edge {
        std::uint64_t ends = 0;   // smaller place first
        std::uint32_t corner = 0; // 3 · triangle + which
        bool forth = false;       // from the smaller place to the larger
    };
    std::vector<half_edge> half_edges;
    half_edges.reserve(indices.size());
    std::vector<bool> collapsed(triangles);
    detail::union_find parts(std::size_t{most} + 1);
    for (std::size_t t = 0; t < triangles; ++t) {
        const std::array<std::uint32_t, 3> v = {places[indices[3 * t]], places[indices[3 * t + 1]],
                                                places[indices[3 * t + 2]]};
        parts.join(v[0], v[1]);
        parts.join(v[0], v[2]);
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
            ++found.collapsed;
            collapsed[t] = true;
            continue;
        }
        for (std::size_t n = 0; n < 3; ++n) {
            const std::uint32_t a = v[n];
            const std::uint32_t b = v[(n + 1) % 3];
            half_edges.push_back({std::uint64_t{std::min(a, b)} << 32 | std::max(a, b),
                                  static_cast<std::uint32_t>(3 * t + n), a < b});
        }
    }
    std::sort(half_edges.begin(), half_edges.end(),
              [](const half_edge& a, const half_edge& b) { return a.ends < b.ends; });

    // A place's corners are one fan if walking over shared edges joins them all.
    detail::union_find fans(3 * triangles);
    std::unordered_map<std::size_t, std::size_t> component;
    const auto component_of = [&](std::uint32_t place) -> surface_component& {
        const auto [at, added] = component.try_emplace(parts.find(place), found.components.size());
        if (added) {
            found.components.emplace_back();
        }
        return found.components[at->second];
    };
    for (std::size_t first = 0; first < half_edges.size();) {
        std::size_t last = first + 1;
        while (last < half_edges.size() && half_edges[last].ends == half_edges[first].ends) {
            ++last;
        }
        const std::size_t count = last - first;
        found.boundary_edges += count == 1 ? 1 : 0;
        found.crowded_edges += count > 2 ? 1 : 0;
        if (count == 2) {
            const half_edge& a = half_edges[first];
            const half_edge& b = half_edges[first + 1];
            found.unoriented_edges += a.forth == b.forth ? 1 : 0;
            // Corner n starts the edge, corner n + 1 ends it; opposite directions pair up.
            const auto next = [](std::uint32_t c) { return c % 3 == 2 ? c - 2 : c + 1; };
            if (a.forth == b.forth) {
                fans.join(a.corner, b.corner);
                fans.join(next(a.corner), next(b.corner));
            } else {
                fans.join(a.corner, next(b.corner));
                fans.join(next(a.corner), b.corner);
            }
        }
        ++component_of(static_cast<std::uint32_t>(half_edges[first].ends)).edges;
        first = last;
    }
    std::vector<std::size_t> fan(std::size_t{most} + 1, ~std::size_t{0});
    std::vector<bool> pinched(std::size_t{most} + 1);
    for (std::size_t t = 0; t < triangles; ++t) {
        if (collapsed[t]) {
            continue;
        }
        ++component_of(places[indices[3 * t]]).triangles;
        for (std::size_t n = 0; n < 3; ++n) {
            const std::uint32_t place = places[indices[3 * t + n]];
            const std::size_t own = fans.find(3 * t + n);
            if (fan[place] == ~std::size_t{0}) {
                fan[place] = own;
                ++component_of(place).places;
            } else if (fan[place] != own && !pinched[place]) {
                pinched[place] = true;
                ++found.pinched;
            }
        }
    }
    return found;
}

} // namespace skybark::support
