#pragma once
// canopy: crowns of loose leaves above open ground. Leaves have two sides and let light through.

#include <scenes/random.hpp>
#include <scenes/surface_list.hpp>

namespace skybark::scenes {

/// A leaf of 10 cm by 6 cm that points anywhere.
inline void add_leaf(surface_list& scene, std::uint32_t material, glm::vec3 middle,
                     random_numbers& random) {
    const glm::vec3 along = random.direction();
    glm::vec3 across;
    do {
        across = glm::cross(along, random.in_ball());
    } while (glm::dot(across, across) < 0.01f);
    const glm::vec3 l = 0.05f * along;
    const glm::vec3 w = 0.03f * glm::normalize(across);
    add_quad(scene, material, middle - l - w, middle + l - w, middle + l + w, middle - l + w);
}

/// 199,200 triangles: 20 m of ground, then 24 crowns of 4,000 leaves. The ground is the first 7,200
/// of them.
[[nodiscard]] inline surface_list canopy() {
    surface_list scene;
    scene.name = "canopy";
    random_numbers random(7);
    const std::uint32_t soil = add_paint(scene, {0.40f, 0.33f, 0.25f});
    gather_material green;
    green.diffuse = {0.12f, 0.26f, 0.06f};
    green.transmission = {0.10f, 0.28f, 0.04f};
    green.two_sided = 1;
    const std::uint32_t leaf = add_material(scene, green);

    add_ground(scene, soil, 10, 60);
    for (int crown = 0; crown < 24; ++crown) {
        const float x = random.between(-8, 8);
        const float z = random.between(-8, 8);
        const float y = random.between(3, 5);
        const float radius = random.between(1.2f, 2.5f);
        for (int i = 0; i < 4000; ++i) {
            add_leaf(scene, leaf, glm::vec3(x, y, z) + radius * random.in_ball(), random);
        }
    }
    return scene;
}

} // namespace skybark::scenes
