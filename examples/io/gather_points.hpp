#pragma once
// Points that ask for light, and the light that arrives there, as tables and as clouds of points.

#include <skybark/core/records.hpp>
#include <skybark/core/result.hpp>

#include <glm/vec4.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace skybark::io {

/// Reads the columns x, y, z (m, +Y up), nx, ny and nz of a table as io/number_table.hpp has it.
/// Normals are made unit. Errors: those of number_table; a normal of length 0; memory.
[[nodiscard]] result<std::vector<gather_sample>> read_gather_points(const std::string& path);

/// The same for a text in memory; `name` stands for the file in sentences.
[[nodiscard]] result<std::vector<gather_sample>> parse_gather_points(std::string_view text,
                                                                     std::string_view name);

/// Writes x,y,z,nx,ny,nz,r,g,b,error for each point, in as many digits as tell floats apart.
/// `light` has as many entries: irradiance and its standard error, W/m². Errors: the file can't be
/// written.
[[nodiscard]] result<void> write_gathered(const std::string& path,
                                          std::span<const gather_sample> points,
                                          std::span<const glm::vec4> light);

/// Writes binary little-endian PLY: x, y, z, nx, ny, nz, then r, g, b and error as floats, as
/// above, and red, green, blue for a display, where `white` becomes 255; then triangles of the
/// points, if there are any. Errors: the file can't be written.
[[nodiscard]] result<void> write_gathered_ply(const std::string& path,
                                              std::span<const gather_sample> points,
                                              std::span<const glm::vec4> light, float white,
                                              std::span<const glm::uvec3> triangles);

} // namespace skybark::io
