#pragma once
// The polygon that every ring is made from, kept where all elements read it (Akagi and Kitajima,
// 3.3: the unit octagon in constant memory).

#include <cmath>
#include <cstdint>
#include <glm/vec4.hpp>
#include <vector>

namespace skybark::kernels {

/// sides + 1 corners (cos, sin, u, 0). The last is the first again, with u = 1 in place of 0, so
/// that a texture goes once around.
[[nodiscard]] inline std::vector<glm::vec4> unit_polygon(std::uint32_t sides) {
    constexpr double two_pi = 6.283185307179586476925286766559;
    std::vector<glm::vec4> corners(std::size_t{sides} + 1);
    for (std::uint32_t i = 0; i <= sides; ++i) {
        const double angle = two_pi * (i % sides) / sides;
        corners[i] = {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)),
                      static_cast<float>(static_cast<double>(i) / sides), 0.0f};
    }
    return corners;
}

} // namespace skybark::kernels
