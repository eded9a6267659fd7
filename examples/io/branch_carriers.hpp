#pragma once
// branch_carriers: which segments carry the vertices of a branch mesh, for a file with joints.

#include <io/surface_scene.hpp>

#include <skybark/trees/branch_mesh.hpp>
#include <skybark/trees/closed_mesh.hpp>

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

namespace detail {

template <backend B, record T>
[[nodiscard]] result<std::vector<T>> all_of(B& device, const typename B::buffer& buffer) {
    std::vector<T> records(buffer.size_bytes() / sizeof(T));
    if (auto done = read_back<B, T>(device, buffer, std::span(records)); !done) {
        return failure(done.error());
    }
    return records;
}

} // namespace detail

/// One a vertex of what `closed_mesh::download` gives. A point of a collar is carried as the
/// nearest corner of the triangle that it lies on, a tip as the end that it closes.
template <backend B>
[[nodiscard]] result<std::vector<vertex_carrier>> mesh_carriers(B& device,
                                                                const trees::closed_mesh<B>& mesh) {
    std::vector<vertex_carrier> all;
    const std::uint32_t sides = mesh.options().sides;
    const std::uint32_t rings = mesh.options().rings;
    for (const auto& p : mesh.parts()) {
        const auto segments = detail::all_of<B, branch_segment>(device, p.segments);
        const auto carriers = detail::all_of<B, end_carrier>(device, p.carriers);
        const auto points = detail::all_of<B, kernels::join_point>(device, p.points);
        const auto tips = detail::all_of<B, std::uint32_t>(device, p.tips);
        if (!segments || !carriers || !points || !tips) {
            return fail(error_code::device_lost, "The mesh could not be read back.");
        }
        const std::size_t first = all.size();
        for (const branch_segment& s : *segments) {
            const end_carrier& start = (*carriers)[s.start];
            const end_carrier& end = (*carriers)[s.end];
            for (std::uint32_t ring = 0; ring < rings; ++ring) {
                const float t = static_cast<float>(ring) / static_cast<float>(rings - 1);
                all.insert(all.end(), sides + 1, ring_carriers(end.turned_by, t, start, end));
            }
        }
        all.resize(first + p.vertex_count);
        for (std::size_t i = 0; i < points->size(); ++i) {
            const kernels::join_point& point = (*points)[i];
            const bool b = point.at_b > point.at_a && point.at_b >= point.at_c;
            const bool c = point.at_c > point.at_a && point.at_c > point.at_b;
            // Two vertices a point: the parent's and the child's.
            std::fill_n(all.begin() + static_cast<std::ptrdiff_t>(first + p.first_point + 2 * i), 2,
                        vertex_carrier(all[first + (c   ? point.c
                                                    : b ? point.b
                                                        : point.a)]));
        }
        for (std::size_t i = 0; i < tips->size(); ++i) {
            std::fill_n(all.begin() + static_cast<std::ptrdiff_t>(first + p.first_tip + i * sides),
                        sides, end_carriers((*carriers)[(*tips)[i] / 2]));
        }
    }
    return all;
}

/// One a vertex of what `branch_mesh::download` gives, in the rings form.
template <backend B>
[[nodiscard]] result<std::vector<vertex_carrier>> mesh_carriers(B& device,
                                                                const trees::branch_mesh<B>& mesh) {
    std::vector<vertex_carrier> all;
    const std::uint32_t sides = mesh.options().sides;
    const std::uint32_t rings = mesh.options().rings;
    for (const auto& p : mesh.parts()) {
        const auto carriers = detail::all_of<B, end_carrier>(device, p.carriers);
        if (!carriers) {
            return failure(carriers.error());
        }
        if (p.caps) {
            const auto caps = detail::all_of<B, std::uint32_t>(device, p.segments);
            if (!caps) {
                return failure(caps.error());
            }
            for (const std::uint32_t cap : *caps) {
                all.insert(all.end(), sides, end_carriers((*carriers)[cap / 2]));
            }
            continue;
        }
        const auto segments = detail::all_of<B, branch_segment>(device, p.segments);
        if (!segments) {
            return failure(segments.error());
        }
        for (const branch_segment& s : *segments) {
            const end_carrier& start = (*carriers)[s.start];
            const end_carrier& end = (*carriers)[s.end];
            for (std::uint32_t ring = 0; ring < rings; ++ring) {
                const float t = static_cast<float>(ring) / static_cast<float>(rings - 1);
                all.insert(all.end(), sides + 1, ring_carriers(end.turned_by, t, start, end));
            }
        }
    }
    return all;
}

} // namespace skybark::io
