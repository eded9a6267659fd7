#pragma once
// read_mtl: the materials that a .obj names.

#include <io/triangle_scene.hpp>

#include <skybark/core/result.hpp>

#include <string>
#include <vector>

namespace skybark::io {

/// Appends the materials of a .mtl, and the maps of their holes, as read_obj_scene's comment has
/// them. Errors: as there.
[[nodiscard]] result<void> read_mtl(const std::string& path, std::vector<scene_material>& materials,
                                    std::vector<alpha_map>& maps);

} // namespace skybark::io
