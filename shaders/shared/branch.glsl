// One ring of a branch's surface, and the vertices on it (Akagi and Kitajima, 2.2 and 3.3).
#include "records.glsl"
#include "quaternion.glsl"
#include "hermite.glsl"
#include "frames.glsl"

// A ring: its centre, its axes (y along the growth) and what is linear along the segment. Where
// the radius changes by `slope` along the growth, the normals lean: outwards by `lean`, which is
// 1 / sqrt(1 + slope^2), and against the growth by `tilt`, y * slope * lean.
struct branch_ring {
    vec3 centre;
    float radius;
    vec3 x;
    float path;
    vec3 y;
    float lean;
    vec3 z;
    vec3 tilt;
};

branch_ring branch_ring_leaning(branch_ring r, float slope) {
    r.lean = 1.0f / sqrt(1.0f + slope * slope);
    r.tilt = r.y * (slope * r.lean);
    return r;
}

// What all rings of a segment share.
struct branch_curve {
    vec3 p1;
    vec3 n1;
    vec3 p2;
    vec3 n2;
    slerp_arc arc;
};

// The tangents are the ends' directions times the length of this segment's own chord: with a
// neighbour's length, short segments beside long ones fold.
branch_curve branch_curve_between(branch_end a, branch_end b) {
    branch_curve c;
    vec3 chord = b.position - a.position;
    float l = sqrt(dot3(chord, chord));
    c.p1 = a.position;
    c.p2 = b.position;
    c.n1 = quaternion_y(a.orientation) * l;
    c.n2 = quaternion_y(b.orientation) * l;
    c.arc = slerp_begin(a.orientation, b.orientation);
    return c;
}

// The ring at t with the orientation interpolated by slerp. At t = 0 and t = 1 it depends on that
// end alone, bit for bit, so neighbours meet without a gap.
branch_ring branch_ring_slerp(branch_end a, branch_end b, branch_curve c, float t) {
    branch_ring r;
    vec4 q = slerp_at(c.arc, t);
    float l2 = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    q = q * (1.0f / sqrt(l2));
    r.centre = hermite_point(c.p1, c.n1, c.p2, c.n2, t);
    r.radius = a.radius * (1.0f - t) + b.radius * t;
    r.path = a.path * (1.0f - t) + b.path * t;
    r.x = quaternion_x(q);
    r.y = quaternion_y(q);
    r.z = quaternion_z(q);
    return branch_ring_leaning(r, a.slope * (1.0f - t) + b.slope * t);
}

// The unit direction of the centreline at ring k of `last`, or the start's own where it has none.
vec3 branch_direction(branch_end a, branch_curve c, uint k, uint last) {
    float t = float(k) / float(last);
    return unit_or(hermite_derivative(c.p1, c.n1, c.p2, c.n2, t), quaternion_y(a.orientation));
}

// Ring k of 0 ... last with a rotation-minimising frame: the start's x axis is carried along by
// double reflection, and the twist that is left at the end against the end's own frame is spread
// evenly over the segment. First and last ring are the ends' own, as with slerp.
branch_ring branch_ring_rotation_minimising(branch_end a, branch_end b, branch_curve c, uint k,
                                            uint last) {
    branch_ring r = branch_ring_slerp(a, b, c, float(k) / float(last));
    if (k == 0u || k == last) {
        return r;
    }
    // From the start on, so that a place far from the origin doesn't round short steps away.
    vec3 chord = c.p2 - c.p1;
    vec3 x = quaternion_x(a.orientation);
    vec3 x_here = x;
    vec3 p = vec3(0.0f, 0.0f, 0.0f);
    vec3 d = branch_direction(a, c, 0u, last);
    vec3 d_here = d;
    for (uint i = 1u; i <= last; ++i) {
        vec3 p_next = hermite_point(vec3(0.0f, 0.0f, 0.0f), c.n1, chord, c.n2, float(i) / float(last));
        vec3 d_next = branch_direction(a, c, i, last);
        x = double_reflection(p, d, x, p_next, d_next);
        p = p_next;
        d = d_next;
        if (i == k) {
            x_here = x;
            d_here = d;
        }
    }
    vec3 x_end = quaternion_x(b.orientation);
    float twist = atan(dot3(cross3(x, x_end), d), dot3(x, x_end));
    float angle = twist * float(k) / float(last);
    vec3 side = cross3(d_here, x_here);
    vec3 turned = x_here * cos(angle) + side * sin(angle);
    // Back to an exact frame: reflections keep lengths and angles only up to rounding.
    r.y = d_here;
    r.x = unit_or(turned - d_here * dot3(turned, d_here), r.x);
    r.z = cross3(r.x, r.y);
    return branch_ring_leaning(r, a.slope * (1.0f - float(k) / float(last)) +
                                      b.slope * (float(k) / float(last)));
}

// The vertex of a ring at a point (cos, sin, u, -) of the unit polygon. Seen from the tip the
// polygon runs counter-clockwise: x cos - z sin. The normal leans with the taper.
surface_vertex branch_vertex(branch_ring r, vec4 corner) {
    surface_vertex vertex;
    vec3 outward = r.x * corner.x - r.z * corner.y;
    vec3 along = r.x * corner.y + r.z * corner.x;
    vertex.position = r.centre + outward * r.radius;
    vertex.u = corner.z;
    vertex.normal = outward * r.lean - r.tilt;
    vertex.v = r.path;
    vertex.tangent = vec4(-along.x, -along.y, -along.z, 1.0f);
    return vertex;
}

// The ring at an end, where a cap closes it.
branch_ring branch_ring_at_end(branch_end e) {
    branch_ring r;
    float l2 = e.orientation.x * e.orientation.x + e.orientation.y * e.orientation.y +
               e.orientation.z * e.orientation.z + e.orientation.w * e.orientation.w;
    vec4 q = e.orientation * (1.0f / sqrt(l2));
    r.centre = e.position;
    r.radius = e.radius;
    r.path = e.path;
    r.x = quaternion_x(q);
    r.y = quaternion_y(q);
    r.z = quaternion_z(q);
    return branch_ring_leaning(r, 0.0f);
}

// The corner of the polygon that vertex i of a cap's strip is: 0, 1, n-1, 2, n-2, ... counter-
// clockwise seen from the tip, and mirrored for the cap at the base.
uint branch_cap_corner(uint i, uint sides, bool base) {
    uint corner = i == 0u ? 0u : ((i & 1u) == 1u ? (i + 1u) / 2u : sides - i / 2u);
    return base && corner != 0u ? sides - corner : corner;
}

// A vertex of a cap: on the ring of the branch, with the normal along the axis.
surface_vertex branch_cap_vertex(branch_ring r, vec4 corner, bool base) {
    surface_vertex vertex = branch_vertex(r, corner);
    vertex.normal = base ? r.y * -1.0f : r.y;
    vertex.u = 0.5f + 0.5f * corner.x;
    vertex.v = r.path + r.radius * corner.y;
    vertex.tangent = vec4(r.x.x, r.x.y, r.x.z, base ? -1.0f : 1.0f);
    return vertex;
}
