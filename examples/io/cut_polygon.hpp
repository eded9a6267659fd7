#pragma once
// cut_polygon: a polygon as triangles.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

namespace skybark::io {

/// Polygons that are convex may have any number of corners, others this many at most: their
/// cutting takes the square of it, or more.
inline constexpr std::size_t most_concave_corners = 1000;

/// Cuts a polygon of at least three corners into corners − 2 triangles that go round as it does;
/// each names three of its corners. Convex ones become fans, others lose ear after ear (Meisters
/// 1975) in the plane that they lie in best (Newell's normal). A polygon that crosses itself or has
/// no area is cut somehow. Nothing: it is concave and has too many corners.
[[nodiscard]] std::optional<std::vector<std::array<std::uint32_t, 3>>>
cut_polygon(std::span<const glm::vec3> corners);

} // namespace skybark::io
