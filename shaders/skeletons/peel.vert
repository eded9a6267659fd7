#version 450
// peel: the corners of triangles, from triangle header.x on. header.y: pixels in a row of the
// raster, whose row 0 is at clip y = -1. What comes next is programs/peel.glsl.
#include KERNEL
layout(location = 0) flat out uvec2 skybark_triangle; // its number, pixels in a row

void main() {
    uint index = skybark_header.x * 3u + uint(SKYBARK_VERTEX_INDEX);
    skybark_triangle = uvec2(index / 3u, skybark_header.y);
    gl_Position = kernel_corner(index);
}
