// Device side of skybark::kernels::harris_splat.
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS light_grid grid; float sigmas; float forward; float incoming; uint k; uint columns; uint rows; uint side;
#include "../skeletons/parameters.glsl"
#include "../shared/attenuation.glsl"
layout(std430, binding = 0) readonly buffer particles_buffer { vec4 particles[]; };
layout(std430, binding = 1) readonly buffer order_buffer { uint order[]; };
layout(std430, binding = 2) readonly buffer before_buffer { float before[]; };
layout(std430, binding = 3) writeonly buffer after_buffer { float after[]; };

int first_pixel(float centre, float radius) { return int(ceil(centre - radius - 0.5)); }

void kernel_map(uint pixel) {
    uint i = order[k];
    vec4 a = particles[2u * i];
    vec4 b = particles[2u * i + 1u];
    cloud_particle p = cloud_particle(a.xyz, a.w, b.x, b.y, b.z, b.w);
    vec3 cells = holdable_cells_of(grid, p.position);
    int x = first_pixel(cells.x, holdable(p.radius / grid.voxel.x)) + int(pixel % side);
    int z = first_pixel(cells.z, holdable(p.radius / grid.voxel.z)) + int(pixel / side);
    if (x < 0 || z < 0 || x >= int(columns) || z >= int(rows)) {
        return;
    }
    float dx = (float(x) + 0.5 - cells.x) * grid.voxel.x;
    float dz = (float(z) + 0.5 - cells.z) * grid.voxel.z;
    float depth = particle_attenuation(p, dx * dx + dz * dz, sigmas, 0u, 0.0);
    if (depth > 0.0) {
        uint at = uint(z) * columns + uint(x);
        after[at] = exp_minus(depth) * before[at] + bounded(p.albedo, 1.0) * depth * forward * incoming;
    }
}
