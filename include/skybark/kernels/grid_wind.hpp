#pragma once
// grid_wind: the air's velocity at places, between the nodes of a regular grid.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/wind.hpp>

namespace skybark::kernels {

/// Buffers: places (xyz m), velocities at the nx · ny · nz nodes (xyz m/s; x runs fastest, then y),
/// air (xyz m/s, w: speed). Maps over places. Trilinear; outside, the nearest place of the grid.
struct grid_wind {
    using buffers = buffer_list<readonly<glm::vec4>, readonly<glm::vec4>, writeonly<glm::vec4>>;
    using nodes_span = std::span<const glm::vec4>;

    glm::vec4 origin{0};      ///< m, of the first node; w unused
    glm::vec4 per_spacing{1}; ///< 1/m, nodes a metre; w unused
    std::uint32_t nx = 1;     ///< at least 1, as are ny and nz
    std::uint32_t ny = 1;
    std::uint32_t nz = 1;

    void map(std::uint32_t i, std::span<const glm::vec4> places, nodes_span nodes,
             std::span<glm::vec4> air) const {
        const glm::vec4& place = places[i];
        const auto x = shared::wind_cell_of(place.x, origin.x, per_spacing.x, nx);
        const auto y = shared::wind_cell_of(place.y, origin.y, per_spacing.y, ny);
        const auto z = shared::wind_cell_of(place.z, origin.z, per_spacing.z, nz);
        const glm::vec4 low =
            shared::wind_between(row(nodes, x, y.low, z.low), row(nodes, x, y.high, z.low), y.t);
        const glm::vec4 high =
            shared::wind_between(row(nodes, x, y.low, z.high), row(nodes, x, y.high, z.high), y.t);
        const glm::vec4 u = shared::wind_between(low, high, z.t);
        air[i] = shared::wind_velocity(u.x, u.y, u.z);
    }

  private:
    [[nodiscard]] glm::vec4 row(nodes_span nodes, const shared::wind_cell& x, std::uint32_t y,
                                std::uint32_t z) const {
        const std::uint32_t first = (z * ny + y) * nx;
        return shared::wind_between(nodes[first + x.low], nodes[first + x.high], x.t);
    }
};

} // namespace skybark::kernels
