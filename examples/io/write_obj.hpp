#pragma once
// write_obj: a mesh as a Wavefront OBJ file.

#include <skybark/core/records.hpp>
#include <skybark/core/result.hpp>

#include <span>
#include <string>

namespace skybark::io {

/// Writes positions (m, +Y up), texture coordinates, normals and triangles. Numbers are the
/// shortest that read back as the same floats. OBJ knows no tangents.
/// Errors: the file can't be written.
[[nodiscard]] result<void> write_obj(const std::string& path,
                                     std::span<const surface_vertex> vertices,
                                     std::span<const std::uint32_t> indices);

} // namespace skybark::io
