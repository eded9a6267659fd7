#pragma once
// cornell: a box that is open at the front (+Z), two boxes in it, a light under the ceiling; after
// Goral et al. 1984.

#include <scenes/surface_list.hpp>

namespace skybark::scenes {

/// 36 triangles, 5.5 m a side; the floor's middle is the origin. Red on the left (−X), green on the
/// right. The boxes stand a centimetre deep in the floor: of faces at one place, rounding would
/// choose.
[[nodiscard]] inline surface_list cornell() {
    surface_list scene;
    scene.name = "cornell";
    const std::uint32_t white = add_paint(scene, {0.73f, 0.73f, 0.73f});
    const std::uint32_t red = add_paint(scene, {0.63f, 0.065f, 0.05f});
    const std::uint32_t green = add_paint(scene, {0.14f, 0.45f, 0.091f});
    gather_material lamp;
    lamp.diffuse = glm::vec3(0.78f);
    lamp.emission = {17, 12, 4};
    const std::uint32_t light = add_material(scene, lamp);

    const float h = 2.75f;
    const float top = 2 * h;
    add_quad(scene, white, {-h, 0, h}, {h, 0, h}, {h, 0, -h}, {-h, 0, -h});         // floor
    add_quad(scene, white, {-h, top, -h}, {h, top, -h}, {h, top, h}, {-h, top, h}); // ceiling
    add_quad(scene, white, {-h, 0, -h}, {h, 0, -h}, {h, top, -h}, {-h, top, -h});   // back
    add_quad(scene, red, {-h, 0, h}, {-h, 0, -h}, {-h, top, -h}, {-h, top, h});     // left
    add_quad(scene, green, {h, 0, -h}, {h, 0, h}, {h, top, h}, {h, top, -h});       // right
    add_box(scene, white, {-0.9f, 1.64f, -0.75f}, {0.82f, 1.65f, 0.82f}, 0.3f);     // tall
    add_box(scene, white, {0.95f, 0.815f, 1.05f}, {0.82f, 0.825f, 0.82f}, -0.29f);  // short
    const float under = top - 0.01f;
    add_quad(scene, light, {-0.65f, under, -0.52f}, {0.65f, under, -0.52f}, {0.65f, under, 0.53f},
             {-0.65f, under, 0.53f});
    return scene;
}

} // namespace skybark::scenes
