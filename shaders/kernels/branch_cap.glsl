// Device side of skybark::kernels::branch_cap.
#define KERNEL_PARAMETERS uint sides;
#define VERTEX_VEC4S 3
#include "../skeletons/parameters.glsl"
#include "../shared/branch.glsl"
// An end and its side: 2 * index, + 1 where the branch starts there.
layout(std430, binding = 0) readonly buffer caps_buffer { uint caps[]; };
layout(std430, binding = 1) readonly buffer ends_buffer { branch_end ends[]; };
layout(std430, binding = 2) readonly buffer corners_buffer { vec4 corners[]; };

uint kernel_ring_vertices() { return sides; }

void kernel_ring(uint i, uint first, uint count) {
    bool base = (caps[i] & 1u) != 0u;
    branch_ring r = branch_ring_at_end(ends[caps[i] / 2u]);
    for (uint j = first; j < first + count; ++j) {
        surface_vertex s =
            branch_cap_vertex(r, corners[branch_cap_corner(j, sides, base)], base);
        vertex_out[0] = vec4(s.position, s.u);
        vertex_out[1] = vec4(s.normal, s.v);
        vertex_out[2] = s.tangent;
        emit_vertex();
    }
}
