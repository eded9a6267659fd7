#pragma once
// bundle_order: triangles as a bundle sees them, in the order of its cells, and where in that order
// each cell begins and ends.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/bundle.hpp>

namespace skybark::kernels {

/// Buffers: triangles; keys, numbers: sorted; corners: three vec4s a place in the order,
/// (a.x, a.y, b.x, b.y), (c.x, c.y, a.z, b.z) and (c.z, and as bits: the triangle, its alpha, 0);
/// runs: of each cell that has triangles, where they begin and end. Maps over the order.
struct bundle_order {
    using buffers =
        buffer_list<readonly<gather_triangle>, readonly<std::uint32_t>, readonly<std::uint32_t>,
                    writeonly<glm::vec4>, writeonly<glm::uvec2>>;

    ray_bundle bundle;
    std::uint32_t triangles = 0;

    void map(std::uint32_t i, std::span<const gather_triangle> of,
             std::span<const std::uint32_t> keys, std::span<const std::uint32_t> numbers,
             std::span<glm::vec4> corners, std::span<glm::uvec2> runs) const {
        const std::uint32_t number = numbers[i];
        const gather_triangle t = of[number];
        const glm::vec3 a = shared::across_bundle(bundle, t.a);
        const glm::vec3 b = shared::across_bundle(bundle, t.b);
        const glm::vec3 c = shared::across_bundle(bundle, t.c);
        corners[3 * std::size_t{i}] = glm::vec4(a.x, a.y, b.x, b.y);
        corners[3 * std::size_t{i} + 1] = glm::vec4(c.x, c.y, a.z, b.z);
        corners[3 * std::size_t{i} + 2] =
            glm::vec4(c.z, glm::uintBitsToFloat(number), glm::uintBitsToFloat(t.alpha), 0.0f);
        const std::uint32_t key = keys[i];
        if (i == 0 || keys[i - 1] != key) {
            runs[key].x = i;
        }
        if (i + 1 == triangles || keys[i + 1] != key) {
            runs[key].y = i + 1;
        }
    }
};
static_assert(sizeof(bundle_order) == 68);

} // namespace skybark::kernels
