#pragma once
// read_qsm: quantitative structure models, trees fitted with cylinders to a laser scan.
//
// A table with a header line: the columns of SimpleForest, found by name, in any order among any
// others:
//   startX startY startZ endX endY endZ   m, z up
//   radius                                m
//   ID                                    any whole number, each only once, in any order
//   parentID                              the ID of the parent, -1 at a root; 0 is a root as well
//                                         where no cylinder has the ID 0 (TreeQSM counts from 1)
// Separated by commas, semicolons or tabs, whichever the header has most of; spaces around fields
// are left out, fields may stand in double quotes, lines end in LF or CRLF, a byte order mark and
// empty lines are skipped.

#include <skybark/trees/skeleton.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace skybark::io {

/// Where a tree is put when it is read.
enum class placement {
    as_given, ///< coordinates as in the file, turned to +Y up
    settled,  ///< the base of the first root at the origin; keeps millimetres where a scan's
              ///< coordinates count from a far-off origin, which floats couldn't
};

/// Reads the cylinders of the file at `path`, in its order: +Y up ((x, y, z) → (x, z, −y)), m. A
/// cylinder's radius is that of both ends.
/// Errors (`bad_input`) name the file, the line, the value and what was expected: not a table, no
/// such column, too few fields, not a number, a negative radius, an ID twice, a parent that isn't
/// there, a cycle of parents, over 4 GiB.
[[nodiscard]] result<std::vector<trees::segment>> read_qsm(const std::string& path,
                                                           placement where = placement::as_given);

/// The same for a text in memory; `name` stands for the file in sentences.
[[nodiscard]] result<std::vector<trees::segment>>
parse_qsm(std::string_view text, std::string_view name, placement where = placement::as_given);

} // namespace skybark::io
