// clang-format off
// Made by shaders/embed.py. Edit the text in shaders/ instead.
// sha256 b77d6a7320ece7a20fcc93b5dd8df5df85858fb90823dd0a7804375bc7af017d
#pragma once

#include <skybark/shared/glsl.hpp>
#include <skybark/shared/branch.hpp>

namespace skybark::shared {

// Level of detail of branches: how many sides, rings and branches are worth drawing from far off.
// All of it is continuous: what is about to be left out first moves to where its absence leaves
// the surface. Only + - * / and sqrt, so that every backend gets the same bits.

// How much of an end is to be seen.
struct end_detail {
    float sides;    // of its ring; not whole where every other corner is on its way to the chord
    float scale;    // of the radius: 0 where the chain isn't drawn, above 1 where it stands for others
    float distance; // m, from the camera
    float errors;   // the scaled radius, in permitted errors
};

// What a segment is made of.
struct segment_detail {
    uint sides;     // corners of its rings, the finer end's; 0: not drawn
    uint gaps;      // between rings
    float fraction; // how far the newest rings have come from the chord to the curve
    uint caps;
};

// When a chain is left out, the same at all its ends: from `rank` 1 down to 0, as long as at least
// two thirds of `least` of the chains like it stay.
struct chain_share {
    float rank;
    float least;
    uint chain; // of those that lie here
    uint place; // in the chain, from 0
};

// Ends in a row, each joined to the next, and how long the pieces are that they are drawn in: every
// `stride`-th end is there, and the last. Every other of these may be on its way to the curve
// between its neighbours.
struct chain_detail {
    uint last;      // index of an end
    uint caps;      // of the last segment
    uint stride;    // a power of two
    float fraction; // how far the ends that are on their way have still to go: 1 at their own places
};

// 1 - cos(pi / n): how far the sides of a polygon stay inside its circle.
inline float versine(uint n) {
    float s = sin_quarter(1.57079633f / float(n));
    return 2.0f * (s * s);
}

// The fewest sides that keep a circle within an error, for its radius over that error. Between n
// and 2n the new corners rise from the chord. They reach the circle when the chord's distance is
// worth two errors, so the outline is never off by more than one.
inline float detailed_sides(float errors, uint least, uint most) {
    uint n = least;
    while (n < most) {
        float off = errors * versine(n);
        if (off <= 1.0f) {
            return float(n);
        }
        if (off < 2.0f) {
            return float(n) * off;
        }
        n = n * 2u;
    }
    return float(most);
}

// The corners of a polygon of so many sides, the new ones included: the next least * 2^k.
inline uint corner_count(float sides, uint least, uint most) {
    uint n = least;
    while (n < most && float(n) < sides) {
        n = n * 2u;
    }
    return n;
}

// How far from the centre the new ones among `count` corners are: 1 - versine(count / 2) on the
// chord, 1 on the circle.
inline float new_corner_distance(float sides, uint count) {
    float risen = sides / float(count / 2u) - 1.0f;
    return 1.0f - (1.0f - risen) * versine(count / 2u);
}

// What to multiply a radius with for a polygon of fewer sides to look as wide as one of `most`:
// its mean width over all directions is its perimeter over pi (Cauchy).
inline float width_kept(float sides, uint least, uint most) {
    if (!(sides < float(most))) {
        return 1.0f;
    }
    uint count = corner_count(sides, least, most);
    float side = 2.0f * sin_quarter(3.14159265f / float(count));
    if (count > least) {
        float d = new_corner_distance(sides, count);
        side = sqrt((1.0f - d) * (1.0f - d) + 2.0f * d * versine(count / 2u));
    }
    return float(most) * (2.0f * sin_quarter(3.14159265f / float(most))) / (float(count) * side);
}

// Stochastic simplification (Cook, Halstead, Planck and Ryu 2007): chains of ranks above 4/3 of
// `cut` are left out, those below 2/3 of it stay, and the ones between shrink. All are widened by
// one over the fraction that stays, so that the area is kept on average. From a cut of 3/2 on,
// nothing is left out.
inline float kept_scale(float cut, float rank) {
    if (!(cut < 1.5f)) {
        return 1.0f;
    }
    float top = cut * 1.33333333f;
    // The mean of the ramp over all ranks from 0 to 1.
    float over = max(top - 1.0f, 0.0f);
    float kept = cut - over * over / top;
    return clamp(2.0f - 2.0f * rank / top, 0.0f, 1.0f) / kept;
}

// The detail of an end, for so many pixels a radian. Without a permitted error it is all there is;
// without a `thin` radius (pixels) no chain is left out.
inline end_detail detail_of_end(branch_end e, chain_share share, vec4 camera, float error, float thin,
                         uint least, uint most) {
    end_detail d;
    vec3 away = e.position - vec3(camera.x, camera.y, camera.z);
    d.distance = sqrt(dot3(away, away));
    float pixels = e.radius * camera.w / max(d.distance, 1e-6f);
    d.scale = 1.0f;
    if (thin > 0.0f) {
        d.scale = kept_scale(max(pixels / thin, share.least), share.rank);
    }
    d.errors = error > 0.0f ? pixels * d.scale / error : 1e30f;
    d.sides = detailed_sides(d.errors, least, most);
    d.scale = d.scale * width_kept(d.sides, least, most);
    return d;
}

// How far a segment's surface lies from the straight one between its end rings, at most, in m. Of
// n even gaps, each is off by at most 1 / n^2 of it: a chord's distance is the second derivative
// over 8, and that of a cubic is largest at an end. The same for radii that turn.
inline float segment_bend(branch_end a, branch_end b) {
    vec3 chord = b.position - a.position;
    float l = sqrt(dot3(chord, chord));
    vec3 e1 = quaternion_y(a.orientation) * l - chord;
    vec3 e2 = quaternion_y(b.orientation) * l - chord;
    vec3 at_start = e1 * 2.0f + e2;
    vec3 at_end = e2 * 2.0f + e1;
    float curve = 0.25f * sqrt(max(dot3(at_start, at_start), dot3(at_end, at_end)));
    float cosine = a.orientation.x * b.orientation.x + a.orientation.y * b.orientation.y +
                   a.orientation.z * b.orientation.z + a.orientation.w * b.orientation.w;
    vec4 d = b.orientation * (cosine < 0.0f ? -1.0f : 1.0f) - a.orientation;
    // |d| is 2 sin(x / 2) where the rings turn by 2 x, x up to pi / 2: x <= 1.1108 |d|.
    float d2 = d.x * d.x + d.y * d.y + d.z * d.z + d.w * d.w;
    float radius = max(a.radius, b.radius);
    return curve + 0.6169f * radius * d2 + 0.5554f * abs(a.radius - b.radius) * sqrt(d2);
}

inline uint least_factor(uint n) {
    uint p = 2u;
    while (p * p <= n) {
        if (n % p == 0u) {
            return p;
        }
        p = p + 1u;
    }
    return n;
}

// The end that a curve from a to b would have where `own` is.
inline branch_end end_between(branch_end a, branch_end b, branch_end own) {
    float l = b.path - a.path;
    float t = l > 0.0f ? clamp((own.path - a.path) / l, 0.0f, 1.0f) : 0.5f;
    branch_curve c = branch_curve_between(a, b);
    branch_end e = own;
    e.position = hermite_point(c.p1, c.n1, c.p2, c.n2, t);
    e.radius = a.radius * (1.0f - t) + b.radius * t;
    e.orientation = slerp(a.orientation, b.orientation, t);
    e.slope = a.slope * (1.0f - t) + b.slope * t;
    return e;
}

// How far an end's ring would move to that place, and its slope turn the normals.
inline float way_between(branch_end a, branch_end b, branch_end own) {
    branch_end e = end_between(a, b, own);
    vec3 way = e.position - own.position;
    return sqrt(dot3(way, way)) + abs(e.radius - own.radius) +
           own.radius * abs(e.slope - own.slope);
}

// An end on its way there.
inline branch_end end_on_its_way(branch_end a, branch_end b, branch_end own, float fraction) {
    branch_end e = end_between(a, b, own);
    e.position = e.position * (1.0f - fraction) + own.position * fraction;
    e.radius = e.radius * (1.0f - fraction) + own.radius * fraction;
    e.orientation = slerp(e.orientation, own.orientation, fraction);
    e.slope = e.slope * (1.0f - fraction) + own.slope * fraction;
    return e;
}

// The segment that is drawn where `s` is: up to the next end that is there.
inline branch_segment merged_segment(branch_segment s, chain_detail chain) {
    branch_segment m = s;
    m.end = min(s.start + chain.stride, chain.last);
    m.caps = (s.caps & 1u) | (m.end == chain.last ? chain.caps & 2u : 0u);
    return m;
}
inline bool is_merged_away(chain_share start, chain_detail chain) {
    return start.place % chain.stride != 0u;
}

// What a segment is made of, for ends whose radii have been scaled.
inline segment_detail detail_of_segment(branch_segment s, branch_end a, branch_end b, end_detail da,
                                 end_detail db, float pixels_per_radian, float error, uint least,
                                 uint most, uint gaps) {
    segment_detail d;
    d.sides = corner_count(max(da.sides, db.sides), least, most);
    d.gaps = gaps;
    d.fraction = 1.0f;
    d.caps = s.caps;
    bool whole = da.scale == 1.0f && db.scale == 1.0f;
    if (!whole && a.radius == 0.0f && b.radius == 0.0f) {
        d.sides = 0u;
        d.caps = 0u;
    }
    if (!(error > 0.0f)) {
        return d;
    }
    // A cap within one error of its rim's middle would not be missed.
    if ((d.caps & 1u) != 0u && da.errors <= 1.0f) {
        d.caps = d.caps - 1u;
    }
    if ((d.caps & 2u) != 0u && db.errors <= 1.0f) {
        d.caps = d.caps - 2u;
    }
    vec3 chord = b.position - a.position;
    float half_length = 0.5f * sqrt(dot3(chord, chord));
    float nearest = max(min(da.distance, db.distance) - half_length, 1e-6f);
    float bend = segment_bend(a, b) * pixels_per_radian / (nearest * error);
    while (d.gaps > 1u) {
        uint coarse = d.gaps / least_factor(d.gaps);
        float off = bend / (float(coarse) * float(coarse));
        if (!(off < 2.0f)) {
            return d;
        }
        if (off > 1.0f) {
            d.fraction = off - 1.0f;
            return d;
        }
        d.gaps = coarse;
    }
    return d;
}

// The corners of a ring of fewer sides: every `step`-th of the full polygon's, with every other
// one of them at `inner` from the centre if `between` is 1.
struct ring_outline {
    uint step;
    uint between;
    float inner;
};

inline ring_outline outline_of(float sides, uint least, uint most) {
    ring_outline o;
    uint count = corner_count(sides, least, most);
    o.step = most / count;
    o.between = count > least ? 1u : 0u;
    o.inner = count > least ? new_corner_distance(sides, count) : 1.0f;
    return o;
}

// Of the full polygon's corner j: the corners of the outline before and after it.
inline uint outline_before(ring_outline o, uint j) { return j / o.step * o.step; }
inline uint outline_after(ring_outline o, uint j) { return (j + o.step - 1u) / o.step * o.step; }

// The distance from the centre of a corner that the outline has.
inline float outline_distance(ring_outline o, uint j) {
    return o.between == 1u && (j / o.step) % 2u == 1u ? o.inner : 1.0f;
}

// Corner j of the full polygon, where the outline has it; or on the chord between the two corners
// that the outline has before and after it.
inline vec2 point_of_outline(ring_outline o, uint j, vec4 before, vec4 after) {
    uint first = outline_before(o, j);
    uint last = outline_after(o, j);
    float d = outline_distance(o, first);
    vec2 p = vec2(before.x * d, before.y * d);
    if (last != first) {
        float w = float(j - first) / float(o.step);
        float e = outline_distance(o, last);
        p = p * (1.0f - w) + vec2(after.x * e, after.y * e) * w;
    }
    return p;
}

// How much of the ring r at t has the outline of the end b: radius by radius, so that it is off by
// no more than the outlines at the ends are, however thin the coarse one.
inline float outline_weight(branch_ring r, branch_end b, float t) {
    return r.radius > 0.0f ? t * b.radius / r.radius : t;
}

// Between the outlines at two ends. Equal ones give their own bits.
inline vec2 mix_outlines(vec2 a, vec2 b, float weight) {
    return a.x == b.x && a.y == b.y ? a : a * (1.0f - weight) + b * weight;
}

// branch_vertex, at a point of an outline. It looks where its corner of the full polygon does.
inline surface_vertex outline_vertex(branch_ring r, vec2 p, vec4 corner) {
    surface_vertex vertex = branch_vertex(r, corner);
    vec3 outward = r.x * p.x - r.z * p.y;
    vertex.position = r.centre + outward * r.radius;
    return vertex;
}

// branch_cap_vertex, at a point of an outline.
inline surface_vertex outline_cap_vertex(branch_ring r, vec2 p, bool base) {
    return branch_cap_vertex(r, vec4(p.x, p.y, 0.0f, 0.0f), base);
}

// A vertex on its way from the chord between two others, at w, to its own place. Texture
// coordinates are linear along the segment and agree already.
inline surface_vertex between_vertices(surface_vertex own, surface_vertex before, surface_vertex after,
                                float w, float fraction) {
    surface_vertex v = own;
    vec3 place = before.position * (1.0f - w) + after.position * w;
    vec3 facing = before.normal * (1.0f - w) + after.normal * w;
    v.position = place * (1.0f - fraction) + own.position * fraction;
    v.normal = unit_or(facing * (1.0f - fraction) + own.normal * fraction, own.normal);
    return v;
}

} // namespace skybark::shared
