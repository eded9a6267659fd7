#version 450
// expand into a list: an invocation writes a part of a strip, header.z triangles (an even number).
// Degenerate padding: the strip's slot has a fixed place, and its end is filled with zero bytes.
// Compact: binding 9 says where the element's triangles start, and nothing passes the view's end.
// Which invocations share a group: see rings.comp.
layout(local_size_x = 64) in;
#include KERNEL
#include "length.glsl"
layout(std430, binding = 8) writeonly buffer skybark_vertices_buffer { vec4 skybark_vertices[]; };
layout(std430, binding = 9) readonly buffer skybark_offsets_buffer { uint skybark_offsets[]; };
const uint skybark_triangle = 3u * uint(VERTEX_VEC4S);
uint skybark_base;   // where the part's first triangle goes, in vec4s
uint skybark_count;  // the part's triangles
uint skybark_vertex; // the part's vertices that have been emitted

void skybark_put(uint triangle, uint corner) {
    uint at = skybark_base + triangle * skybark_triangle + corner * uint(VERTEX_VEC4S);
    for (uint v = 0u; v < uint(VERTEX_VEC4S); ++v) {
        skybark_vertices[at + v] = vertex_out[v];
    }
}

// Vertex j is a corner of triangles j, j - 1 and j - 2. Triangle t is (t, t + 1, t + 2) where t is
// even and (t + 1, t, t + 2) where it is odd; a part starts with an even one.
void emit_vertex() {
    uint j = skybark_vertex++;
    if (j < skybark_count) {
        skybark_put(j, j & 1u);
    }
    if (j - 1u < skybark_count) {
        skybark_put(j - 1u, j & 1u);
    }
    if (j - 2u < skybark_count) {
        skybark_put(j - 2u, 2u);
    }
}

uint skybark_capacity() { return uint(skybark_vertices.length()) / skybark_triangle; }

// `count` triangles of the strip from `first` on, at triangle `place` of the list.
void skybark_emit(uint i, uint strip, uint first, uint count, uint place) {
    uint capacity = skybark_capacity();
    if (count == 0u || place >= capacity) {
        return;
    }
    skybark_base = place * skybark_triangle;
    skybark_count = min(count, capacity - place);
    skybark_vertex = 0u;
    kernel_strip(i, strip, first, skybark_count + 2u);
}

void skybark_fill(uint place, uint count) {
    uint last = min(place + count, skybark_capacity()) * skybark_triangle;
    for (uint at = place * skybark_triangle; at < last; ++at) {
        skybark_vertices[at] = vec4(0.0);
    }
}

void main() {
    uint most = kernel_strip_triangles();
    uint parts = (most + skybark_header.z - 1u) / skybark_header.z;
    uint works = kernel_strips() * parts;
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    bool neighbours = (skybark_header.w & 4u) != 0u;
    uint id = neighbours ? group * 64u + gl_LocalInvocationID.x : group;
    uint work = id % works;
    uint k = neighbours ? id / works : id / works * 64u + gl_LocalInvocationID.x;
    uint i = skybark_header.x + k;
    bool counted = (skybark_header.w & 1u) != 0u;
    if (k >= skybark_header.y || (counted && i >= skybark_length[0])) {
        return;
    }
    uint strip = work / parts;
    uint first = (work % parts) * skybark_header.z;
    uint slot = min(skybark_header.z, most - first);
    uint triangles = kernel_triangles(i, strip);
    uint count = triangles > first ? min(triangles - first, slot) : 0u;
    if ((skybark_header.w & 2u) != 0u) {
        uint place = (k * kernel_strips() + strip) * most + first;
        skybark_emit(i, strip, first, count, place);
        skybark_fill(place + count, slot - count);
        return;
    }
    uint place = skybark_offsets[k];
    if (count == 0u || place >= skybark_capacity()) {
        return; // where sums saturate, they do so far beyond any capacity
    }
    for (uint s = 0u; s < strip; ++s) {
        place += kernel_triangles(i, s);
    }
    skybark_emit(i, strip, first, count, place + first);
}
