#pragma once
// What the cloud command is asked for, and what it finds on the way.

#include "cloud_options.hpp"
#include "job.hpp"

#include <io/density_grid.hpp>
#include <io/probe_points.hpp>
#include <skybark/core/backend.hpp>

#include <vector>

namespace skybark::tool {

/// Particles that are too small for the voxels of a volume.
struct thin_particles {
    std::size_t count = 0;
    double share = 0;         ///< of all optical depth times area
    double enough_voxels = 0; ///< along each side, for all but a hundredth of that
};

struct cloud_job : command_job {
    explicit cloud_job(bool quiet)
        : command_job({"read", "build", "light", "draw", "write"}, quiet) {}

    cloud_options options;

    // Filled by `read_cloud`: particles, or a grid.
    std::vector<cloud_particle> particles;
    io::density_grid grid;
    std::vector<glm::vec3> points; ///< of --probe
    glm::vec3 low{0};              ///< m, the box around the cloud
    glm::vec3 high{0};

    // Filled by `make_cloud`, for the report.
    clouds::light_box box;
    thin_particles thin; ///< for that box

    [[nodiscard]] bool is_grid() const { return options.source == cloud_source::grid; }
};

/// A volume as it came from a device, and where it lies.
struct finished_volume {
    std::string name; ///< of its grid in the file
    light_grid grid;
    glm::uvec3 voxels{0};
    std::vector<float> values;
    bool half = false; ///< it held 16 bits a value
};

/// Reads the cloud, and the points.
[[nodiscard]] result<void> read_cloud(cloud_job& job);
/// Writes them as one .vdb.
[[nodiscard]] result<void> write_volumes(const cloud_job& job,
                                         const std::vector<finished_volume>& volumes);

// One a backend, each in its own file, so that none needs another's headers.
[[nodiscard]] result<void> make_cloud_on_cpu(cloud_job& job);
[[nodiscard]] result<void> make_cloud_on_opengl(cloud_job& job);
[[nodiscard]] result<void> make_cloud_on_vulkan(cloud_job& job);

} // namespace skybark::tool
