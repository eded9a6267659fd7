#pragma once
// read_scene: triangles with diffuse colours and emission from .obj + .mtl, or .glb.

#include <io/triangle_scene.hpp>

#include <skybark/core/result.hpp>

#include <string>

namespace skybark::io {

/// Reads a scene by its file's extension: .obj or .glb. Errors: another extension, and those below.
[[nodiscard]] result<triangle_scene> read_scene(const std::string& path);

/// Wavefront OBJ: v, vt, vn, f (polygons are cut into triangles; indices may be negative), usemtl,
/// mtllib; a line may go on after "\". Other statements of the format are skipped. Faces before the
/// first usemtl are grey (0.5).
///
/// Of a .mtl: Kd, Ke (radiance), d or Tr, Tf, illum, map_Kd, map_Ke, map_d. The mean of a picture
/// multiplies its colour. What isn't opaque, 1 − d, passes the surface: diffuse = d · Kd,
/// transmission = (1 − d) · Tf. Where d is 1, Tf counts only if illum says that the material is
/// transparent (4, 6, 7 or 9), as exporters write "Tf 1 1 1" for walls. There is a hole where map_d
/// (its alpha, if it has one; else how bright it is) is below ½. Materials with holes or
/// transmission are two-sided, others are black on the back.
///
/// Errors name the file, the line and the value: a number that is none, isn't finite or is beyond
/// 1e9 m; an index of a vertex that isn't there; a face of fewer than three corners; a statement
/// that the format hasn't; a material that no .mtl has; a .mtl or picture that isn't there; colours
/// outside 0…1, or that together give back more than arrives; no triangles; memory.
[[nodiscard]] result<triangle_scene> read_obj_scene(const std::string& path);

/// Binary glTF 2.0: the triangles of the meshes in the default scene, under their nodes'
/// transforms. Skins and animations are left at rest. baseColorFactor times the mean of its texture
/// is the diffuse colour, of metals too; emissiveFactor (times its texture's mean, times
/// KHR_materials_emissive_strength) is radiance. alphaMode MASK and BLEND make holes where alpha is
/// below the cutoff (½ for BLEND). KHR_materials_diffuse_transmission and
/// KHR_materials_transmission pass on their factor's part of the light; such materials, and
/// doubleSided ones, are two-sided.
///
/// Errors name the file and the value: no glTF; what an accessor, a view, a node or an index points
/// at isn't there; numbers as above; an extension that is required and not known; nodes in a
/// circle; no triangles; memory.
[[nodiscard]] result<triangle_scene> read_glb_scene(const std::string& path);

} // namespace skybark::io
