// Device side of skybark::kernels::pack_particles.
#define KERNEL_PARAMETERS uint first_position; uint position_stride; uint first_radius; uint radius_stride; uint first_depth; uint depth_stride; uint first_albedo; uint albedo_stride;
#include "../skeletons/parameters.glsl"
layout(std430, binding = 0) readonly buffer positions_buffer { float positions[]; };
layout(std430, binding = 1) readonly buffer radii_buffer { float radii[]; };
layout(std430, binding = 2) readonly buffer depths_buffer { float depths[]; };
layout(std430, binding = 3) readonly buffer albedos_buffer { float albedos[]; };
layout(std430, binding = 4) writeonly buffer particles_buffer { vec4 particles[]; };

void kernel_map(uint i) {
    uint at = first_position + position_stride * i;
    float radius = radii[first_radius + radius_stride * i];
    float depth = depths[first_depth + depth_stride * i];
    float albedo = albedos[first_albedo + albedo_stride * i];
    particles[2u * i] = vec4(positions[at], positions[at + 1u], positions[at + 2u], radius);
    particles[2u * i + 1u] = vec4(depth, albedo, 0.0, 0.0);
}
