#pragma once
// solid_bodies: which places lie inside of what is solid, where they would see no light, and where
// the nearest ones outside are.

#include <skybark/core/records.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace skybark::meadow {

/// Bodies are what triangles of one side enclose, tubes with open ends included; they may overlap.
class solid_bodies {
  public:
    solid_bodies(std::span<const gather_triangle> triangles,
                 std::span<const gather_material> materials) {
        for (const gather_triangle& t : triangles) {
            if (materials[t.material].two_sided == 0) {
                walls_.push_back(t);
            }
        }
        std::sort(walls_.begin(), walls_.end(),
                  [](const auto& a, const auto& b) { return lowest(a) < lowest(b); });
        for (const gather_triangle& t : walls_) {
            widest_ = std::max(widest_, std::max({t.a.z, t.b.z, t.c.z}) - lowest(t));
        }
    }

    /// The place itself, or, inside a body, `gap` m beyond where it ends towards +x.
    [[nodiscard]] glm::vec3 outside(glm::vec3 place, float gap = 0.1f) const {
        // Walls along a line towards +x: +1 for one that leaves a body, −1 for one that enters.
        std::vector<std::pair<float, int>> crossed;
        int depth = 0;
        const auto before = [](const gather_triangle& t, float z) { return lowest(t) < z; };
        auto at = std::lower_bound(walls_.begin(), walls_.end(), place.z - widest_, before);
        for (; at != walls_.end() && lowest(*at) <= place.z; ++at) {
            const auto [x, leaves] = crossing(*at, place);
            if (leaves != 0 && x > place.x) {
                crossed.emplace_back(x, leaves);
                depth += leaves;
            }
        }
        if (depth > 0) {
            std::sort(crossed.begin(), crossed.end());
            for (auto next = crossed.begin(); depth > 0; ++next) {
                depth -= next->second;
                place.x = next->first + gap;
            }
        }
        return place;
    }

  private:
    [[nodiscard]] static float lowest(const gather_triangle& t) {
        return std::min({t.a.z, t.b.z, t.c.z});
    }

    /// Where a line along x through a place crosses a triangle, and whether it goes out through its
    /// front (1), in (−1) or past (0).
    [[nodiscard]] static std::pair<float, int> crossing(const gather_triangle& t, glm::vec3 place) {
        const glm::vec3 a = t.a - place;
        const glm::vec3 b = t.b - place;
        const glm::vec3 c = t.c - place;
        const float at_a = b.y * c.z - b.z * c.y; // twice the areas in the plane across x
        const float at_b = c.y * a.z - c.z * a.y;
        const float at_c = a.y * b.z - a.z * b.y;
        const float all = at_a + at_b + at_c;
        const bool out = at_a >= 0 && at_b >= 0 && at_c >= 0 && all > 0;
        const bool in = at_a <= 0 && at_b <= 0 && at_c <= 0 && all < 0;
        if (!out && !in) {
            return {0.0f, 0};
        }
        return {(at_a * t.a.x + at_b * t.b.x + at_c * t.c.x) / all, out ? 1 : -1};
    }

    std::vector<gather_triangle> walls_; ///< by their lowest z
    float widest_ = 0;                   ///< m, along z
};

} // namespace skybark::meadow
