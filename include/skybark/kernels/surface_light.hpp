#pragma once
// surface_light: the radiance that leaves each patch.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/gathered_light.hpp>

namespace skybark::kernels {

/// Buffers: owners: of each patch, 2 · its triangle, + 1 on the back; tables and triangles, one a
/// triangle; materials; irradiance, a vec4 a patch, W/m²; radiance, a vec4 a patch, W/(m² sr):
/// emission + (diffuse · irradiance + transmission · irradiance of the other side) / π. Maps over
/// patches.
struct surface_light {
    using buffers =
        buffer_list<readonly<std::uint32_t>, readonly<patch_table>, readonly<gather_triangle>,
                    readonly<gather_material>, readonly<glm::vec4>, writeonly<glm::vec4>>;

    void map(std::uint32_t i, std::span<const std::uint32_t> owners,
             std::span<const patch_table> tables, std::span<const gather_triangle> triangles,
             std::span<const gather_material> materials, std::span<const glm::vec4> irradiance,
             std::span<glm::vec4> radiance) const {
        const bool back = owners[i] % 2 == 1;
        const patch_table table = tables[owners[i] / 2];
        const std::uint32_t other =
            back ? table.front + (i - table.back) : table.back + (i - table.front);
        const bool two_sided = table.back != no_surface;
        radiance[i] =
            shared::leaving_radiance(materials[triangles[owners[i] / 2].material], irradiance[i],
                                     two_sided ? irradiance[other] : glm::vec4(0));
    }
};

} // namespace skybark::kernels
