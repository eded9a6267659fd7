#version 450
// expand: a point is a part of an element, as many whole strips as header.z triangles allow, or,
// where one strip is longer than that, an even number of its triangles. (An even number: in the
// next part triangle 0 winds as an even triangle again.) The order of the points is the order of
// the output.
#include KERNEL
#include "expand_geom.glsl"
layout(triangle_strip, max_vertices = SKYBARK_MAX_VERTICES) out;

// `count` triangles whose vertices are all zero.
void skybark_pad(uint count) {
    for (int v = 0; v < VERTEX_VEC4S; ++v) {
        vertex_out[v] = vec4(0.0);
    }
    for (uint v = 0u; v < count + 2u; ++v) {
        emit_vertex();
    }
    EndPrimitive();
}

// Those of the triangles [first, first + count) of a strip that there are, and the spare ones.
void skybark_run(uint element, uint strip, uint first, uint count) {
    uint present = kernel_triangles(element, strip);
    present = present > first ? min(present - first, count) : 0u;
    if (present != 0u) {
        kernel_strip(element, strip, first, present + 2u);
        EndPrimitive();
    }
    if ((skybark_header.w & 2u) != 0u && present != count) {
        skybark_pad(count - present);
    }
}

void main() {
    uint strips = kernel_strips();
    uint length = kernel_strip_triangles();
    uint whole = skybark_header.z / length; // strips in a part
    uint pieces = (length + skybark_header.z - 1u) / skybark_header.z; // parts of a strip
    uint parts = whole != 0u ? (strips + whole - 1u) / whole : strips * pieces;
    uint element = skybark_point[0] / parts;
    uint part = skybark_point[0] - element * parts;
    uint strip = whole != 0u ? part * whole : part / pieces;
    uint first = whole != 0u ? 0u : (part - strip * pieces) * skybark_header.z;
    uint count = whole != 0u ? length : min(skybark_header.z, length - first);
    uint last = min(strip + max(whole, 1u), strips);
    for (; strip < last; ++strip) {
        skybark_run(skybark_header.x + element, strip, first, count);
    }
}
