// Triangles across the bundle, and how many each cell has; see resolve.glsl. Counts begin at 0; a
// cell's is the word after its number. levels: a bit for each grid that has triangles. Corners: two
// texels for tests, a third for what few tests need.
layout(local_size_x = 64) in;
#include "resolve.glsl"
#include "resolve_cells.glsl"
layout(std430, binding = 1) readonly buffer triangles_buffer { gather_triangle triangles[]; };
layout(std430, binding = 4) buffer counts_buffer { uint counts[]; };
layout(std430, binding = 5) buffer levels_buffer { uint levels[]; };
layout(std430, binding = 6) writeonly buffer corners_buffer { vec4 corners[]; };

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= triangle_count) {
        return;
    }
    gather_triangle t = triangles[first_triangle + i];
    vec3 a = across_bundle(bundle, t.a);
    vec3 b = across_bundle(bundle, t.b);
    vec3 c = across_bundle(bundle, t.c);
    corners[3u * i] = vec4(a.xy, b.xy);
    corners[3u * i + 1u] = vec4(c.xy, a.z, b.z);
    corners[3u * i + 2u] = vec4(c.z, uintBitsToFloat(t.alpha), 0.0, 0.0);
    cell_box box = cells_of(a.xy, b.xy, c.xy);
    ivec2 step = ivec2(1 << box.level);
    for (int y = box.low.y >> box.level; y <= box.high.y >> box.level; ++y) {
        for (int x = box.low.x >> box.level; x <= box.high.x >> box.level; ++x) {
            if (may_meet(box, ivec2(x, y), a.xy, b.xy, c.xy)) {
                atomicAdd(counts[cell_number(ivec2(x, y) * step, box.level) + 1u], 1u);
            }
        }
    }
    if ((levels[0] >> box.level & 1u) == 0u) {
        atomicOr(levels[0], 1u << box.level);
    }
}
