// Device side of skybark::kernels::hermite_branch.
#define KERNEL_PARAMETERS uint sides; uint rings; uint frame;
#define VERTEX_VEC4S 3
#include "../skeletons/parameters.glsl"
#include "../shared/branch.glsl"
layout(std430, binding = 0) readonly buffer segments_buffer { branch_segment segments[]; };
layout(std430, binding = 1) readonly buffer ends_buffer { branch_end ends[]; };
layout(std430, binding = 2) readonly buffer corners_buffer { vec4 corners[]; };

void emit_surface(surface_vertex s) {
    vertex_out[0] = vec4(s.position, s.u);
    vertex_out[1] = vec4(s.normal, s.v);
    vertex_out[2] = s.tangent;
    emit_vertex();
}

branch_ring ring_at(branch_end a, branch_end b, branch_curve c, uint k) {
    return frame == 0u ? branch_ring_slerp(a, b, c, float(k) / float(rings - 1u))
                       : branch_ring_rotation_minimising(a, b, c, k, rings - 1u);
}

uint kernel_ring_vertices() { return rings * (sides + 1u); }

void kernel_ring(uint i, uint first, uint count) {
    branch_segment segment = segments[i];
    branch_end a = ends[segment.start];
    branch_end b = ends[segment.end];
    branch_curve c = branch_curve_between(a, b);
    uint around = sides + 1u;
    uint last = first + count;
    for (uint k = first / around; k * around < last; ++k) {
        branch_ring r = ring_at(a, b, c, k);
        uint corner_last = min(last - k * around, around);
        for (uint corner = max(first, k * around) - k * around; corner < corner_last; ++corner) {
            emit_surface(branch_vertex(r, corners[corner]));
        }
    }
}

// Strips: the cap at the start, the tube gap by gap, the cap at the end.
uint kernel_strips() { return rings + 1u; }
uint kernel_strip_triangles() { return 2u * sides; }

uint kernel_triangles(uint i, uint strip) {
    branch_segment segment = segments[i];
    if (strip == 0u) {
        return (segment.caps & 1u) != 0u ? sides - 2u : 0u;
    }
    if (strip == rings) {
        return (segment.caps & 2u) != 0u ? sides - 2u : 0u;
    }
    return 2u * sides;
}

void kernel_strip(uint i, uint strip, uint first, uint count) {
    branch_segment segment = segments[i];
    branch_end a = ends[segment.start];
    branch_end b = ends[segment.end];
    uint last = first + count;
    if (strip == 0u || strip == rings) {
        bool base = strip == 0u;
        branch_ring r = branch_ring_at_end(base ? a : b);
        for (uint j = first; j < last; ++j) {
            emit_surface(branch_cap_vertex(r, corners[branch_cap_corner(j, sides, base)], base));
        }
        return;
    }
    branch_curve c = branch_curve_between(a, b);
    branch_ring lower = ring_at(a, b, c, strip - 1u);
    branch_ring upper = ring_at(a, b, c, strip);
    for (uint j = first; j < last; ++j) {
        // One place that emits: software devices run both sides of a branch.
        bool above = (j & 1u) == 0u;
        emit_surface(branch_vertex(above ? upper : lower, corners[j / 2u]));
    }
}
