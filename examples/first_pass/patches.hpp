#pragma once
// The patches that a patch_table numbers, with their places: where first passes keep light.

#include <first_pass/lights.hpp>

#include <algorithm>
#include <glm/geometric.hpp>
#include <vector>

namespace skybark::first_pass {

/// A side of a part of a triangle.
struct patch {
    glm::vec3 corners[3]; ///< m; counter-clockwise where the triangle's front is
    glm::vec3 normal{0};  ///< unit, off this side; 0 where the triangle has no area
    float area = 0;       ///< m²
    std::uint32_t triangle = 0;
    std::uint32_t other = no_surface; ///< the patch of the same part on the other side, if any

    [[nodiscard]] glm::vec3 middle() const { return (corners[0] + corners[1] + corners[2]) / 3.0f; }
};

/// All triangles cut into `rows`² patches a side; backs only where the material has two sides.
[[nodiscard]] inline std::vector<patch_table> patch_tables(const surfaces& of, std::uint32_t rows) {
    std::vector<patch_table> tables(of.triangles.size());
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < tables.size(); ++i) {
        tables[i].rows = rows;
        tables[i].front = next;
        next += rows * rows;
        if (of.materials[of.triangles[i].material].two_sided != 0) {
            tables[i].back = next;
            next += rows * rows;
        }
    }
    return tables;
}

/// Each patch, by its number. Row j of a triangle counts from the edge ab; a row's patches lie with
/// a corner towards c and away from it, in turns.
[[nodiscard]] inline std::vector<patch> patches_of(const surfaces& of,
                                                   std::span<const patch_table> tables) {
    std::vector<patch> all;
    const auto put = [&](std::uint32_t number, const patch& made) {
        all.resize(std::max(all.size(), std::size_t{number} + 1));
        all[number] = made;
    };
    for (std::uint32_t t = 0; t < tables.size(); ++t) {
        const gather_triangle& triangle = of.triangles[t];
        const patch_table& table = tables[t];
        const auto n = static_cast<float>(table.rows);
        const glm::vec3 ab = (triangle.b - triangle.a) / n;
        const glm::vec3 ac = (triangle.c - triangle.a) / n;
        const glm::vec3 across = glm::cross(ab, ac);
        const float size = glm::length(across);
        std::uint32_t number = 0;
        const auto add = [&](float i, float j, bool upper) {
            const auto at = [&](float x, float y) { return triangle.a + x * ab + y * ac; };
            patch made{};
            made.corners[0] = upper ? at(i + 1, j) : at(i, j);
            made.corners[1] = upper ? at(i + 1, j + 1) : at(i + 1, j);
            made.corners[2] = at(i, j + 1);
            made.normal = size > 0 ? across / size : glm::vec3(0);
            made.area = 0.5f * size;
            made.triangle = t;
            made.other = table.back == no_surface ? no_surface : table.back + number;
            put(table.front + number, made);
            if (table.back != no_surface) {
                made.normal = -made.normal;
                made.other = table.front + number;
                put(table.back + number, made);
            }
            ++number;
        };
        for (std::uint32_t j = 0; j < table.rows; ++j) {
            for (std::uint32_t i = 0; i + j < table.rows; ++i) {
                add(static_cast<float>(i), static_cast<float>(j), false);
                if (i + j + 1 < table.rows) {
                    add(static_cast<float>(i), static_cast<float>(j), true);
                }
            }
        }
    }
    return all;
}

/// The middles of patches, to ask for light there.
[[nodiscard]] inline std::vector<gather_sample> middles_of(std::span<const patch> patches) {
    std::vector<gather_sample> samples(patches.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        samples[i].position = patches[i].middle();
        samples[i].normal = patches[i].normal;
    }
    return samples;
}

/// The radiance that leaves each patch, from its irradiance: what a gather takes.
[[nodiscard]] inline std::vector<glm::vec4>
leaving_radiance(const surfaces& of, std::span<const patch> patches,
                 std::span<const glm::vec4> irradiance) {
    std::vector<glm::vec4> out(patches.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
        const gather_material& m = of.materials[of.triangles[patches[i].triangle].material];
        const glm::vec3 behind =
            patches[i].other == no_surface ? glm::vec3(0) : glm::vec3(irradiance[patches[i].other]);
        out[i] = glm::vec4(m.emission +
                               (m.diffuse * glm::vec3(irradiance[i]) + m.transmission * behind) *
                                   0.318309886f,
                           0);
    }
    return out;
}

} // namespace skybark::first_pass
