// Device side of skybark::kernels::detailed_branch.
#define KERNEL_PARAMETERS uint sides; uint rings; uint frame; uint fewest_sides;
#define VERTEX_VEC4S 3
#include "../skeletons/parameters.glsl"
#include "../shared/detail.glsl"
layout(std430, binding = 0) readonly buffer segments_buffer { branch_segment segments[]; };
layout(std430, binding = 1) readonly buffer ends_buffer { branch_end ends[]; };
layout(std430, binding = 2) readonly buffer corners_buffer { vec4 corners[]; };
layout(std430, binding = 3) readonly buffer details_buffer { vec4 details[]; };
layout(std430, binding = 4) readonly buffer rings_buffer { uvec4 made_of[]; };

void emit_surface(surface_vertex s) {
    vertex_out[0] = vec4(s.position, s.u);
    vertex_out[1] = vec4(s.normal, s.v);
    vertex_out[2] = s.tangent;
    emit_vertex();
}

branch_ring ring_at(branch_end a, branch_end b, branch_curve c, uint k) {
    return frame == 0u ? branch_ring_slerp(a, b, c, float(k) / float(rings - 1u))
                       : branch_ring_rotation_minimising(a, b, c, k, rings - 1u);
}

vec2 point_at(ring_outline o, uint j) {
    return point_of_outline(o, j, corners[outline_before(o, j)], corners[outline_after(o, j)]);
}

// Strips: the cap at the start, the tube gap by gap, the cap at the end.
uint kernel_strips() { return rings + 1u; }
uint kernel_strip_triangles() { return 2u * sides; }

uint kernel_triangles(uint i, uint strip) {
    uvec4 d = made_of[i];
    if (strip == 0u) {
        return (d.w & 1u) != 0u ? d.x - 2u : 0u;
    }
    if (strip == rings) {
        return (d.w & 2u) != 0u ? d.x - 2u : 0u;
    }
    return strip <= d.y ? 2u * d.x : 0u;
}

// A ring of the segment, or where it is on its way to the chord between two others.
struct moving_ring {
    branch_ring own;
    branch_ring before;
    branch_ring after;
    float weight; // of the outline at the segment's end
    float before_weight;
    float after_weight;
    float w;
    float fraction;
};

// Ring k of those that the segment has. Of `gaps` of them, every `kept`-th was there before.
moving_ring moving_ring_at(branch_end a, branch_end b, branch_curve c, uint k, uint gaps,
                           float fraction) {
    moving_ring m;
    uint step = (rings - 1u) / gaps;
    m.own = ring_at(a, b, c, k * step);
    m.weight = outline_weight(m.own, b, float(k * step) / float(rings - 1u));
    m.fraction = 1.0;
    uint kept = least_factor(gaps);
    if (fraction < 1.0 && k % kept != 0u) {
        uint first = k / kept * kept;
        m.before = ring_at(a, b, c, first * step);
        m.after = ring_at(a, b, c, (first + kept) * step);
        m.before_weight = outline_weight(m.before, b, float(first * step) / float(rings - 1u));
        m.after_weight = outline_weight(m.after, b, float((first + kept) * step) / float(rings - 1u));
        m.w = float(k - first) / float(kept);
        m.fraction = fraction;
    }
    return m;
}

surface_vertex vertex_of(moving_ring m, vec2 p, vec2 q, vec4 corner) {
    surface_vertex v = outline_vertex(m.own, mix_outlines(p, q, m.weight), corner);
    if (m.fraction < 1.0) {
        v = between_vertices(v, outline_vertex(m.before, mix_outlines(p, q, m.before_weight), corner),
                             outline_vertex(m.after, mix_outlines(p, q, m.after_weight), corner), m.w,
                             m.fraction);
    }
    return v;
}

void kernel_strip(uint i, uint strip, uint first, uint count) {
    branch_segment segment = segments[i];
    branch_end a = ends[segment.start];
    branch_end b = ends[segment.end];
    vec4 da = details[segment.start];
    vec4 db = details[segment.end];
    uvec4 d = made_of[i];
    a.radius = a.radius * da.y;
    b.radius = b.radius * db.y;
    ring_outline outline_a = outline_of(da.x, fewest_sides, sides);
    ring_outline outline_b = outline_of(db.x, fewest_sides, sides);
    uint step = sides / d.x;
    uint last = first + count;
    if (strip == 0u || strip == rings) {
        bool base = strip == 0u;
        branch_ring r = branch_ring_at_end(base ? a : b);
        for (uint j = first; j < last; ++j) {
            uint corner = branch_cap_corner(j, d.x, base) * step;
            if (base) {
                emit_surface(outline_cap_vertex(r, point_at(outline_a, corner), true));
            } else {
                emit_surface(outline_cap_vertex(r, point_at(outline_b, corner), false));
            }
        }
        return;
    }
    branch_curve c = branch_curve_between(a, b);
    float fraction = uintBitsToFloat(d.z);
    moving_ring lower = moving_ring_at(a, b, c, strip - 1u, d.y, fraction);
    moving_ring upper = moving_ring_at(a, b, c, strip, d.y, fraction);
    for (uint j = first; j < last; ++j) {
        uint corner = j / 2u * step;
        vec2 p = point_at(outline_a, corner);
        vec2 q = point_at(outline_b, corner);
        bool above = (j & 1u) == 0u;
        moving_ring m = lower;
        if (above) {
            m = upper;
        }
        emit_surface(vertex_of(m, p, q, corners[corner]));
    }
}
