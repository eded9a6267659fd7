// Device side of skybark::kernels::branch_tip.
#define KERNEL_PARAMETERS uint sides;
#include "../skeletons/parameters.glsl"
#include "../shared/join.glsl"
layout(std430, binding = 0) readonly buffer tips_buffer { uint tips[]; };
layout(std430, binding = 1) readonly buffer ends_buffer { branch_end ends[]; };
layout(std430, binding = 2) readonly buffer corners_buffer { vec4 corners[]; };
layout(std430, binding = 3) writeonly buffer vertices_buffer { vec4 vertices[]; };

void kernel_map(uint i) {
    bool base = (tips[i] & 1u) != 0u;
    branch_ring ring = branch_ring_at_end(ends[tips[i] / 2u]);
    for (uint c = 0u; c < sides; ++c) {
        surface_vertex s = tip_vertex(ring, corners[c], corners[c + 1u], base);
        uint at = 3u * (i * sides + c);
        vertices[at] = vec4(s.position, s.u);
        vertices[at + 1u] = vec4(s.normal, s.v);
        vertices[at + 2u] = s.tangent;
    }
}
