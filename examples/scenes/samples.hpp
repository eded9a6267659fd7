#pragma once
// Points on the surfaces of a scene, to gather light at.

#include <scenes/random.hpp>
#include <scenes/surface_list.hpp>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace skybark::scenes {

/// `count` points, each somewhere in its own share of the area, in the order of the triangles. They
/// see what the front sees; on surfaces of two sides, one or the other by chance.
[[nodiscard]] inline std::vector<gather_sample>
sample_surfaces(const surface_list& scene, std::uint32_t count, std::uint32_t seed = 3) {
    const auto twice_area = [&](std::size_t i) {
        const gather_triangle& t = scene.triangles[i];
        return static_cast<double>(glm::length(glm::cross(t.b - t.a, t.c - t.a)));
    };
    double whole = 0;
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
        whole += twice_area(i);
    }
    random_numbers random(seed);
    std::vector<gather_sample> samples(scene.triangles.empty() ? 0 : count);
    std::size_t triangle = 0;
    double end = scene.triangles.empty() ? 0 : twice_area(0);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const double share = (static_cast<double>(i) + static_cast<double>(random.between(0, 1))) /
                             static_cast<double>(samples.size());
        while (end < share * whole && triangle + 1 < scene.triangles.size()) {
            end += twice_area(++triangle);
        }
        const gather_triangle& t = scene.triangles[triangle];
        const float away = std::sqrt(random.between(0, 1));
        const float across = random.between(0, 1);
        const glm::vec3 normal = glm::normalize(glm::cross(t.b - t.a, t.c - t.a));
        const bool is_back =
            scene.materials[t.material].two_sided != 0 && (random.bits() & 0x80000000u) != 0;
        samples[i].position = (1 - away) * t.a + away * (1 - across) * t.b + away * across * t.c;
        samples[i].normal = is_back ? -normal : normal;
    }
    return samples;
}

/// Sorted along Morton's curve, 16 bits an axis, so that neighbours in the list are neighbours in
/// space.
[[nodiscard]] inline std::vector<gather_sample>
morton_order(std::span<const gather_sample> samples) {
    glm::vec3 low(1e30f);
    glm::vec3 high(-1e30f);
    for (const gather_sample& s : samples) {
        low = glm::min(low, s.position);
        high = glm::max(high, s.position);
    }
    const glm::vec3 size = high - low;
    const float scale = 65535 / std::max({size.x, size.y, size.z, 1e-30f});
    const auto spread = [](float value) {
        auto x = static_cast<std::uint64_t>(value);
        x = (x | x << 16) & 0x0000ff0000ffull;
        x = (x | x << 8) & 0x00f00f00f00full;
        x = (x | x << 4) & 0x0c30c30c30c3ull;
        return (x | x << 2) & 0x249249249249ull;
    };
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const glm::vec3 p = (samples[i].position - low) * scale;
        order[i] = {spread(p.x) | spread(p.y) << 1 | spread(p.z) << 2,
                    static_cast<std::uint32_t>(i)};
    }
    std::sort(order.begin(), order.end());
    std::vector<gather_sample> sorted(samples.size());
    std::transform(order.begin(), order.end(), sorted.begin(),
                   [&](const auto& from) { return samples[from.second]; });
    return sorted;
}

} // namespace skybark::scenes
