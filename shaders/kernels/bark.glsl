// Device side of skybark::kernels::bark.
#define KERNEL_PARAMETERS                                                                          \
    uint indexed; uint base_vertex; uint width; uint height; float repeats_around;                 \
    float repeats_along; float relief; float threshold; float steepest; float rounding;
#define VERTEX_VEC4S 3
#include "../skeletons/parameters.glsl"
#include "../shared/bark.glsl"
layout(std430, binding = 0) readonly buffer vertices_buffer { vec4 vertices[]; };
layout(std430, binding = 1) readonly buffer indices_buffer { uint indices[]; };
layout(std430, binding = 2) readonly buffer heights_buffer { float heights[]; };

uint corner_index(uint i, uint corner) {
    return indexed != 0u ? base_vertex + indices[3u * i + corner] : 3u * i + corner;
}

surface_vertex surface_at(uint index) {
    surface_vertex s;
    vec4 first = vertices[3u * index];
    vec4 second = vertices[3u * index + 1u];
    s.position = first.xyz;
    s.u = first.w;
    s.normal = second.xyz;
    s.v = second.w;
    s.tangent = vertices[3u * index + 2u];
    return s;
}

uint pattern_of(uvec3 corners) {
    return bark_pattern(vertices[3u * corners.x].xyz, vertices[3u * corners.y].xyz,
                        vertices[3u * corners.z].xyz, threshold);
}

float height_at(float u, float v) {
    bark_texels t = bark_texels_at(u * repeats_around, v * repeats_along, width, height);
    return bark_between(t, heights[t.row0 + t.x0], heights[t.row0 + t.x1], heights[t.row1 + t.x0],
                        heights[t.row1 + t.x1]);
}

surface_vertex midpoint(uint index_a, uint index_b) {
    surface_vertex p = surface_at(index_a);
    surface_vertex q = surface_at(index_b);
    surface_vertex a = p;
    surface_vertex b = q;
    if (!bark_in_order(p.position, q.position)) {
        a = q;
        b = p;
    }
    surface_vertex m = bark_middle(a, b);
    if (m.tangent.w == 0.0) {
        return m;
    }
    float rise = bark_rise(sqrt(bark_edge_square(a.position, b.position)), height_at(a.u, a.v),
                           height_at(b.u, b.v), height_at(m.u, m.v), relief, steepest);
    return bark_raised(m, a, b, rise, rounding);
}

// Corner or midpoint 0 ... 5 of the triangle.
surface_vertex point_of(uvec3 corners, uint code) {
    if (code < 3u) {
        return surface_at(corners[code]);
    }
    return midpoint(corners[code - 3u], corners[code == 5u ? 0u : code - 2u]);
}

// Whether the second diagonal is the shorter one.
bool other_diagonal(uvec3 corners, uint pattern) {
    float squares[2];
    for (uint d = 0u; d < 2u; ++d) {
        // The two corners that only triangle 1 and triangle 2 of this diagonal share.
        uint from = bark_corner(pattern, d != 0u, 1u, d == 0u ? 1u : 0u);
        uint to = bark_corner(pattern, d != 0u, 1u, 2u);
        squares[d] = bark_edge_square(point_of(corners, from).position,
                                      point_of(corners, to).position);
    }
    return squares[1] < squares[0];
}

uint kernel_strips() { return 4u; }
uint kernel_strip_triangles() { return 1u; }

uint kernel_triangles(uint i, uint strip) {
    uvec3 corners = uvec3(corner_index(i, 0u), corner_index(i, 1u), corner_index(i, 2u));
    return strip < bark_triangles(pattern_of(corners)) ? 1u : 0u;
}

void kernel_strip(uint i, uint strip, uint first, uint count) {
    uvec3 corners = uvec3(corner_index(i, 0u), corner_index(i, 1u), corner_index(i, 2u));
    uint pattern = pattern_of(corners);
    bool other = bark_has_two(pattern) && strip != 0u && other_diagonal(corners, pattern);
    for (uint j = first; j < first + count; ++j) {
        surface_vertex s = point_of(corners, bark_corner(pattern, other, strip, j));
        vertex_out[0] = vec4(s.position, s.u);
        vertex_out[1] = vec4(s.normal, s.v);
        vertex_out[2] = s.tangent;
        emit_vertex();
    }
}
