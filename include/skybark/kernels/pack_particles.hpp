#pragma once
// pack_particles: a cloud's particles out of whatever buffers of floats hold them.

#include <skybark/core/kernel.hpp>

namespace skybark::kernels {

/// Maps over particles. Buffers: positions (three floats each, m), radii (m), optical depths,
/// albedos, particles. The attribute of particle i begins at float `first + stride · i` of its
/// buffer; with a stride of 0 all particles have the same. The buffers that are read may be one and
/// the same. Every number is copied as it is.
struct pack_particles {
    using buffers = buffer_list<readonly<float>, readonly<float>, readonly<float>, readonly<float>,
                                writeonly<cloud_particle>>;

    std::uint32_t first_position = 0;
    std::uint32_t position_stride = 3;
    std::uint32_t first_radius = 0;
    std::uint32_t radius_stride = 1;
    std::uint32_t first_depth = 0;
    std::uint32_t depth_stride = 1;
    std::uint32_t first_albedo = 0;
    std::uint32_t albedo_stride = 1;

    void map(std::uint32_t i, std::span<const float> positions, std::span<const float> radii,
             std::span<const float> depths, std::span<const float> albedos,
             std::span<cloud_particle> particles) const {
        const std::size_t at = first_position + std::size_t{position_stride} * i;
        cloud_particle p;
        p.position = glm::vec3(positions[at], positions[at + 1], positions[at + 2]);
        p.radius = radii[first_radius + std::size_t{radius_stride} * i];
        p.optical_depth = depths[first_depth + std::size_t{depth_stride} * i];
        p.albedo = albedos[first_albedo + std::size_t{albedo_stride} * i];
        particles[i] = p;
    }
};
static_assert(sizeof(pack_particles) == 32);

} // namespace skybark::kernels
