#version 450
// accumulate, drawn: every element has kernel_slabs() rectangles of six vertices each, made from
// the vertex's number alone. Those that the element does not have are degenerate: all six vertices
// are equal, so that nothing after this stage touches them, and how many vertices are drawn depends
// on the number of elements alone (Shimada et al. 2008, section 4.1). How many slabs an element has
// is asked here, in one place, because a kernel is asked for none that it does not have. With bit 3
// of the flags there is a geometry stage, and this one only hands on the number of a point.
#include KERNEL
#include "slab_raster.glsl"
layout(location = 0) flat out ivec2 skybark_cell; // the element and its layer, or the point

void main() {
    if ((skybark_header.w & 8u) != 0u) {
        skybark_cell = ivec2(gl_VertexID, 0);
        gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
        return;
    }
    const uint corners[6] = uint[6](0u, 1u, 2u, 2u, 1u, 3u);
    uint rectangle = uint(gl_VertexID) / 6u;
    uint element = rectangle / kernel_slabs();
    uint s = rectangle - element * kernel_slabs();
    uint i = skybark_header.x + element;
    voxel_slab slab = skybark_nothing();
    if (s < kernel_slab_count(i)) {
        slab = skybark_visible(i, s);
    }
    skybark_cell = ivec2(i, slab.slice);
    gl_Position = skybark_corner(slab, corners[uint(gl_VertexID) - rectangle * 6u]);
}
