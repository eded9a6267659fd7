#version 450
// A point for each part of each element; the geometry shader does the rest.
layout(location = 0) flat out uint skybark_point;

void main() { skybark_point = uint(gl_VertexID); }
