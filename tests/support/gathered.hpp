#pragma once
// Scenes and gathers for tests of gathered light.

#include <skybark/gather/bounces.hpp>

#include <scenes/surface_list.hpp>

#include <gtest/gtest.h>
#include <span>
#include <utility>
#include <vector>

namespace skybark::support {

[[nodiscard]] inline gather::scene_description describe(const scenes::surface_list& scene,
                                                        float patch_size = 0) {
    gather::scene_description what;
    what.triangles = scene.triangles;
    what.materials = scene.materials;
    what.patch_size = patch_size;
    return what;
}

/// A material that emits, and reflects `diffuse`.
[[nodiscard]] inline std::uint32_t add_light(scenes::surface_list& scene, glm::vec3 emission,
                                             glm::vec3 diffuse = glm::vec3(0)) {
    gather_material light;
    light.emission = emission;
    light.diffuse = diffuse;
    return scenes::add_material(scene, light);
}

/// Fronts look the other way.
inline void turn_inside_out(scenes::surface_list& scene) {
    for (gather_triangle& t : scene.triangles) {
        std::swap(t.b, t.c);
    }
}

[[nodiscard]] inline gather_sample sample_at(glm::vec3 position, glm::vec3 normal) {
    gather_sample made;
    made.position = position;
    made.normal = normal;
    return made;
}

/// Samples at the middles of all triangles, on their fronts.
[[nodiscard]] inline std::vector<gather_sample> middles_of(const scenes::surface_list& scene) {
    std::vector<gather_sample> samples;
    for (const gather_triangle& t : scene.triangles) {
        samples.push_back(
            sample_at((t.a + t.b + t.c) / 3.0f, glm::normalize(glm::cross(t.b - t.a, t.c - t.a))));
    }
    return samples;
}

template <class B>
[[nodiscard]] gather::gather_scene<B> make_scene(B& device, const gather::scene_description& what) {
    auto made = gather::gather_scene<B>::create(device, what);
    EXPECT_TRUE(made) << made.error().message;
    return std::move(*made);
}

template <class B, class Samples>
[[nodiscard]] gather::final_gather<B> make_gather(B& device, const gather::gather_scene<B>& scene,
                                                  const Samples& samples,
                                                  const gather::final_gather_options& options) {
    auto made = gather::final_gather<B>::create(device, scene, samples, options);
    EXPECT_TRUE(made) << made.error().message;
    return std::move(*made);
}

template <class B>
[[nodiscard]] std::vector<glm::vec4> read(gather::final_gather<B>& gather) {
    std::vector<glm::vec4> found(gather.samples());
    const auto done = gather.read(found);
    EXPECT_TRUE(done) << done.error().message;
    return found;
}

/// What so many axes find at the samples of a scene.
template <class B>
[[nodiscard]] std::vector<glm::vec4>
gathered(B& device, const gather::gather_scene<B>& scene, std::span<const gather_sample> samples,
         std::uint64_t axes, const gather::final_gather_options& options = {}) {
    auto gather = make_gather(device, scene, samples, options);
    const auto done = gather.add(axes);
    EXPECT_TRUE(done) << done.error().message;
    return read(gather);
}

} // namespace skybark::support
