#pragma once
// A photon map, for the first pass of a gather (Jensen 1996, "Global illumination using photon
// maps"): light as particles, followed through the scene on the host, kept where they arrive, and
// counted around the points that ask.
//
//     auto map = first_pass::photon_map::trace(scene, lights, {});
//     auto irradiance = map->irradiance(first_pass::middles_of(patches), 100);
//     auto radiance = first_pass::leaving_radiance(scene, patches, irradiance); // for gather_scene
//
// Photons are followed by Embree, their neighbours found by nanoflann's tree. The same seed gives
// the same bits on any number of threads.

#include <first_pass/lights.hpp>
#include <skybark/core/result.hpp>

#include <memory>
#include <vector>

namespace skybark::first_pass {

/// Light that has arrived on a surface.
struct photon {
    glm::vec3 position{0}; ///< m
    glm::vec3 normal{0};   ///< of the side that it arrived on, unit
    glm::vec3 power{0};    ///< W
};

struct photon_options {
    std::uint32_t photons = 500'000;   ///< that are sent out, over all lights
    std::uint32_t most_bounces = 1000; ///< 0: those alone that come straight from a light
    std::uint64_t seed = 1;
    std::uint32_t threads = 0; ///< 0: as many as there are
};

/// Where the light has gone, W.
struct photon_balance {
    glm::dvec3 emitted{0};
    glm::dvec3 absorbed{0}; ///< by surfaces, black backs among them
    glm::dvec3 escaped{0};  ///< past all surfaces
};

class photon_map {
  public:
    /// Sends photons out from emitting triangles, the sun and the sky, and follows them. Roulette
    /// decides, by what a surface does, whether one goes on and on which side.
    /// Errors: bad_input where there are no triangles, no photons, or no light.
    [[nodiscard]] static result<photon_map> trace(const surfaces& scene, const far_lights& lights,
                                                  const photon_options& options);
    ~photon_map();
    photon_map(photon_map&&) noexcept;
    photon_map& operator=(photon_map&&) noexcept;

    /// W/m² in rgb, one a sample: the power of the photons nearest to it, on sides that look within
    /// 45° of where it looks, over the area of the disk that they fill: `neighbours` ≥ 2 of them,
    /// or as many as lie within `farthest` m. Near the edge of a surface a part of that disk is
    /// empty: estimates there are too dark.
    [[nodiscard]] std::vector<glm::vec4> irradiance(std::span<const gather_sample> samples,
                                                    std::uint32_t neighbours,
                                                    float farthest = 1e30f) const;

    [[nodiscard]] std::span<const photon> photons() const;
    [[nodiscard]] const photon_balance& balance() const;

  private:
    struct contents;
    explicit photon_map(std::unique_ptr<contents> of);
    std::unique_ptr<contents> of_;
};

} // namespace skybark::first_pass
