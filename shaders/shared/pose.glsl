// Where what a segment carries is now: points, directions and orientations at rest, moved along.
#include "records.glsl"
#include "quaternion.glsl"

// The product: first b's rotation, then a's.
vec4 quaternion_times(vec4 a, vec4 b) {
    return vec4(a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
                a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z);
}

// How far a rotation moves a vector: q v q* - v, which rounds in proportion to the rotation.
vec3 quaternion_move(vec4 q, vec3 v) {
    vec3 t = vec3(2.0f * (q.y * v.z - q.z * v.y), 2.0f * (q.z * v.x - q.x * v.z),
                  2.0f * (q.x * v.y - q.y * v.x));
    return vec3(q.w * t.x + (q.y * t.z - q.z * t.y), q.w * t.y + (q.z * t.x - q.x * t.z),
                q.w * t.z + (q.x * t.y - q.y * t.x));
}

vec3 quaternion_rotate(vec4 q, vec3 v) { return v + quaternion_move(q, v); }

vec3 posed_point(segment_pose p, vec3 x) {
    return x + (p.shift + quaternion_move(p.rotation, x - p.base));
}

// The end of a branch on the move. Where nothing has turned, its bits are those at rest.
branch_end posed_end(branch_end rest, segment_pose moved, vec4 turned, vec4 other) {
    branch_end now = rest;
    now.position = posed_point(moved, rest.position);
    vec4 turn = slerp(turned, other, 0.5f);
    now.orientation = quaternion_times(turn, rest.orientation);
    return now;
}
