#pragma once
// Random values for tests: the same on every machine, which std::uniform_real_distribution is not.

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <random>

namespace skybark::support {

class random_source {
  public:
    explicit random_source(std::uint32_t seed) : engine_(seed) {}

    [[nodiscard]] std::uint32_t below(std::uint32_t n) { return bits() % n; }
    [[nodiscard]] std::uint32_t bits() { return static_cast<std::uint32_t>(engine_()); }

    /// In [low, high).
    [[nodiscard]] double between(double low, double high) {
        return low + (high - low) * (bits() / 4294967296.0);
    }

    /// Uniform on the sphere (Archimedes: the height is uniform).
    [[nodiscard]] glm::dvec3 direction() {
        const double z = between(-1, 1);
        const double angle = between(0, 6.283185307179586);
        const double r = std::sqrt(1 - z * z);
        return {r * std::cos(angle), r * std::sin(angle), z};
    }

    /// A rotation of up to `most_angle` rad about any axis, as (x, y, z, w).
    [[nodiscard]] glm::dvec4 rotation(double most_angle) {
        const double half = between(0, most_angle) / 2;
        return {std::sin(half) * direction(), std::cos(half)};
    }

  private:
    std::mt19937 engine_;
};

} // namespace skybark::support
