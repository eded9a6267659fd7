#pragma once
// read_skeleton_json: our own description of a tree, as segments or as a species.
//
//   {"skybark_tree": 1,
//    "segments": [{"base": [x, y, z], "tip": [x, y, z],  m, +Y up
//                  "base_radius": r,                     m; may be left out: as "radius"
//                  "radius": r,                          m, at the tip
//                  "parent": i},                         index into "segments", or null at a root
//                 …]}
//
//   {"skybark_tree": 1,
//    "species": "quaking_aspen",
//    "seed": 1,                                          may be left out
//    "parameters": {"scale": 20, "level": [{"curve": 10}, {"branches": 30}]}}   may be left out
//
// Members in any order; the parameters' names are those of weber_penn_parameters and
// weber_penn_level, each set on top of the species' own. A "comment" with a string may stand in
// the outermost object. Any other member is an error, since it is most likely a slip of the pen.

#include <skybark/trees/weber_penn.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace skybark::io {

/// Reads the tree of the file at `path`, segments in its order. `seed` is used for a species where
/// the file has none.
/// Errors (`bad_input`) name the file, the line, the value and what was expected.
[[nodiscard]] result<std::vector<trees::segment>> read_skeleton_json(const std::string& path,
                                                                     std::uint32_t seed = 1);

/// The same for a text in memory; `name` stands for the file in sentences. A species may grow
/// `most_grown` segments at most.
[[nodiscard]] result<std::vector<trees::segment>>
parse_skeleton_json(std::string_view text, std::string_view name, std::uint32_t seed = 1,
                    std::size_t most_grown = trees::default_most_segments);

} // namespace skybark::io
