#pragma once
// patch_samples: the points at which surfaces ask for the light that they pass on: the middles of
// their patches.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/bundle.hpp>

#include <cmath>

namespace skybark::kernels {

/// Buffers: owners: of each patch, 2 · its triangle, + 1 on the back; tables and triangles, one a
/// triangle; samples, one a patch. Maps over patches. A triangle without an area has no normal: its
/// samples' are 0, and they gather nothing.
struct patch_samples {
    using buffers = buffer_list<readonly<std::uint32_t>, readonly<patch_table>,
                                readonly<gather_triangle>, writeonly<gather_sample>>;

    void map(std::uint32_t i, std::span<const std::uint32_t> owners,
             std::span<const patch_table> tables, std::span<const gather_triangle> triangles,
             std::span<gather_sample> samples) const {
        const bool back = owners[i] % 2 == 1;
        const patch_table table = tables[owners[i] / 2];
        const gather_triangle t = triangles[owners[i] / 2];
        const shared::barycentric middle =
            shared::patch_middle(table.rows, i - (back ? table.back : table.front));
        const glm::vec3 ab = t.b - t.a;
        const glm::vec3 ac = t.c - t.a;
        const glm::vec3 across(ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z,
                               ab.x * ac.y - ab.y * ac.x);
        const float size =
            std::sqrt((across.x * across.x + across.y * across.y) + across.z * across.z);
        const float side = back ? -1.0f : 1.0f;
        gather_sample made;
        made.position = (t.a + middle.u * ab) + middle.v * ac;
        made.normal = size > 0.0f ? across * (side / size) : glm::vec3(0);
        samples[i] = made;
    }
};

} // namespace skybark::kernels
