#version 450
// Clip space has y up and 0 <= z <= w on every backend; the viewport turns row 0 to the top.
#define SKYBARK_VERTEX_STAGE
#include KERNEL

void main() { gl_Position = kernel_vertex(uint(SKYBARK_VERTEX_INDEX)); }
