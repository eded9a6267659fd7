#pragma once
// Radiosity by progressive refinement, for the first pass of a gather (Cohen, Chen, Wallace and
// Greenberg 1988): the patch with the most light to give gives it to all others, again and again,
// which is Southwell's relaxation of the radiosity equations. On the host.
//
//     auto tables = first_pass::patch_tables(scene, 4);
//     auto found = first_pass::radiosity(scene, tables, lights, {});
//     found->radiance; // one vec4 a patch: for gather_scene
//
// Light goes from a patch to the middle of another by the form factor of a point to a polygon
// (form_factor.hpp) times the part of rays that get through, traced by Embree. The same options
// give the same bits on any number of threads.

#include <first_pass/patches.hpp>
#include <skybark/core/result.hpp>

namespace skybark::first_pass {

struct radiosity_options {
    std::uint32_t visibility_rays = 8;  ///< from patch to patch, ≥ 1
    std::uint32_t sky_rays = 256;       ///< from a patch to the sky
    double left = 1e-3;                 ///< ends when so much of the first light is still to give
    std::uint32_t most_shots = 100'000; ///< … or after so many patches gave
    std::uint64_t seed = 1;
    std::uint32_t threads = 0; ///< 0: as many as there are
};

struct radiosity_solution {
    std::vector<glm::vec4> irradiance; ///< W/m², one a patch
    std::vector<glm::vec4> radiance;   ///< W/(m² sr), one a patch
    std::uint32_t shots = 0;           ///< patches that gave
    double left = 0;                   ///< of the first light, what is still to give
};

/// Errors: bad_input where there are no triangles, or not a table for each.
[[nodiscard]] result<radiosity_solution> radiosity(const surfaces& scene,
                                                   std::span<const patch_table> tables,
                                                   const far_lights& lights,
                                                   const radiosity_options& options);

} // namespace skybark::first_pass
