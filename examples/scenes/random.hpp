#pragma once
// Random numbers for scenes: the same on every machine, as std's distributions are not.

#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <random>

namespace skybark::scenes {

class random_numbers {
  public:
    explicit random_numbers(std::uint32_t seed) : engine_(seed) {}

    [[nodiscard]] std::uint32_t bits() { return static_cast<std::uint32_t>(engine_()); }

    /// In [low, high), of 24 bits.
    [[nodiscard]] float between(float low, float high) {
        return low + (high - low) * (static_cast<float>(bits() >> 8) * (1.0f / 16777216.0f));
    }

    /// Anywhere in the unit ball.
    [[nodiscard]] glm::vec3 in_ball() {
        for (;;) {
            const float x = between(-1, 1);
            const float y = between(-1, 1);
            const float z = between(-1, 1);
            if (x * x + y * y + z * z <= 1) {
                return {x, y, z};
            }
        }
    }

    /// Uniform on the unit sphere.
    [[nodiscard]] glm::vec3 direction() {
        for (;;) {
            const glm::vec3 p = in_ball();
            if (glm::dot(p, p) > 0.01f) {
                return glm::normalize(p);
            }
        }
    }

  private:
    std::mt19937 engine_;
};

} // namespace skybark::scenes
