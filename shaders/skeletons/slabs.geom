#version 450
// accumulate, drawn: a point is a part of an element, header.z of its slabs, and becomes as many
// rectangles as the element has there; with degenerate padding (bit 1 of the flags) header.z, the
// spare ones with all four vertices equal. gl_Layer has no effect where the target has no layers.
#include KERNEL
#include "slab_raster.glsl"
#ifndef SKYBARK_MAX_VERTICES
#define SKYBARK_MAX_VERTICES 16
#endif
layout(points) in;
layout(triangle_strip, max_vertices = SKYBARK_MAX_VERTICES) out;
layout(location = 0) flat in ivec2 skybark_point[1];
layout(location = 0) flat out ivec2 skybark_cell; // the element and its layer

void skybark_emit(uint i, voxel_slab slab) {
    for (uint corner = 0u; corner < 4u; ++corner) {
        skybark_cell = ivec2(i, slab.slice);
        gl_Layer = slab.slice - skybark_layers.z;
        gl_Position = skybark_corner(slab, corner);
        EmitVertex();
    }
    EndPrimitive();
}

void main() {
    uint slabs = kernel_slabs();
    uint parts = (slabs + skybark_header.z - 1u) / skybark_header.z;
    uint element = uint(skybark_point[0].x) / parts;
    uint i = skybark_header.x + element;
    uint first = (uint(skybark_point[0].x) - element * parts) * skybark_header.z;
    bool padded = (skybark_header.w & 2u) != 0u;
    uint count = kernel_slab_count(i);
    uint last = min(first + skybark_header.z, padded ? slabs : min(count, slabs));
    for (uint s = first; s < last; ++s) {
        voxel_slab slab = skybark_nothing();
        if (s < count) {
            slab = skybark_visible(i, s);
        }
        if (padded || !skybark_empty(slab)) {
            skybark_emit(i, slab);
        }
    }
}
