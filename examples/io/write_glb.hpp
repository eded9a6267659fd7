#pragma once
// write_glb: meshes, what they look like and how they move, as a binary glTF 2.0 file.

#include <io/joint_motion.hpp>
#include <io/surface_scene.hpp>

#include <skybark/core/result.hpp>

#include <string>

namespace skybark::io {

/// What goes into the file.
struct glb_scene {
    std::span<const surface_mesh> meshes;
    std::span<const surface_material> materials;
    /// Joint i is what the carrier i of a vertex means. Empty: nothing can move.
    std::span<const joint> joints;
    /// Frame after frame, one pose a joint each; empty: joints at rest, no animation.
    std::span<const segment_pose> poses;
    double frames_per_second = 24; ///< frame k is shown at k / frames_per_second
};

/// The most joints that a vertex can name.
inline constexpr std::size_t most_glb_joints = 65535;

/// Writes a node for each mesh: positions, unit normals, unit tangents, texture coordinates, 32-bit
/// indices. glTF's texture coordinates count from the top of an image, so v becomes 1 − v. A
/// tangent of length 0 becomes one of those that the normal allows, one that leans out of the
/// surface is laid into it, and a w of 0 becomes 1.
/// Meshes with carriers hang on one skin, whose joints are nodes under their parents; the poses
/// become an animation of their rotations, and of translations where a base leaves its parent. Keys
/// are joined by straight lines (LINEAR). Textures are PNG inside the file. Meshes without
/// triangles are left out. Errors: no triangles at all; a material, an index or a carrier that
/// isn't there; a place or pose that isn't finite; more than `most_glb_joints`; beyond the 4 GiB
/// that the format can say; the file can't be written; not enough memory.
[[nodiscard]] result<void> write_glb(const std::string& path, const glb_scene& scene);

/// One mesh of one material.
[[nodiscard]] result<void> write_glb(const std::string& path,
                                     std::span<const surface_vertex> vertices,
                                     std::span<const std::uint32_t> indices,
                                     const surface_material& material = {});

} // namespace skybark::io
