// Device side of skybark::kernels::leaf_blade.
#define KERNEL_PARAMETERS vec4 camera; uint time; float flutter; float flutter_speed; float lean; \
    float lean_speed; float full; float quad; uint pose_step; uint air_step;
#define VERTEX_VEC4S 3
#include "../skeletons/parameters.glsl"
#include "../shared/leaf.glsl"
layout(std430, binding = 0) readonly buffer leaves_buffer { uvec4 leaves[]; };
layout(std430, binding = 1) readonly buffer poses_buffer { segment_pose poses[]; };
layout(std430, binding = 2) readonly buffer air_buffer { vec4 air[]; };

void emit_surface(surface_vertex s) {
    vertex_out[0] = vec4(s.position, s.u);
    vertex_out[1] = vec4(s.normal, s.v);
    vertex_out[2] = s.tangent;
    emit_vertex();
}

leaf_at_rest leaf_of(uint i) {
    uvec4 place = leaves[3u * i];
    uvec4 turn = leaves[3u * i + 1u];
    uvec4 more = leaves[3u * i + 2u];
    return leaf_at_rest(uintBitsToFloat(place.xyz), uintBitsToFloat(place.w), uintBitsToFloat(turn),
                        uintBitsToFloat(more.x), more.y, more.z, uintBitsToFloat(more.w));
}

leaf_detail detail_at(leaf_at_rest l, vec3 base) {
    leaf_detail all;
    all.scale = 1.0;
    all.morph = 0.0;
    vec3 d = base - camera.xyz;
    float seen = camera.w * sqrt(l.width * l.along) / max(sqrt(dot3(d, d)), 1e-6);
    return camera.w > 0.0 ? leaf_detail_of(seen, full, quad, l.seed) : all;
}

leaf_frame frame_of(leaf_at_rest l) {
    leaf_response response = leaf_response(time, flutter, flutter_speed, lean, lean_speed);
    segment_pose pose = poses[l.carrier * pose_step];
    vec3 base = posed_point(pose, l.position);
    vec4 turn = leaf_turn(l, pose, air[l.carrier * air_step], response);
    return leaf_frame_of(l, base, turn, detail_at(l, base));
}

uint kernel_ring_vertices() { return 10u; }

void kernel_ring(uint i, uint first, uint count) {
    leaf_frame f = frame_of(leaf_of(i));
    for (uint k = first; k < first + count; ++k) {
        emit_surface(leaf_vertex(f, k >= 5u, k % 5u));
    }
}

uint kernel_strips() { return 2u; }
uint kernel_strip_triangles() { return 3u; }

uint kernel_triangles(uint i, uint strip) {
    leaf_at_rest l = leaf_of(i);
    leaf_detail d = detail_at(l, posed_point(poses[l.carrier * pose_step], l.position));
    return d.scale > 0.0 ? (d.morph < 1.0 ? 3u : 1u) : 0u;
}

void kernel_strip(uint i, uint strip, uint first, uint count) {
    leaf_frame f = frame_of(leaf_of(i));
    bool quadrilateral = kernel_triangles(i, strip) == 1u;
    for (uint j = first; j < first + count; ++j) {
        emit_surface(leaf_vertex(f, strip == 1u, leaf_corner(j, strip == 1u, quadrilateral)));
    }
}
