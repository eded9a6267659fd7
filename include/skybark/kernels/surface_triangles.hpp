#pragma once
// surface_triangles: triangles that light meets, out of a mesh that another pattern made.

#include <skybark/core/kernel.hpp>

namespace skybark::kernels {

/// Buffers: vertices; indices, three a triangle, or anything where `indexed` is 0: three vertices
/// after another; triangles, written from `first` on. Maps over triangles.
struct surface_triangles {
    using buffers =
        buffer_list<readonly<surface_vertex>, readonly<std::uint32_t>, writeonly<gather_triangle>>;

    std::uint32_t first = 0;
    std::uint32_t material = 0;
    std::uint32_t alpha = 0; ///< 0, or the alpha_coordinates of triangle 0; the others' follow
    std::uint32_t indexed = 0;

    void map(std::uint32_t i, std::span<const surface_vertex> vertices,
             std::span<const std::uint32_t> indices, std::span<gather_triangle> triangles) const {
        const auto corner = [&](std::uint32_t k) {
            const std::uint32_t at = 3 * i + k;
            return vertices[indexed != 0 ? indices[at] : at].position;
        };
        gather_triangle made;
        made.a = corner(0);
        made.material = material;
        made.b = corner(1);
        made.alpha = alpha == 0 ? 0 : alpha + i;
        made.c = corner(2);
        triangles[first + i] = made;
    }
};
static_assert(sizeof(surface_triangles) == 16);

} // namespace skybark::kernels
