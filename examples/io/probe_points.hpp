#pragma once
// Places where a cloud's light is asked for, and what it is there, as tables.

#include <skybark/core/result.hpp>

#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace skybark::io {

/// Reads the columns x, y and z (m, +Y up) of a table as io/number_table.hpp has it.
/// Errors: those of number_table; there is not enough memory.
[[nodiscard]] result<std::vector<glm::vec3>> read_points(const std::string& path);

/// The same for a text in memory; `name` stands for the file in sentences.
[[nodiscard]] result<std::vector<glm::vec3>> parse_points(std::string_view text,
                                                          std::string_view name);

/// What lies between a place and the sun, and what comes through.
struct probed_light {
    float optical_depth = 0; ///< extinction alone
    float light = 1;         ///< over that of the sun
};

/// Writes x,y,z,optical_depth,light for each point, in as many digits as tell floats apart.
/// `light` has as many entries as `points`. Errors: the file can't be written.
[[nodiscard]] result<void> write_probes(const std::string& path, std::span<const glm::vec3> points,
                                        std::span<const probed_light> light);

} // namespace skybark::io
