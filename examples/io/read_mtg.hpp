#pragma once
// read_mtg: digitised plants as multiscale tree graphs, the format of OpenAlea and AMAPmod.
//
// Source: OpenAlea MTG user guide, "File syntax". What is read of it:
//
// - Tables separated by tabs. A # makes the rest of its cell a comment. Sections in this order,
//   each begun by its keyword and a colon: CODE (FORM-A), CLASSES (SYMBOL, SCALE, …), DESCRIPTION
//   (skipped), FEATURES (NAME, TYPE), MTG.
// - The MTG section begins with a line that has ENTITY-CODE or TOPO in its first cell and, some
//   cells on, the names of features; the cells before those hold the topological code, one a line.
// - A code is a run of relations and labels: / (decomposed into), < (followed by), + (bears), and
//   the shorthands E1<<E5, E1++E5, E1<.<E5, E1+.+E5; a label is the symbol of a class and an index.
//   With ^ in front it goes on from the last code of its column, else from the last code of the
//   column before; in the first column it begins a plant.
// - Features: XX, YY, ZZ (or X, Y, Z): the *end* of an entity, z up. TopDia (TopDiameter, Diameter,
//   diameter, diam) or Radius (TopRadius, R, radius): the thickness there. BotDia (BottomDiameter,
//   BotDiameter) at its beginning. All others are skipped.
//
// What it becomes. The entities of the finest declared scale that have coordinates become segments,
// each from the end of the one before (or from the coordinates of the coarser entity that it
// begins, as digitisers note where an axis starts) to its own end. Those without coordinates are
// passed over: what they bear hangs from the nearest segment before. A thickness that isn't given
// is that of the segment before.
//
// Units. The format has none; `mtg_units` says what one is (AMAPmod files are often in cm or mm
// with diameters in mm or 0.1 mm).
//
// Not read, and an error that names the line: FORM-B, aliases in parentheses, dated repetitions
// (*), absolute codes that name a plant again, more than one code on a line.

#include <skybark/trees/skeleton.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace skybark::io {

/// What a number in the file is in metres.
struct mtg_units {
    double coordinate = 1;
    double diameter = 1; ///< of radii, too
};

/// Reads the plants of the file at `path` as +Y up ((x, y, z) → (x, z, −y)), m; parents before
/// children. Errors (`bad_input`) name the file, the line, the value and what was expected.
[[nodiscard]] result<std::vector<trees::segment>> read_mtg(const std::string& path,
                                                           mtg_units units = {});

/// The same for a text in memory; `name` stands for the file in sentences.
[[nodiscard]] result<std::vector<trees::segment>>
parse_mtg(std::string_view text, std::string_view name, mtg_units units = {});

} // namespace skybark::io
