#pragma once
// read_particles: the particles of a cloud from a table.
//
// The columns, as io/number_table.hpp finds them:
//   x y z           m, +Y up
//   radius          m, at least a micrometre; the water ends there
//   optical_depth   along a straight line through the centre, 0…1e6
//   albedo          what is scattered of what is taken out, 0…1

#include <skybark/core/records.hpp>
#include <skybark/core/result.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace skybark::io {

/// Reads the particles of the file at `path`, in its order, line by line: the file may be larger
/// than memory, its particles may not. Errors: those of number_table; there is not enough memory.
[[nodiscard]] result<std::vector<cloud_particle>> read_particles(const std::string& path);

/// The same for a text in memory; `name` stands for the file in sentences.
[[nodiscard]] result<std::vector<cloud_particle>> parse_particles(std::string_view text,
                                                                  std::string_view name);

} // namespace skybark::io
