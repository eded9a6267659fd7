// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 7fd4ecbafb346092274100d8e5c66d3dc8198a7a9bb4229dbd5ba5006114abf0
#pragma once

#include <skybark/shared/glsl.hpp>
#include <skybark/shared/sway.hpp>

namespace skybark::shared {

// What the energies of a whole tree say of its rates. Apart from sway.glsl, because that has no
// choices and can be computed for several segments in the lanes of one vector.

// What follows for the whole tree. The scale undoes what the change of pose did to the kinetic
// energy. Where rounding has made more energy than the loads' work allows, it takes that away too.
// Below 1e-30 J there is no motion to speak of, and its squares leave the range of floats.
inline sway_energy sway_settled(sway_energy tree, float budget) {
    tree.budget = budget < 0.0f ? tree.before + tree.elastic : budget + tree.work;
    float left = min(tree.before, max(tree.budget - tree.elastic, 0.0f));
    bool moves = tree.before > 1e-30f && tree.after > 1e-30f;
    tree.scale = moves ? sqrt(left / tree.after) : 1.0f;
    return tree;
}

} // namespace skybark::shared
