#pragma once
// branch_carriers: which segments carry the vertices of a branch mesh, for a file with joints.

#include <io/surface_scene.hpp>

#include <skybark/trees/branch_mesh.hpp>

#include <span>
#include <vector>

namespace skybark::io {

/// What carries an end: half one segment, half the other; the same at a free end.
[[nodiscard]] inline vertex_carrier end_carriers(const end_carrier& end) {
    return {end.turned_by, end.and_by, end.turned_by == end.and_by ? 0.0f : 0.5f};
}

/// What carries a ring at t (0 at the start, 1 at the end) of segment `segment`: the segment alone
/// in the middle, and from there on ever more of the one that it shares the end with.
[[nodiscard]] inline vertex_carrier
ring_carriers(std::uint32_t segment, float t, const end_carrier& start, const end_carrier& end) {
    const end_carrier& near = t < 0.5f ? start : end;
    const std::uint32_t other = near.turned_by == segment ? near.and_by : near.turned_by;
    const float away = t < 0.5f ? 0.5f - t : t - 0.5f;
    return {segment, other, other == segment ? 0.0f : away};
}

/// One a vertex of what `branch_mesh::download` gives of the rings form: the rings of all segments,
/// then the caps, a segment's start before its end. `carriers` has one an end of the layout.
[[nodiscard]] inline std::vector<vertex_carrier>
branch_carriers(std::span<const branch_segment> segments, std::span<const end_carrier> carriers,
                const trees::branch_mesh_options& options) {
    std::vector<vertex_carrier> all;
    all.reserve(segments.size() * options.rings * (options.sides + 1));
    for (std::uint32_t i = 0; i < segments.size(); ++i) {
        for (std::uint32_t ring = 0; ring < options.rings; ++ring) {
            const float t = static_cast<float>(ring) / static_cast<float>(options.rings - 1);
            all.insert(all.end(), options.sides + 1,
                       ring_carriers(i, t, carriers[segments[i].start], carriers[segments[i].end]));
        }
    }
    for (const branch_segment& s : segments) {
        if ((s.caps & cap_start) != 0) {
            all.insert(all.end(), options.sides, end_carriers(carriers[s.start]));
        }
        if ((s.caps & cap_end) != 0) {
            all.insert(all.end(), options.sides, end_carriers(carriers[s.end]));
        }
    }
    return all;
}

} // namespace skybark::io
