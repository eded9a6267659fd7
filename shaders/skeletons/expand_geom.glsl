// What both geometry expansions share: a point comes in, vertices go out by transform feedback.
// OpenGL counts a geometry shader's output as max_vertices times the components of a vertex, and
// stops at 1,024. The backend puts SKYBARK_MAX_VERTICES in front of the text accordingly.
#ifndef SKYBARK_MAX_VERTICES
#define SKYBARK_MAX_VERTICES 16
#endif
layout(points) in;
layout(location = 0) flat in uint skybark_point[1];
layout(xfb_buffer = 0, xfb_stride = 16 * VERTEX_VEC4S) out;
layout(location = 0, xfb_buffer = 0, xfb_offset = 0) out vec4 skybark_vertex[VERTEX_VEC4S];

void emit_vertex() {
    for (int v = 0; v < VERTEX_VEC4S; ++v) {
        skybark_vertex[v] = vertex_out[v];
    }
    EmitVertex();
}
