#pragma once
// harris_order: sort keys of Harris's light pass, the particle nearest to the sun first.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/attenuation.hpp>
#include <skybark/shared/order.hpp>

namespace skybark::kernels {

/// Buffers: particles; keys; the particles' numbers.
struct harris_order {
    using buffers =
        buffer_list<readonly<cloud_particle>, writeonly<std::uint32_t>, writeonly<std::uint32_t>>;

    light_grid grid; ///< y points to the sun

    void map(std::uint32_t i, std::span<const cloud_particle> particles,
             std::span<std::uint32_t> keys, std::span<std::uint32_t> numbers) const {
        keys[i] = shared::falling_key(shared::holdable_cells_of(grid, particles[i].position).y);
        numbers[i] = i;
    }
};

} // namespace skybark::kernels
