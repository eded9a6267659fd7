#pragma once
// What the benchmarks of gathering have in common: scenes with points on them, and directions.

#include <scenes/samples.hpp>
#include <scenes/scenes.hpp>
#include <skybark/gather/bundle.hpp>

#include <cmath>
#include <cstdint>
#include <ctime>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace skybark::benchmarks {

/// A scene and points on it in Morton order.
struct gather_work {
    scenes::surface_list scene;
    std::vector<gather_sample> samples;
    gather::bounds box;
    float lift = 0; ///< m
};

[[nodiscard]] inline const gather_work& work_of(const std::string& scene, std::uint32_t count) {
    static std::map<std::pair<std::string, std::uint32_t>, gather_work> made;
    gather_work& work = made[{scene, count}];
    if (work.samples.empty()) {
        work.scene = scenes::scene_named(scene);
        work.samples = scenes::morton_order(scenes::sample_surfaces(work.scene, count));
        work.box = gather::bounds_of(work.scene.triangles);
        work.lift = gather::default_lift(work.box);
    }
    return work;
}

/// The i-th of 64 axes all over the hemisphere, in an order that jumps about.
[[nodiscard]] inline glm::vec3 axis_of(std::uint32_t i) {
    const double n = (i * 37) % 64;
    const double y = 1 - (n + 0.5) / 64;
    const double angle = 2.399963229728653 * n;
    const double r = std::sqrt(1 - y * y);
    return {r * std::cos(angle), y, r * std::sin(angle)};
}

/// What all threads of the process have spent since it was made.
class cpu_clock {
  public:
    [[nodiscard]] double milliseconds() const {
        return 1e3 * static_cast<double>(std::clock() - begin_) / CLOCKS_PER_SEC;
    }

  private:
    std::clock_t begin_ = std::clock();
};

} // namespace skybark::benchmarks
