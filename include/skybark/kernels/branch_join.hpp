#pragma once
// branch_join: the vertices of the loops along which branches join their parents.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/join.hpp>

#include <cstddef>

namespace skybark::kernels {

using join_point = shared::join_point;
static_assert(sizeof(join_point) == 32);
static_assert(offsetof(join_point, child) == 12 && offsetof(join_point, at_a) == 16 &&
              offsetof(join_point, turn) == 28);

/// The child of a join_point that is a vertex of the parent's tube once more, at u + turn.
inline constexpr std::uint32_t no_child = 0xffffffffu;

/// Buffers: points, the tubes' vertices, two vertices a point: with the texture coordinates of the
/// parent, and (left alone where there is no child) of the child. Maps over points.
struct branch_join {
    using buffers =
        buffer_list<readonly<join_point>, readonly<surface_vertex>, writeonly<surface_vertex>>;

    void map(std::uint32_t i, std::span<const join_point> points,
             std::span<const surface_vertex> tubes, std::span<surface_vertex> vertices) const {
        const join_point& p = points[i];
        if (p.child == no_child) {
            vertices[2 * i] = shared::join_turned(p, tubes[p.a]);
            return;
        }
        const surface_vertex own = shared::join_vertex(p, tubes[p.a], tubes[p.b], tubes[p.c]);
        vertices[2 * i] = own;
        vertices[2 * i + 1] = shared::join_vertex_of_child(own, tubes[p.child]);
    }
};

} // namespace skybark::kernels
