#pragma once
// skeleton_layout: the segments of a tree alone, as thin straight sticks.
// Source: Akagi and Kitajima, figure 8, where the skeleton is drawn beside the mesh.

#include <skybark/trees/branch_layout.hpp>

namespace skybark::tool {

/// Every segment gets two ends of its own, turned along its chord, so that no curve bends it and
/// no joint is shared. `radius` (m) is that of all sticks, but for twigs that are thinner.
[[nodiscard]] inline trees::branch_layout skeleton_layout(const trees::skeleton& from,
                                                          float radius) {
    trees::branch_layout layout;
    layout.ends.reserve(2 * from.size());
    layout.segments.reserve(from.size());
    for (std::uint32_t i = 0; i < from.size(); ++i) {
        const glm::quat& turn = from.orientation[i];
        branch_end end;
        end.position = from.position[i];
        end.radius = std::min(radius, from.base_radius[i]);
        end.orientation = {turn.x, turn.y, turn.z, turn.w};
        layout.ends.push_back(end);
        end.position = from.tip(i);
        end.path = from.length[i];
        layout.ends.push_back(end);
        layout.segments.push_back({2 * i, 2 * i + 1, cap_start | cap_end, 0});
        layout.carriers.insert(layout.carriers.end(), 2, end_carrier{i, i, i, 0});
    }
    return layout;
}

} // namespace skybark::tool
