#pragma once
// What the kernels of multiple scattering share: cells of a grid, their balance, their children.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/scatter.hpp>

#include <glm/common.hpp>

namespace skybark::kernels {

/// The equation of one grid: parameters of the kernels that relax and restrict it.
struct scatter_equation {
    glm::vec4 sides{1, 1, 1, 0}; ///< xyz: of a cell, m; w: resistance of empty space, 1/m
    float absorption = 0;        ///< 1 − albedo

    /// Volumes: fluence, resistance, extinction, source.
    template <class Grids>
    [[nodiscard]] shared::scatter_balance balance(glm::ivec3 at, bool from_zero,
                                                  const Grids& grids) const {
        const glm::ivec3 size = grids.size(1);
        const float here = grids.load(1, at);
        shared::scatter_balance sum{grids.load(3, at), absorption * grids.load(2, at)};
        const auto across = [&](int axis, glm::ivec3 to) {
            if (to[axis] < 0 || to[axis] >= size[axis]) {
                sum.loss += shared::scatter_escape(sides.w, sides[axis]) / sides[axis];
                return;
            }
            const float phi = from_zero ? 0.0f : grids.load(0, to);
            sum = shared::scatter_across(sum, phi, here, grids.load(1, to), sides[axis]);
        };
        across(0, {at.x - 1, at.y, at.z});
        across(0, {at.x + 1, at.y, at.z});
        across(1, {at.x, at.y - 1, at.z});
        across(1, {at.x, at.y + 1, at.z});
        across(2, {at.x, at.y, at.z - 1});
        across(2, {at.x, at.y, at.z + 1});
        return sum;
    }
};

/// Which axes a coarser grid halves: bit 0 for x, 1 for y, 2 for z.
constexpr std::uint32_t all_axes = 7;
/// 1 for each axis of a grid that is halved; one of a single cell stays as it is.
[[nodiscard]] inline glm::ivec3 halved_axes(std::uint32_t axes, glm::ivec3 size) {
    return {size.x > 1 ? static_cast<int>(axes & 1) : 0,
            size.y > 1 ? static_cast<int>(axes >> 1 & 1) : 0,
            size.z > 1 ? static_cast<int>(axes >> 2 & 1) : 0};
}

/// The first of the cells (up to 2 along each axis) that a coarser cell is made of.
[[nodiscard]] inline glm::ivec3 first_child(glm::ivec3 parent, glm::ivec3 halved) {
    return parent * (1 + halved);
}

/// Child 0…7; those along an axis that is not halved are the same ones twice. Where an odd grid
/// ends it lies outside, and is `held` to the last cell instead.
[[nodiscard]] inline glm::ivec3 child_of(glm::ivec3 first, int which, glm::ivec3 halved) {
    return first + glm::ivec3(which & 1, which >> 1 & 1, which >> 2) * halved;
}
[[nodiscard]] inline glm::ivec3 held(glm::ivec3 at, glm::ivec3 size) {
    return glm::min(at, size - 1);
}
[[nodiscard]] inline bool within(glm::ivec3 at, glm::ivec3 size) {
    return at.x < size.x && at.y < size.y && at.z < size.z;
}

} // namespace skybark::kernels
