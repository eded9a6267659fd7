// Device side of skybark::kernels::particle_impulse.
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS light_grid grid; float sigmas; float forward; uint light; uint profile; uint slices;
#include "particle_slices.glsl.inc"

uint kernel_slabs() { return slices; }
uint kernel_slab_count(uint i) { return slice_count(place(particle_at(i))); }

voxel_slab kernel_slab(uint i, uint s) {
    cloud_particle p = particle_at(i);
    placed at = place(p);
    int z = first_slice(at) + int(s);
    float dz = (float(z) + 0.5 - at.centre.z) * grid.voxel.z;
    float reach = holdable(sqrt(max(p.radius * p.radius - dz * dz, 0.0)) / grid.voxel.x);
    int top = top_row(at.centre.y, at.radius.y);
    int bottom = profile == 0u ? top : min(top, bottom_row(at.centre.y, at.radius.y));
    return voxel_slab(ivec2(int(floor(at.centre.x - reach)), bottom),
                      ivec2(int(floor(at.centre.x + reach)) + 1, top + 1), z);
}

float kernel_lateral(uint i, int x, int z) {
    cloud_particle p = particle_at(i);
    return lateral_of(p, place(p), x, z);
}

float kernel_row(uint i, int y) { return part_of(place(particle_at(i)), y); }

int kernel_amount(float lateral, float row, float above) {
    return quanta(lateral * row) - quanta(lateral * above);
}
