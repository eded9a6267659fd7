// Device side of skybark::kernels::branch_join.
#include "../skeletons/parameters.glsl"
#include "../shared/join.glsl"
layout(std430, binding = 0) readonly buffer points_buffer { join_point points[]; };
layout(std430, binding = 1) readonly buffer tubes_buffer { vec4 tubes[]; };
layout(std430, binding = 2) writeonly buffer vertices_buffer { vec4 vertices[]; };

surface_vertex tube_vertex(uint i) {
    surface_vertex s;
    vec4 first = tubes[3u * i];
    vec4 second = tubes[3u * i + 1u];
    s.position = first.xyz;
    s.u = first.w;
    s.normal = second.xyz;
    s.v = second.w;
    s.tangent = tubes[3u * i + 2u];
    return s;
}

void set_vertex(uint i, surface_vertex s) {
    vertices[3u * i] = vec4(s.position, s.u);
    vertices[3u * i + 1u] = vec4(s.normal, s.v);
    vertices[3u * i + 2u] = s.tangent;
}

void kernel_map(uint i) {
    join_point p = points[i];
    surface_vertex a = tube_vertex(p.a);
    if (p.child == 0xffffffffu) {
        set_vertex(2u * i, join_turned(p, a));
        return;
    }
    surface_vertex s = join_vertex(p, a, tube_vertex(p.b), tube_vertex(p.c));
    set_vertex(2u * i, s);
    set_vertex(2u * i + 1u, join_vertex_of_child(s, tube_vertex(p.child)));
}
