#pragma once
// Random numbers that depend on a seed and a number alone, and directions from them.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace skybark::first_pass {

/// One sequence for each (seed, number): splitmix64 (Steele, Lea and Flood 2014).
class random_sequence {
  public:
    random_sequence(std::uint64_t seed, std::uint64_t number)
        : state_(mixed(mixed(seed) ^ (number * 0xd1342543de82ef95ull))) {}

    /// In [0, 1), of 24 bits.
    [[nodiscard]] float next() {
        state_ += 0x9e3779b97f4a7c15ull;
        return static_cast<float>(mixed(state_) >> 40) * 0x1p-24f;
    }

  private:
    [[nodiscard]] static std::uint64_t mixed(std::uint64_t x) {
        x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
        x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
        return x ^ (x >> 31);
    }
    std::uint64_t state_;
};

inline constexpr float pi = 3.14159265f;

/// Two unit vectors that stand on `z` and on each other.
struct axes_across {
    explicit axes_across(glm::vec3 z)
        : x(glm::normalize(std::abs(z.x) < 0.7f ? glm::cross(z, glm::vec3(1, 0, 0))
                                                : glm::cross(z, glm::vec3(0, 1, 0)))),
          y(glm::cross(z, x)) {}
    glm::vec3 x;
    glm::vec3 y;
};

/// A direction off a surface of this normal, with a density of cos / π.
[[nodiscard]] inline glm::vec3 cosine_direction(glm::vec3 normal, float u, float v) {
    const axes_across across(normal);
    const float r = std::sqrt(u);
    const float angle = 2 * pi * v;
    return glm::normalize(across.x * (r * std::cos(angle)) + across.y * (r * std::sin(angle)) +
                          normal * std::sqrt(std::max(0.0f, 1 - u)));
}

/// Any direction, all alike.
[[nodiscard]] inline glm::vec3 any_direction(float u, float v) {
    const float y = 1 - 2 * u;
    const float r = std::sqrt(std::max(0.0f, 1 - y * y));
    return {r * std::cos(2 * pi * v), y, r * std::sin(2 * pi * v)};
}

/// Within a disk of radius 1 across `axis`.
[[nodiscard]] inline glm::vec3 in_disk(glm::vec3 axis, float u, float v) {
    const axes_across across(axis);
    const float r = std::sqrt(u);
    return across.x * (r * std::cos(2 * pi * v)) + across.y * (r * std::sin(2 * pi * v));
}

[[nodiscard]] inline float luminance(glm::vec3 c) {
    return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

} // namespace skybark::first_pass
