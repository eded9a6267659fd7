#pragma once
// park: balls and boxes on open ground, for the sky to light.

#include <scenes/random.hpp>
#include <scenes/surface_list.hpp>

namespace skybark::scenes {

inline constexpr int park_ground_quads = 120; ///< on a side
inline constexpr std::uint32_t park_ground_triangles = 2 * park_ground_quads * park_ground_quads;

/// 202,560 triangles: 20 m of ground, 60 spheres on and above it, 40 boxes a centimetre deep in it
/// (of faces at one place, rounding would choose). The ground is the first park_ground_triangles of
/// them.
[[nodiscard]] inline surface_list park() {
    surface_list scene;
    scene.name = "park";
    random_numbers random(7);
    const std::uint32_t grass = add_paint(scene, {0.36f, 0.44f, 0.21f});
    const std::uint32_t colours[] = {
        add_paint(scene, {0.75f, 0.16f, 0.11f}), add_paint(scene, {0.80f, 0.52f, 0.10f}),
        add_paint(scene, {0.82f, 0.76f, 0.30f}), add_paint(scene, {0.14f, 0.42f, 0.70f}),
        add_paint(scene, {0.48f, 0.22f, 0.58f}), add_paint(scene, {0.78f, 0.78f, 0.76f})};
    const std::uint32_t stone = add_paint(scene, {0.55f, 0.50f, 0.44f});

    add_ground(scene, grass, 10, park_ground_quads);
    for (std::uint32_t i = 0; i < 60; ++i) {
        const float radius = random.between(0.2f, 1);
        const float x = random.between(-9, 9);
        const float z = random.between(-9, 9);
        const float y = 0.9f * radius + random.between(0, 2);
        add_sphere(scene, colours[i % 6], {x, y, z}, radius, 38, 39);
    }
    for (std::uint32_t i = 0; i < 40; ++i) {
        const float x = random.between(-9, 9);
        const float z = random.between(-9, 9);
        const float width = random.between(0.2f, 0.8f);
        const float depth = random.between(0.2f, 0.8f);
        const float turn = random.between(0, 6.2831853f);
        add_box(scene, stone, {x, 0.59f, z}, {width, 0.6f, depth}, turn);
    }
    return scene;
}

} // namespace skybark::scenes
