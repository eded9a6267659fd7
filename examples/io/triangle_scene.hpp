#pragma once
// triangle_scene: triangles and what they do with light, as a file has them.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace skybark::io {

inline constexpr std::uint32_t no_alpha_map = 0xffffffffu;

/// Where a surface is: floats 0…1, row after row, row 0 at the texture coordinate v = 0.
struct alpha_map {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<float> values;
};

/// Diffuse on both sides, or black on the back.
struct scene_material {
    std::string name;
    glm::vec3 diffuse{0.5f};   ///< reflected of what arrives, 0…1
    glm::vec3 emission{0};     ///< radiance, W/(m² sr)
    glm::vec3 transmission{0}; ///< leaves on the other side; diffuse + transmission ≤ 1
    bool two_sided = false;
    std::uint32_t alpha_map = no_alpha_map; ///< index into the maps
    float cutoff = 0.5f;                    ///< what is below it there is a hole
};

/// Vertices are shared by triangles where all of their attributes are the same.
struct triangle_scene {
    std::vector<glm::vec3> positions;       ///< m, +Y up
    std::vector<glm::vec3> normals;         ///< unit, as many; 0 where the file has none
    std::vector<glm::vec2> coordinates;     ///< texture coordinates, as many; 0 where none
    std::vector<glm::uvec3> triangles;      ///< three positions, counter-clockwise from the front
    std::vector<std::uint32_t> material_of; ///< of each triangle
    std::vector<scene_material> materials;  ///< at least one
    std::vector<alpha_map> maps;
};

} // namespace skybark::io
