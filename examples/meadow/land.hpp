#pragma once
// The ground that everything of the meadow stands on: a gentle floor where the stand is, hills of
// some 60 to 150 m around it out to the horizon. Metres, +Y up.
//
// In closed form, so that anything may ask for the height of a place: sums of sines, the hills
// faded in with the distance. Smooth, and within ±2 m inside the stand.

#include <skybark/core/records.hpp>

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace skybark::meadow {

/// Triangles of surface_vertex, counter-clockwise from above.
struct land_mesh {
    std::vector<surface_vertex> vertices;
    std::vector<std::uint32_t> indices; ///< three a triangle
};

class land {
  public:
    static constexpr float side = 160;           ///< m, of the stand's square around the origin
    static constexpr std::uint32_t points = 161; ///< inner vertices on a side of it
    static constexpr std::uint32_t rings = 48;   ///< of vertices around it, outwards
    static constexpr float horizon = 8000;       ///< m, from the origin to the last ring's sides
    static constexpr std::uint32_t light_cells = 32; ///< on a side of the square, for light

    /// What meadow grass looks like from afar, mixed as it stands: its albedo.
    static constexpr glm::vec3 albedo{0.102f, 0.131f, 0.027f};

    explicit land(std::uint64_t seed);

    [[nodiscard]] float height(float x, float z) const;
    [[nodiscard]] glm::vec3 normal(float x, float z) const; ///< unit
    [[nodiscard]] glm::vec3 on(float x, float z) const { return {x, height(x, z), z}; }

    /// The land to draw: first the inner grid, points² vertices, row after row from north (−Z) to
    /// south, each from west (−X) to east; then the rings, each with as many vertices as the
    /// grid's border. u is the number of the inner vertex whose light a vertex shows: its own, or
    /// that of the border's vertex from which it lies outwards. v is 0; tangents lie along +X.
    [[nodiscard]] land_mesh mesh() const;

    /// Appends the inner land as light meets it: 2 · light_cells² triangles of this material.
    void add_light_triangles(std::vector<gather_triangle>& to, std::uint32_t material) const;
    /// The height of these triangles at a place inside the square.
    [[nodiscard]] float light_height(float x, float z) const;

  private:
    struct swell {
        double x = 0; ///< wave vector, rad/m
        double z = 0;
        double phase = 0;
        double height = 0; ///< m
    };
    /// A height and its slopes.
    struct point {
        double height = 0;
        double dx = 0;
        double dz = 0;
    };
    [[nodiscard]] point at(double x, double z) const;

    std::array<swell, 7> floor_;
    std::array<swell, 8> hills_;
};

} // namespace skybark::meadow
