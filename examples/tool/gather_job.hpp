#pragma once
// What the gather command is asked for, and what it finds on the way.

#include "gather_options.hpp"
#include "job.hpp"

#include <skybark/gather/lightmap.hpp>

#include <vector>

namespace skybark::tool {

struct gather_job : command_job {
    explicit gather_job(bool quiet)
        : command_job({"read", "build", "bounce", "gather", "draw", "write"}, quiet) {}

    gather_options options;

    // Filled by `read_gather`.
    std::vector<gather_triangle> triangles;
    std::vector<gather_material> materials;
    std::vector<std::uint32_t> alpha;      ///< words, as alpha_coordinates says
    std::vector<glm::vec3> corner_normals; ///< three a triangle; 0 where the file has none
    std::vector<gather_sample> samples;    ///< where light is asked for; empty for a picture
    std::vector<glm::vec3> places;         ///< of vertices, whose samples stand a little inwards
    std::vector<glm::uvec3> mesh;          ///< triangles of vertices; empty for other places
    gather::lightmap lightmap;
    float patch_size = 0; ///< of the scene, m
    std::string resumed;  ///< the state to go on from

    // Filled by `gather_light`, for the report.
    std::uint64_t patches = 0;
    std::uint64_t points = 0;
    std::uint64_t directions = 0;
    double error = 0;    ///< rms of the standard errors, W/m²
    bool reached = true; ///< the error that was asked for
};

/// Reads the scene, the points and the state, or finds the places where light is asked for.
[[nodiscard]] result<void> read_gather(gather_job& job);

/// Writes irradiance and errors at the samples: a table, a mesh or a lightmap.
[[nodiscard]] result<void> write_light(const gather_job& job, std::span<const glm::vec4> light);

/// Options that a state depends on, in words: a state says them in its first line.
[[nodiscard]] std::string state_line(const gather_job& job);
/// What is behind the first line of the state that was read, if that says what the job's would.
/// Errors name the first difference.
[[nodiscard]] result<std::string_view> state_behind_line(const gather_job& job);

/// What is nearly the brightest: 99 of 100 are below. For what becomes white.
[[nodiscard]] float nearly_brightest(std::vector<float> values);

// One a backend, each in its own file, so that none needs another's headers.
[[nodiscard]] result<void> gather_on_cpu(gather_job& job);
[[nodiscard]] result<void> gather_on_opengl(gather_job& job);
[[nodiscard]] result<void> gather_on_vulkan(gather_job& job);

} // namespace skybark::tool
