// Device side of skybark::kernels::branch_tip.
#define KERNEL_PARAMETERS uint sides;
#include "../skeletons/parameters.glsl"
#include "../shared/join.glsl"
layout(std430, binding = 0) readonly buffer tips_buffer { uint tips[]; };
layout(std430, binding = 1) readonly buffer ends_buffer { branch_end ends[]; };
layout(std430, binding = 2) readonly buffer corners_buffer { vec4 corners[]; };
layout(std430, binding = 3) writeonly buffer vertices_buffer { vec4 vertices[]; };

void kernel_map(uint i) {
    uint tip = tips[i / sides];
    surface_vertex s = tip_vertex(ends[tip / 2u], corners[i % sides], sides, (tip & 1u) != 0u);
    vertices[3u * i] = vec4(s.position, s.u);
    vertices[3u * i + 1u] = vec4(s.normal, s.v);
    vertices[3u * i + 2u] = s.tangent;
}
