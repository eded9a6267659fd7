// Device side of skybark::kernels::bark.
#define KERNEL_PARAMETERS                                                                          \
    uint indexed; uint base_vertex; uint width; uint height; float repeats_around;                 \
    float repeats_along; float relief; float threshold; float steepest; float rounding;                \
    uint levels;
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

struct triangle {
    surface_vertex a;
    surface_vertex b;
    surface_vertex c;
};

triangle triangle_at(uint i) {
    triangle t;
    t.a = surface_at(corner_index(i, 0u));
    t.b = surface_at(corner_index(i, 1u));
    t.c = surface_at(corner_index(i, 2u));
    return t;
}

uint pattern_of(triangle t) {
    return bark_pattern(t.a.position, t.b.position, t.c.position, threshold);
}

float height_at(float u, float v) {
    bark_texels t = bark_texels_at(u * repeats_around, v * repeats_along, width, height);
    return bark_between(t, heights[t.row0 + t.x0], heights[t.row0 + t.x1], heights[t.row1 + t.x0],
                        heights[t.row1 + t.x1]);
}

surface_vertex midpoint(surface_vertex p, surface_vertex q) {
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

surface_vertex corner_of(triangle t, uint corner) {
    surface_vertex s = t.a;
    if (corner == 1u) {
        s = t.b;
    } else if (corner == 2u) {
        s = t.c;
    }
    return s;
}

// Corner or midpoint 0 ... 5 of the triangle.
surface_vertex point_of(triangle t, uint code) {
    if (code < 3u) {
        return corner_of(t, code);
    }
    return midpoint(corner_of(t, code - 3u), corner_of(t, code == 5u ? 0u : code - 2u));
}

// Whether a child lies at the second diagonal, because that is the shorter one.
bool takes_other_diagonal(triangle t, uint pattern, uint child) {
    if (!bark_has_two(pattern) || child == 0u) {
        return false;
    }
    // Ends of the one and of the other: the two corners that triangles 1 and 2 of it share.
    vec3 ends[4];
    for (uint end = 0u; end < 4u; ++end) {
        uint corner = (end & 1u) != 0u ? 2u : (end == 0u ? 1u : 0u);
        ends[end] = point_of(t, bark_corner(pattern, end >= 2u, 1u, corner)).position;
    }
    return bark_edge_square(ends[2], ends[3]) < bark_edge_square(ends[0], ends[1]);
}

triangle child_of(triangle t, uint pattern, uint child) {
    bool other = takes_other_diagonal(t, pattern, child);
    triangle made = t;
    for (uint corner = 0u; corner < 3u; ++corner) {
        surface_vertex s = point_of(t, bark_corner(pattern, other, child, corner));
        if (corner == 0u) {
            made.a = s;
        } else if (corner == 1u) {
            made.b = s;
        } else {
            made.c = s;
        }
    }
    return made;
}

bool descended; // whether the path that descend followed is there

// Follows the first steps of a strip's path, one a level.
triangle descend(triangle t, uint strip, uint steps) {
    descended = true;
    for (uint step = 0u; step < steps && descended; ++step) {
        uint child = (strip >> (2u * (levels - 1u - step))) & 3u;
        uint pattern = pattern_of(t);
        descended = child < bark_triangles(pattern);
        if (descended && pattern != 0u) {
            t = child_of(t, pattern, child);
        }
    }
    return t;
}

uint kernel_strips() { return 1u << (2u * levels); }
uint kernel_strip_triangles() { return 1u; }

uint kernel_triangles(uint i, uint strip) {
    triangle t = descend(triangle_at(i), strip, levels - 1u);
    return descended && (strip & 3u) < bark_triangles(pattern_of(t)) ? 1u : 0u;
}

void kernel_strip(uint i, uint strip, uint first, uint count) {
    triangle t = descend(triangle_at(i), strip, levels);
    for (uint j = first; j < first + count; ++j) {
        surface_vertex s = corner_of(t, j);
        vertex_out[0] = vec4(s.position, s.u);
        vertex_out[1] = vec4(s.normal, s.v);
        vertex_out[2] = s.tangent;
        emit_vertex();
    }
}
