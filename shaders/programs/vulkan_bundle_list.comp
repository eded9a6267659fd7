#version 450
// Each triangle into the lists of its cells; see bundle_cells.glsl. header.y: triangles.
layout(local_size_x = 64) in;
#include "bundle_cells.glsl"
layout(std430, binding = 0) readonly buffer corners_buffer { vec4 corners[]; };
layout(std430, binding = 1) readonly buffer covers_buffer { uvec4 covers[]; };
layout(std430, binding = 2) buffer ends_buffer { uint ends[]; };
layout(std430, binding = 3) writeonly buffer listed_buffer { uvec2 listed[]; };

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= skybark_header.y) {
        return;
    }
    uvec4 cover = covers[i];
    vec4 p = corners[3u * i];
    vec4 q = corners[3u * i + 1u];
    float cz = corners[3u * i + 2u].x;
    uint triangle = listed_triangle(i, min(q.z, min(q.w, cz)), max(q.z, max(q.w, cz)));
    bundle_grid grid = finest_grid();
    while (grid.side != cover.z) {
        grid = coarser(grid);
    }
    vec2 low = in_cells(grid, min(p.xy, min(p.zw, q.xy))) - margin;
    vec2 high = in_cells(grid, max(p.xy, max(p.zw, q.xy))) + margin;
    uint within = cover.y - grid.first;
    vec2 begin = vec2(within & (cover.z - 1u), within >> findMSB(cover.z));
    for (uint cells = cover.x; cells != 0u; cells &= cells - 1u) {
        uint bit = uint(findLSB(cells));
        uint row = bit / uint(most_across);
        uint column = bit - row * uint(most_across);
        uint place = atomicAdd(ends[cover.y + row * cover.z + column + 1u], 1u);
        listed[place] = uvec2(sides_within(low, high, begin + vec2(column, row)), triangle);
    }
}
