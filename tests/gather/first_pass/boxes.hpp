#pragma once
// Closed rooms that first passes are held to.

#include <first_pass/patches.hpp>
#include <scenes/surface_list.hpp>

namespace skybark::support {

[[nodiscard]] inline first_pass::surfaces surfaces_of(const scenes::surface_list& scene) {
    return {scene.triangles, scene.materials, {}};
}

/// The inside of a cube of side 1: every wall emits `emission` and reflects `reflectance`.
[[nodiscard]] inline scenes::surface_list glowing_room(float emission, float reflectance) {
    scenes::surface_list room;
    gather_material wall;
    wall.diffuse = glm::vec3(reflectance);
    wall.emission = glm::vec3(emission);
    scenes::add_box(room, scenes::add_material(room, wall), glm::vec3(0.5f), glm::vec3(0.5f), 0);
    for (gather_triangle& t : room.triangles) {
        std::swap(t.b, t.c); // fronts look in
    }
    return room;
}

/// Two squares of side 1 that face each other at a distance of 1: the first glows, the second is
/// black. Both are two triangles.
[[nodiscard]] inline scenes::surface_list facing_squares() {
    scenes::surface_list scene;
    gather_material light;
    light.diffuse = glm::vec3(0);
    light.emission = glm::vec3(1, 2, 3);
    const std::uint32_t glowing = scenes::add_material(scene, light);
    const std::uint32_t black = scenes::add_paint(scene, glm::vec3(0));
    scenes::add_quad(scene, glowing, {0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1});
    scenes::add_quad(scene, black, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}, {0, 0, 0});
    return scene;
}

/// A room with a lamp of its own under the ceiling, a red wall, and a box in the middle: closed.
[[nodiscard]] inline scenes::surface_list lit_room() {
    scenes::surface_list room = glowing_room(0, 0.6f);
    const std::uint32_t red = scenes::add_paint(room, {0.7f, 0.1f, 0.1f});
    for (gather_triangle& t : room.triangles) {
        if (t.a.x + t.b.x + t.c.x == 0) {
            t.material = red;
        }
    }
    gather_material lamp;
    lamp.diffuse = glm::vec3(0.5f);
    lamp.emission = {10, 9, 8};
    const std::uint32_t light = scenes::add_material(room, lamp);
    scenes::add_quad(room, light, {0.3f, 0.95f, 0.3f}, {0.7f, 0.95f, 0.3f}, {0.7f, 0.95f, 0.7f},
                     {0.3f, 0.95f, 0.7f});
    scenes::add_box(room, scenes::add_paint(room, glm::vec3(0.5f)), {0.4f, 0.2f, 0.6f},
                    {0.15f, 0.199f, 0.15f}, 0.4f);
    return room;
}

} // namespace skybark::support
