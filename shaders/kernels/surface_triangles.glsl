// Device side of skybark::kernels::surface_triangles.
#define KERNEL_PARAMETERS uint first; uint material; uint alpha; uint indexed;
#include "../skeletons/parameters.glsl"
#include "../shared/records.glsl"
layout(std430, binding = 0) readonly buffer vertices_buffer { surface_vertex vertices[]; };
layout(std430, binding = 1) readonly buffer indices_buffer { uint indices[]; };
layout(std430, binding = 2) writeonly buffer triangles_buffer { gather_triangle triangles[]; };

vec3 corner(uint at) {
    if (indexed != 0u) {
        at = indices[at];
    }
    return vertices[at].position;
}

void kernel_map(uint i) {
    gather_triangle made;
    made.a = corner(3u * i);
    made.material = material;
    made.b = corner(3u * i + 1u);
    made.alpha = alpha == 0u ? 0u : alpha + i;
    made.c = corner(3u * i + 2u);
    made.reserved = 0u;
    triangles[first + i] = made;
}
