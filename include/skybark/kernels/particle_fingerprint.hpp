#pragma once
// particle_fingerprint: sort keys that put particles in an order that is theirs, whatever the order
// of the list that they come in.

#include <skybark/core/kernel.hpp>
#include <skybark/shared/puff.hpp>

namespace skybark::kernels {

/// Buffers: particles, keys, values. Maps over particles: sorting the pairs by key gives the
/// particles' numbers in an order that only equal particles, and one pair in 2^32 of others, take
/// from the list. Those that differ in one value alone never do.
struct particle_fingerprint {
    using buffers =
        buffer_list<readonly<cloud_particle>, writeonly<std::uint32_t>, writeonly<std::uint32_t>>;

    void map(std::uint32_t i, std::span<const cloud_particle> particles,
             std::span<std::uint32_t> keys, std::span<std::uint32_t> order) const {
        const cloud_particle& p = particles[i];
        keys[i] = shared::puff_fingerprint(p.position, p.radius, p.optical_depth, p.albedo);
        order[i] = i;
    }
};

} // namespace skybark::kernels
