#pragma once
// probe_peel: a peel of triangles whose corners are given, to be checked.

#include <skybark/core/kernel.hpp>

namespace skybark::kernels {

/// Buffers: corners, three a triangle: xyz in clip space. Every corner is scaled and moved, so that
/// parameters reach the device as well; with the defaults its bits stay as they are.
struct probe_peel {
    using buffers = buffer_list<readonly<glm::vec4>>;

    glm::vec4 scale{1, 1, 1, 0};
    glm::vec4 shift{0, 0, 0, 0};

    [[nodiscard]] glm::vec4 corner(std::uint32_t index, std::span<const glm::vec4> corners) const {
        const glm::vec4 p = corners[index];
        return {p.x * scale.x + shift.x, p.y * scale.y + shift.y, p.z * scale.z + shift.z, 1.0f};
    }
};
static_assert(sizeof(probe_peel) == 32);

} // namespace skybark::kernels
