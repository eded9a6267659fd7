// Device side of skybark::kernels::probe_strips.
#define KERNEL_PARAMETERS uint strip_count; uint most;
#define VERTEX_VEC4S 2
#include "../skeletons/parameters.glsl"
layout(std430, binding = 0) readonly buffer counts_buffer { uint counts[]; };
layout(std430, binding = 1) readonly buffer payloads_buffer { vec4 payloads[]; };

uint kernel_strips() { return strip_count; }
uint kernel_strip_triangles() { return most; }
uint kernel_triangles(uint i, uint strip) { return counts[i * strip_count + strip]; }

void kernel_strip(uint i, uint strip, uint first, uint count) {
    for (uint j = first; j < first + count; ++j) {
        vertex_out[0] = vec4(float(i), float(strip), float(j), 1.0);
        vertex_out[1] = payloads[i];
        emit_vertex();
    }
}
