// Where a branch leaves another, and where it ends: the vertices that close its surface.
#include "branch.glsl"

// A vertex on the surface of a branch, bound to a triangle of its tube: (a, b, c) with weights that
// add up to 1. Such a vertex stays on the triangle whatever the pose.
struct join_point {
    uint a;
    uint b;
    uint c;
    uint child; // the vertex of the child's first ring above it
    float at_a;
    float at_b;
    float at_c;
    float turn; // added to u: whole turns about the parent
};

// The vertex that a join_point without a child is: one of the tube's own, a turn further on.
surface_vertex join_turned(join_point p, surface_vertex a) {
    a.u = a.u + p.turn;
    return a;
}

// A vertex of the loop along which the surfaces of a branch and its child meet, with the branch's
// texture coordinates. The normal is the branch's: the surface turns into the child's between this
// loop and the child's first ring. There is no one direction of growing u, so tangent.w is 0.
surface_vertex join_vertex(join_point p, surface_vertex a, surface_vertex b, surface_vertex c) {
    surface_vertex vertex;
    vertex.position = (a.position * p.at_a + b.position * p.at_b) + c.position * p.at_c;
    vertex.normal =
        unit_or((a.normal * p.at_a + b.normal * p.at_b) + c.normal * p.at_c, a.normal);
    vertex.u = ((a.u * p.at_a + b.u * p.at_b) + c.u * p.at_c) + p.turn;
    vertex.v = (a.v * p.at_a + b.v * p.at_b) + c.v * p.at_c;
    vec4 along = (a.tangent * p.at_a + b.tangent * p.at_b) + c.tangent * p.at_c;
    vec3 first = vec3(a.tangent.x, a.tangent.y, a.tangent.z);
    vec3 tangent = unit_or(vec3(along.x, along.y, along.z), first);
    vertex.tangent = vec4(tangent.x, tangent.y, tangent.z, 0.0f);
    return vertex;
}

// The same vertex with the child's texture coordinates.
surface_vertex join_vertex_of_child(surface_vertex vertex, surface_vertex child) {
    vec3 up = child.position - vertex.position;
    vertex.u = child.u;
    vertex.v = child.v - sqrt(dot3(up, up));
    vertex.tangent = vec4(child.tangent.x, child.tangent.y, child.tangent.z, 0.0f);
    return vertex;
}

// The point of the dome that closes a branch, half a radius above the ring at the tip, in the
// ring's plane at the base: as the triangle between two corners of the ring sees it.
surface_vertex tip_vertex(branch_ring ring, vec4 corner, vec4 next, bool base) {
    surface_vertex vertex;
    vec3 along = ring.x * corner.y + ring.z * corner.x;
    vertex.position = ring.centre + ring.y * (base ? 0.0f : 0.5f * ring.radius);
    vertex.normal = base ? ring.y * -1.0f : ring.y;
    vertex.u = 0.5f * (corner.z + next.z);
    vertex.v = base ? ring.path - ring.radius : ring.path + ring.radius;
    vertex.tangent = vec4(-along.x, -along.y, -along.z, 0.0f);
    return vertex;
}
