#pragma once
// read_tree: a tree from whatever describes one.

#include <skybark/trees/skeleton.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace skybark::io {

/// A tree with its foot at the origin (+Y up, m) from, by extension in upper or lower case,
/// - `.csv`, `.tsv`, `.txt`: cylinders, read_qsm.hpp;
/// - `.mtg`: a digitised plant, read_mtg.hpp, in metres;
/// - `.json`: our own description, read_skeleton_json.hpp (left where it stands);
/// or the name of a built-in species, grown with `seed`.
/// Errors are those of the readers; an unknown extension or name gives a sentence with all that is
/// accepted.
[[nodiscard]] result<std::vector<trees::segment>> read_tree(const std::string& path_or_species,
                                                            std::uint32_t seed);

} // namespace skybark::io
