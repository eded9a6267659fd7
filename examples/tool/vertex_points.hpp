#pragma once
// vertex_points: the vertices of a scene, as points that ask for light.

#include <skybark/core/records.hpp>

#include <span>
#include <vector>

namespace skybark::tool {

/// Vertices, and the triangles between them.
struct vertex_points {
    std::vector<gather_sample> samples;
    std::vector<glm::vec3> places;     ///< of the vertices
    std::vector<glm::uvec3> triangles; ///< those of the scene, without those that have no normal
};

/// A point for each place and normal: where faces with different normals meet, each has its own.
/// `normals` are three a triangle, as a file has them. Where it has none (0), those of faces that
/// meet there and differ by less than 30° are smoothed, weighted by area.
///
/// A vertex in the corner of a room lies in its walls: half of what it should see is behind them.
/// So samples stand inwards, towards the middle of their triangles, by 1e-4 of the way and by twice
/// `lift` at least, but never beyond a third of the way.
[[nodiscard]] vertex_points find_vertices(std::span<const gather_triangle> triangles,
                                          std::span<const glm::vec3> normals, float lift);

} // namespace skybark::tool
