#pragma once
// Triangles for scenes made by code: quads, grids, spheres and boxes, in metres, +Y up. Fronts look
// out of what is solid.

#include <skybark/core/records.hpp>

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <string>
#include <vector>

namespace skybark::scenes {

/// A scene to gather light in.
struct surface_list {
    std::string name;
    std::vector<gather_triangle> triangles;
    std::vector<gather_material> materials;
};

[[nodiscard]] inline std::uint32_t add_material(surface_list& scene,
                                                const gather_material& material) {
    scene.materials.push_back(material);
    return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

/// One that only reflects.
[[nodiscard]] inline std::uint32_t add_paint(surface_list& scene, glm::vec3 diffuse) {
    gather_material paint;
    paint.diffuse = diffuse;
    return add_material(scene, paint);
}

inline void add_triangle(surface_list& scene, std::uint32_t material, glm::vec3 a, glm::vec3 b,
                         glm::vec3 c) {
    gather_triangle t;
    t.a = a;
    t.material = material;
    t.b = b;
    t.c = c;
    scene.triangles.push_back(t);
}

/// Two triangles; the front is where a, b, c, d go round counter-clockwise.
inline void add_quad(surface_list& scene, std::uint32_t material, glm::vec3 a, glm::vec3 b,
                     glm::vec3 c, glm::vec3 d) {
    add_triangle(scene, material, a, b, c);
    add_triangle(scene, material, a, c, d);
}

/// n² quads of a level square, its front up.
inline void add_ground(surface_list& scene, std::uint32_t material, float half_width, int n) {
    const auto place = [&](int column, int row) {
        const float step = 2 * half_width / static_cast<float>(n);
        return glm::vec3(static_cast<float>(column) * step - half_width, 0,
                         static_cast<float>(row) * step - half_width);
    };
    for (int row = 0; row < n; ++row) {
        for (int column = 0; column < n; ++column) {
            add_quad(scene, material, place(column, row), place(column, row + 1),
                     place(column + 1, row + 1), place(column + 1, row));
        }
    }
}

/// 2 · slices · (stacks − 1) triangles between circles of latitude.
inline void add_sphere(surface_list& scene, std::uint32_t material, glm::vec3 centre, float radius,
                       int slices, int stacks) {
    const auto place = [&](int slice, int stack) {
        constexpr double pi = 3.14159265358979323846;
        const double down = pi * stack / stacks;
        // The last slice ends where the first begins, to the bit, and the poles are points.
        const double round = 2 * pi * (slice % slices) / slices;
        const double across = stack == 0 || stack == stacks ? 0 : std::sin(down);
        return centre + radius * glm::vec3(across * std::sin(round), std::cos(down),
                                           across * std::cos(round));
    };
    for (int stack = 0; stack < stacks; ++stack) {
        for (int slice = 0; slice < slices; ++slice) {
            const glm::vec3 a = place(slice, stack);
            const glm::vec3 b = place(slice, stack + 1);
            const glm::vec3 c = place(slice + 1, stack + 1);
            const glm::vec3 d = place(slice + 1, stack);
            if (stack + 1 < stacks) {
                add_triangle(scene, material, a, b, c);
            }
            if (stack > 0) {
                add_triangle(scene, material, a, c, d);
            }
        }
    }
}

/// 12 triangles; `turn` about +Y, rad, from +Z towards +X.
inline void add_box(surface_list& scene, std::uint32_t material, glm::vec3 centre,
                    glm::vec3 half_size, float turn) {
    const auto corner = [&](float x, float y, float z) {
        const glm::vec3 p = half_size * glm::vec3(x, y, z);
        return centre + glm::vec3(std::cos(turn) * p.x + std::sin(turn) * p.z, p.y,
                                  std::cos(turn) * p.z - std::sin(turn) * p.x);
    };
    const auto side = [&](glm::vec3 out, glm::vec3 right) {
        const glm::vec3 up = glm::cross(out, right);
        const auto at = [&](float r, float u) {
            const glm::vec3 p = out + r * right + u * up;
            return corner(p.x, p.y, p.z);
        };
        add_quad(scene, material, at(-1, -1), at(1, -1), at(1, 1), at(-1, 1));
    };
    side({0, 0, 1}, {1, 0, 0});
    side({0, 0, -1}, {-1, 0, 0});
    side({1, 0, 0}, {0, 0, -1});
    side({-1, 0, 0}, {0, 0, 1});
    side({0, 1, 0}, {1, 0, 0});
    side({0, -1, 0}, {1, 0, 0});
}

} // namespace skybark::scenes
