// Device side of skybark::kernels::shadow_slab.
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS light_grid grid; float sigmas; float forward; uint light; uint profile; uint slices;
#define VERTEX_VEC4S 1
#include "particle_slices.glsl.inc"

uint kernel_slabs() { return slices; }
uint kernel_slab_count(uint i) { return slice_count(place(particle_at(i))); }

voxel_slab kernel_slab(uint i, uint s) {
    placed at = place(particle_at(i));
    return voxel_slab(ivec2(int(ceil(at.centre.x - at.radius.x - 0.5)), 0),
                      ivec2(int(ceil(at.centre.x + at.radius.x - 0.5)),
                            top_row(at.centre.y, at.radius.y) + 1),
                      first_slice(at) + int(s));
}

float kernel_lateral(uint i, int x, int z) {
    cloud_particle p = particle_at(i);
    return lateral_of(p, place(p), x, z);
}

float kernel_row(uint i, int y) { return part_of(place(particle_at(i)), y); }

int kernel_amount(float lateral, float row, float above) { return quanta(lateral * row); }

#ifdef SKYBARK_EXPAND
uint kernel_strips() { return slices; }
uint kernel_strip_triangles() { return 2u; }
uint kernel_triangles(uint i, uint s) { return s < kernel_slab_count(i) ? 2u : 0u; }

void kernel_strip(uint i, uint s, uint first, uint count) {
    placed at = place(particle_at(i));
    float slice = float(first_slice(at) + int(s));
    for (uint v = first; v < first + count; ++v) {
        vertex_out[0] = vec4(v % 2u == 0u ? at.centre.x - at.radius.x : at.centre.x + at.radius.x,
                             v < 2u ? 0.0 : at.centre.y + at.radius.y, slice, float(i));
        emit_vertex();
    }
}
#endif
