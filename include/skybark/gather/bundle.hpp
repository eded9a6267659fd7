#pragma once
// Bundles of parallel rays: the frame that a scene is looked at in.

#include <skybark/core/records.hpp>
#include <skybark/core/when_used.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <span>

namespace skybark::gather {

/// A box that holds a scene, m. Empty where `high` is below `low`.
struct bounds {
    glm::vec3 low{std::numeric_limits<float>::max()};
    glm::vec3 high{std::numeric_limits<float>::lowest()};

    [[nodiscard]] bool empty() const noexcept { return !(low.x <= high.x); }
    [[nodiscard]] glm::vec3 middle() const noexcept { return low + 0.5f * (high - low); }
    [[nodiscard]] float diagonal() const noexcept { return empty() ? 0 : glm::length(high - low); }

    void add(glm::vec3 place) noexcept {
        low = glm::min(low, place);
        high = glm::max(high, place);
    }
};

/// The box of all triangles whose corners are finite: others meet no light.
template <class = when_used>
[[nodiscard]] bounds bounds_of(std::span<const gather_triangle> triangles) {
    bounds box;
    for (const gather_triangle& t : triangles) {
        const glm::vec3 sum = t.a + t.b + t.c;
        if (std::isfinite(sum.x) && std::isfinite(sum.y) && std::isfinite(sum.z)) {
            box.add(t.a);
            box.add(t.b);
            box.add(t.c);
        }
    }
    return box;
}

/// How far samples stand off their surfaces, m, unless a caller knows better: 1e-5 of the diagonal,
/// some forty times what single precision loses across a bundle.
[[nodiscard]] inline float default_lift(const bounds& box) { return 1e-5f * box.diagonal(); }

/// Cells on a side of a bundle's finest grid, so that there are about as many as triangles.
[[nodiscard]] inline std::uint32_t default_cells(std::uint64_t triangles) {
    const double side = std::ceil(std::sqrt(static_cast<double>(triangles)));
    return std::bit_ceil(static_cast<std::uint32_t>(std::clamp(side, 1.0, 2048.0)));
}

/// Cells of all grids of a bundle with so many on a side of the finest, a power of two.
[[nodiscard]] constexpr std::uint64_t bundle_cell_count(std::uint32_t cells) noexcept {
    return (4 * std::uint64_t{cells} * cells - 1) / 3;
}

/// A bundle along `axis` (of any length above 0) over a scene in `box`, with `cells` on a side of
/// the finest grid (a power of two, up to 2048: finer ones would lose triangles to rounding), and
/// samples that stand off by `lift` m.
[[nodiscard]] inline ray_bundle make_bundle(const bounds& box, glm::dvec3 axis, std::uint32_t cells,
                                            float lift) {
    const glm::dvec3 along = glm::normalize(axis);
    // Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
    const double sign = std::copysign(1.0, along.z);
    const double a = -1.0 / (sign + along.z);
    const double b = along.x * along.y * a;
    const glm::dvec3 right(1.0 + sign * along.x * along.x * a, sign * b, -sign * along.x);
    const glm::dvec3 up(b, sign + along.y * along.y * a, -along.y);
    const glm::dvec3 reach =
        box.empty() ? glm::dvec3(0) : 0.5 * (glm::dvec3(box.high) - glm::dvec3(box.low));
    const double half =
        1.0001 * std::max(glm::dot(glm::abs(right), reach), glm::dot(glm::abs(up), reach)) + lift;
    const double side = half > 0 ? half : 1;
    const glm::vec3 middle = box.empty() ? glm::vec3(0) : box.middle();
    ray_bundle made;
    made.centre = glm::vec4(middle, static_cast<float>(side));
    made.right = glm::vec4(glm::vec3(right), lift);
    made.up = glm::vec4(glm::vec3(up), static_cast<float>(cells / (2 * side)));
    made.direction = glm::vec4(glm::vec3(along), static_cast<float>(cells));
    return made;
}

} // namespace skybark::gather
