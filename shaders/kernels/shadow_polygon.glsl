// Device side of skybark::kernels::shadow_polygon.
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS light_grid grid; float sigmas; float forward; uint light; uint profile; uint slices;
#include "particle_slices.glsl.inc"
layout(std430, binding = 1) readonly buffer corners_buffer { vec4 corners[]; };

uint kernel_slabs() { return 1u; }
uint kernel_slab_count(uint i) {
    return i % 2u == 0u && corners[3u * i].x != corners[3u * i + 1u].x ? 1u : 0u;
}

voxel_slab kernel_slab(uint i, uint s) {
    vec4 low = corners[3u * i];
    vec4 high = corners[3u * i + 5u];
    return voxel_slab(ivec2(ceil(low.xy - 0.5)), ivec2(ceil(high.xy - 0.5)), int(low.z));
}

cloud_particle particle_of(uint i) { return particle_at(uint(corners[3u * i].w)); }

float kernel_lateral(uint i, int x, int z) {
    cloud_particle p = particle_of(i);
    return lateral_of(p, place(p), x, z);
}

float kernel_row(uint i, int y) { return part_of(place(particle_of(i)), y); }

int kernel_amount(float lateral, float row, float above) { return quanta(lateral * row); }
