#pragma once
// write_glb: a mesh as a binary glTF 2.0 file.

#include <skybark/core/records.hpp>
#include <skybark/core/result.hpp>

#include <glm/vec4.hpp>
#include <span>
#include <string>

namespace skybark::io {

/// How the surface looks, in glTF's metallic-roughness terms.
struct glb_material {
    std::string name = "bark";
    glm::vec4 base_color{0.32f, 0.24f, 0.17f, 1}; ///< linear
    float roughness = 0.9f;
};

/// Writes one node with one mesh: positions, normals, tangents, texture coordinates, 32-bit indices
/// and a material. glTF's texture coordinates count from the top of an image, so v becomes 1 − v.
/// Errors: beyond the 4 GiB that the format can say, the file can't be written, not enough memory.
[[nodiscard]] result<void> write_glb(const std::string& path,
                                     std::span<const surface_vertex> vertices,
                                     std::span<const std::uint32_t> indices,
                                     const glb_material& material = {});

} // namespace skybark::io
