// Triangles go to their cells; see resolve.glsl. Where a cell begins moves on to where it ends,
// which is where the next one begins.
layout(local_size_x = 64) in;
#include "resolve.glsl"
#include "resolve_cells.glsl"
layout(binding = SKYBARK_IMAGE_BINDING) uniform usamplerBuffer corners;
layout(std430, binding = 4) buffer starts_buffer { uint starts[]; };
layout(std430, binding = 7) writeonly buffer entries_buffer { uint entries[]; };

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= triangle_count) {
        return;
    }
    vec4 p = uintBitsToFloat(texelFetch(corners, int(3u * i)));
    vec4 q = uintBitsToFloat(texelFetch(corners, int(3u * i + 1u)));
    cell_box box = cells_of(p.xy, p.zw, q.xy);
    ivec2 step = ivec2(1 << box.level);
    for (int y = box.low.y >> box.level; y <= box.high.y >> box.level; ++y) {
        for (int x = box.low.x >> box.level; x <= box.high.x >> box.level; ++x) {
            if (may_meet(box, ivec2(x, y), p.xy, p.zw, q.xy)) {
                uint cell = cell_number(ivec2(x, y) * step, box.level);
                entries[atomicAdd(starts[cell + 1u], 1u)] = i;
            }
        }
    }
}
