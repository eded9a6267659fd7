#pragma once
// settle: moves a tree to where it stands on the origin.

#include <skybark/trees/skeleton.hpp>

#include <vector>

namespace skybark::io {

/// Moves all segments alike, so that the base of the first root comes to the origin; where several
/// trees stand, they keep their distances. Nothing happens without a root.
void settle(std::vector<trees::segment>& segments);

} // namespace skybark::io
