#version 450
// expand into rings: an invocation writes a part of an element's vertices, header.z of them.
// A group's 64 invocations are 64 elements at the same part, so that none waits in another's loop;
// or, by flag bit 2, neighbouring parts of the same elements, so that their writes coalesce.
layout(local_size_x = 64) in;
#include KERNEL
layout(std430, binding = 8) writeonly buffer skybark_vertices_buffer { vec4 skybark_vertices[]; };
uint skybark_cursor;

void emit_vertex() {
    for (uint v = 0u; v < uint(VERTEX_VEC4S); ++v) {
        skybark_vertices[skybark_cursor + v] = vertex_out[v];
    }
    skybark_cursor += uint(VERTEX_VEC4S);
}

void main() {
    uint vertices = kernel_ring_vertices();
    uint parts = (vertices + skybark_header.z - 1u) / skybark_header.z;
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    bool neighbours = (skybark_header.w & 4u) != 0u;
    uint work = neighbours ? group * 64u + gl_LocalInvocationID.x : group;
    uint part = work % parts;
    uint element = neighbours ? work / parts : work / parts * 64u + gl_LocalInvocationID.x;
    if (element < skybark_header.y) {
        uint first = part * skybark_header.z;
        skybark_cursor = (element * vertices + first) * uint(VERTEX_VEC4S);
        kernel_ring(skybark_header.x + element, first, min(skybark_header.z, vertices - first));
    }
}
