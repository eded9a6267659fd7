#pragma once
// bundle_key: which cell of a bundle's grids each triangle lies in, to sort by.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/bundle.hpp>

namespace skybark::kernels {

/// Buffers: triangles; keys, numbers: one word each a triangle, the cell and the triangle itself.
/// Maps over triangles.
struct bundle_key {
    using buffers =
        buffer_list<readonly<gather_triangle>, writeonly<std::uint32_t>, writeonly<std::uint32_t>>;

    ray_bundle bundle;

    void map(std::uint32_t i, std::span<const gather_triangle> triangles,
             std::span<std::uint32_t> keys, std::span<std::uint32_t> numbers) const {
        const gather_triangle t = triangles[i];
        keys[i] = shared::bundle_cell(bundle, shared::across_bundle(bundle, t.a),
                                      shared::across_bundle(bundle, t.b),
                                      shared::across_bundle(bundle, t.c));
        numbers[i] = i;
    }
};
static_assert(sizeof(bundle_key) == 64);

} // namespace skybark::kernels
