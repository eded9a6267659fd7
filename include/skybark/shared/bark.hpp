// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 767775db501bd9cbe758ddce2fc9d0f638dba3522ca4e27399f98d6d81b9bbb9
#pragma once

#include <skybark/shared/glsl.hpp>
#include <skybark/shared/frames.hpp>

namespace skybark::shared {

// Bark: triangles split at the midpoints of their long edges, and the midpoints moved by a height
// map (Akagi and Kitajima, 2.3 and 3.3). All that is decided or computed of an edge depends on its
// two ends alone and not on their order, so that the triangles on both sides of it agree.

inline float bark_edge_square(vec3 a, vec3 b) {
    vec3 d = b - a;
    return dot3(d, d);
}

// Which edges of a triangle are split: bit 0 for ab, bit 1 for bc, bit 2 for ca.
inline uint bark_pattern(vec3 a, vec3 b, vec3 c, float threshold) {
    float most = threshold * threshold;
    return (bark_edge_square(a, b) > most ? 1u : 0u) | (bark_edge_square(b, c) > most ? 2u : 0u) |
           (bark_edge_square(c, a) > most ? 4u : 0u);
}

inline uint bark_triangles(uint pattern) {
    return 1u + (pattern & 1u) + ((pattern >> 1u) & 1u) + (pattern >> 2u);
}

// Of two split edges: the first, in the order ab, bc, ca, ab. Of one: that one.
inline uint bark_first_edge(uint pattern) {
    return pattern == 2u || pattern == 6u ? 1u : (pattern == 4u || pattern == 5u ? 2u : 0u);
}

inline bool bark_has_two(uint pattern) { return bark_triangles(pattern) == 3u; }

// A corner of a triangle that a pattern makes: 0, 1, 2 are a, b, c, and 3, 4, 5 the midpoints of
// ab, bc, ca. Of two split edges, `other` takes the diagonal from the first edge's start to the
// second's midpoint, in place of that from the first's midpoint to the second's end.
inline uint bark_corner(uint pattern, bool other, uint triangle, uint corner) {
    uint count = bark_triangles(pattern);
    uint corners = 0x210u;
    if (count == 2u) {
        corners = triangle == 0u ? 0x230u : 0x213u;
    } else if (count == 3u) {
        corners = triangle == 0u ? 0x413u
                                 : (other ? (triangle == 1u ? 0x430u : 0x240u)
                                          : (triangle == 1u ? 0x230u : 0x243u));
    } else if (count == 4u) {
        corners = triangle == 0u ? 0x530u
                                 : (triangle == 1u ? 0x413u : (triangle == 2u ? 0x245u : 0x543u));
    }
    uint code = (corners >> (4u * corner)) & 7u;
    uint turned = (code < 3u ? code : code - 3u) + (count == 4u ? 0u : bark_first_edge(pattern));
    return (turned < 3u ? turned : turned - 3u) + (code < 3u ? 0u : 3u);
}

// Where a texture coordinate falls in a map that repeats, in texels from the first one's centre:
// 0 ... size. What is not a number falls on 0.
inline float bark_texel(float coordinate, uint size) {
    float part = coordinate - floor(coordinate);
    float x = (part >= 0.0f && part <= 1.0f ? part : 0.0f) * float(size) - 0.5f;
    return x < 0.0f ? x + float(size) : x;
}

// Four texels of a map, and where between them.
struct bark_texels {
    uint x0;
    uint x1;
    uint row0; // of the texel at x = 0
    uint row1;
    float x;
    float y;
};

inline bark_texels bark_texels_at(float around, float along, uint width, uint height) {
    float x = bark_texel(around, width);
    float y = bark_texel(along, height);
    float left = floor(x);
    float low = floor(y);
    bark_texels t;
    t.x = x - left;
    t.y = y - low;
    t.x0 = uint(left) < width ? uint(left) : 0u;
    t.x1 = t.x0 + 1u < width ? t.x0 + 1u : 0u;
    uint row = uint(low) < height ? uint(low) : 0u;
    t.row0 = row * width;
    t.row1 = (row + 1u < height ? row + 1u : 0u) * width;
    return t;
}

inline float bark_between(bark_texels t, float h00, float h10, float h01, float h11) {
    float low = h00 + (h10 - h00) * t.x;
    float high = h01 + (h11 - h01) * t.x;
    return low + (high - low) * t.y;
}

// The order in which the ends of an edge are taken, so that sums round alike from both sides.
inline bool bark_in_order(vec3 a, vec3 b) {
    return a.x != b.x ? a.x < b.x : (a.y != b.y ? a.y < b.y : a.z < b.z);
}

// The middle of the chord, with the texture coordinates, normal and tangent that it has there.
// Where an end has no texture direction (tangent.w is 0), neither has the middle.
inline surface_vertex bark_middle(surface_vertex a, surface_vertex b) {
    surface_vertex m;
    vec3 n = a.normal + b.normal;
    vec3 t = vec3(a.tangent.x + b.tangent.x, a.tangent.y + b.tangent.y, a.tangent.z + b.tangent.z);
    t = unit_or(t, t);
    bool plain = a.tangent.w == 0.0f || b.tangent.w == 0.0f;
    m.position = (a.position + b.position) * 0.5f;
    m.u = (a.u + b.u) * 0.5f;
    m.normal = unit_or(n, n);
    m.v = (a.v + b.v) * 0.5f;
    m.tangent = vec4(t.x, t.y, t.z, plain ? 0.0f : (a.tangent.w + b.tangent.w) * 0.5f);
    return m;
}

// How far a midpoint stands out of its edge, where the map's heights at the ends and there are
// h_a, h_b and h_m: what the ends' own heights do not account for, at most `steepest` of the edge.
inline float bark_rise(float length, float h_a, float h_b, float h_m, float relief, float steepest) {
    float most = steepest * length;
    float rise = relief * (h_m - 0.5f * (h_a + h_b));
    return rise > most ? most : (rise < -most ? -most : rise);
}

// The middle m of the edge from a to b, moved onto the cubic that the ends' normals ask for (the
// edge of a curved PN triangle: Vlachos, Peters, Boyd and Mitchell 2001) and out by `rise`.
inline surface_vertex bark_raised(surface_vertex m, surface_vertex a, surface_vertex b, float rise,
                           float rounding) {
    vec3 ab = b.position - a.position;
    vec3 round_a = a.normal * dot3(ab, a.normal);
    vec3 round_b = b.normal * dot3(ab, b.normal);
    m.position = m.position - (round_a - round_b) * (0.125f * rounding) + m.normal * rise;
    return m;
}

} // namespace skybark::shared
