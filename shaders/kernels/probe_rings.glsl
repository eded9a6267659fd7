// Device side of skybark::kernels::probe_rings.
#define KERNEL_PARAMETERS uint around;
#define VERTEX_VEC4S 1
#include "../skeletons/parameters.glsl"
layout(std430, binding = 0) readonly buffer payloads_buffer { vec4 payloads[]; };

uint kernel_ring_vertices() { return around; }

void kernel_ring(uint i, uint first, uint count) {
    for (uint j = first; j < first + count; ++j) {
        vertex_out[0] = vec4(float(i), float(j), payloads[i].x, payloads[i].y);
        emit_vertex();
    }
}
