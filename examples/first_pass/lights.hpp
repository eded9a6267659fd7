#pragma once
// What lights a scene from afar, and what it looks like up close, for first passes on the host.

#include <skybark/core/records.hpp>

#include <functional>
#include <span>

namespace skybark::first_pass {

/// Light from outside of the scene; emission is the materials'.
struct far_lights {
    glm::vec3 to_sun{0, 1, 0};               ///< unit
    glm::vec3 sun{0};                        ///< irradiance across the beam, W/m²
    std::function<glm::vec3(glm::vec3)> sky; ///< radiance from a direction; empty: black
};

/// Triangles as a gather has them. What the spans see must outlive what is made of them.
struct surfaces {
    std::span<const gather_triangle> triangles;
    std::span<const gather_material> materials;
    std::span<const std::uint32_t> alpha; ///< words, as alpha_coordinates says; empty: no holes
};

} // namespace skybark::first_pass
