#pragma once
// write_obj: meshes as a Wavefront OBJ file, with their materials and textures beside it.

#include <io/surface_scene.hpp>

#include <skybark/core/result.hpp>

#include <string>

namespace skybark::io {

/// Writes positions (m, +Y up), texture coordinates, normals and triangles, a group each mesh.
/// Numbers are the shortest that read back as the same floats. OBJ knows no tangents and no
/// carriers. Vertices of one place (`surface_mesh::places`) share their position, so that a reader
/// finds a closed surface closed.
///
/// NAME.obj names NAME.mtl where there are materials, which names NAME_MATERIAL.png and
/// NAME_MATERIAL_normal.png where they have textures. All of them appear, the .obj last, or none.
/// Errors: an index, place or material that isn't there; two materials of one name; a file can't be
/// written.
[[nodiscard]] result<void> write_obj(const std::string& path, std::span<const surface_mesh> meshes,
                                     std::span<const surface_material> materials);

/// One mesh, without material.
[[nodiscard]] result<void> write_obj(const std::string& path,
                                     std::span<const surface_vertex> vertices,
                                     std::span<const std::uint32_t> indices);

} // namespace skybark::io
