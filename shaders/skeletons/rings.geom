#version 450
// expand_rings: a point is a part of an element, at most header.z of its ring vertices. They go out
// as points, each vertex once; an index buffer makes the triangles.
#include KERNEL
#include "expand_geom.glsl"
layout(points, max_vertices = SKYBARK_MAX_VERTICES) out;

void main() {
    uint vertices = kernel_ring_vertices();
    uint part = skybark_header.z;
    uint parts = (vertices + part - 1u) / part;
    uint element = skybark_point[0] / parts;
    uint first = (skybark_point[0] - element * parts) * part;
    kernel_ring(skybark_header.x + element, first, min(part, vertices - first));
}
