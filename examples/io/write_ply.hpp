#pragma once
// write_ply: a mesh as a PLY file.

#include <skybark/core/records.hpp>
#include <skybark/core/result.hpp>

#include <span>
#include <string>

namespace skybark::io {

/// Writes binary little-endian PLY: x, y, z (m, +Y up), nx, ny, nz, s, t, and triangles.
/// Errors: the file can't be written.
[[nodiscard]] result<void> write_ply(const std::string& path,
                                     std::span<const surface_vertex> vertices,
                                     std::span<const std::uint32_t> indices);

} // namespace skybark::io
