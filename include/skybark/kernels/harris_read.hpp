#pragma once
// harris_read: the light that reaches a particle in Harris's light pass.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/attenuation.hpp>

namespace skybark::kernels {

/// The pixel of the light buffer at the centre of the k-th particle. One element. Buffers:
/// particles; their order; the light buffer, row after row; a value for each particle.
struct harris_read {
    using buffers = buffer_list<readonly<cloud_particle>, readonly<std::uint32_t>, readonly<float>,
                                writeonly<float>>;

    light_grid grid; ///< its x and z are the buffer's columns and rows
    std::uint32_t k = 0;
    std::uint32_t columns = 0;
    std::uint32_t rows = 0;
    std::uint32_t to = 0; ///< where in the last buffer it goes

    void map(std::uint32_t, std::span<const cloud_particle> particles,
             std::span<const std::uint32_t> order, std::span<const float> light,
             std::span<float> lights) const {
        const glm::vec3 cells = shared::holdable_cells_of(grid, particles[order[k]].position);
        const auto x = static_cast<std::uint32_t>(
            glm::clamp(glm::floor(cells.x), 0.0f, static_cast<float>(columns - 1)));
        const auto z = static_cast<std::uint32_t>(
            glm::clamp(glm::floor(cells.z), 0.0f, static_cast<float>(rows - 1)));
        lights[to] = light[z * columns + x];
    }
};

} // namespace skybark::kernels
