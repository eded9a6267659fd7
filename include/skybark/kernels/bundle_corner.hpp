#pragma once
// bundle_corner: a bundle's view of the triangles, as a raster: to peel their layers off.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/bundle.hpp>

namespace skybark::kernels {

/// Buffers: triangles. The square of the bundle fills the picture; depth grows along the bundle,
/// from just above 0 at −reach to just below 1 at +reach.
struct bundle_corner {
    using buffers = buffer_list<readonly<gather_triangle>>;

    ray_bundle bundle;
    float reach = 1; ///< how far the scene goes from its middle at most, m

    [[nodiscard]] glm::vec4 corner(std::uint32_t index,
                                   std::span<const gather_triangle> triangles) const {
        const gather_triangle t = triangles[index / 3];
        const glm::vec3 place = index % 3 == 0 ? t.a : index % 3 == 1 ? t.b : t.c;
        const glm::vec3 at = shared::across_bundle(bundle, place);
        return glm::vec4(at.x / bundle.centre.w, at.y / bundle.centre.w,
                         shared::depth_of_layer(at.z, reach), 1.0f);
    }
};
static_assert(sizeof(bundle_corner) == 68);

} // namespace skybark::kernels
