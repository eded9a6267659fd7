#version 450
// The cells that each triangle may cover; see bundle_cells.glsl. header.y: triangles; `count`:
// triangles that a list may have, before it is said to be crowded.
layout(local_size_x = 64) in;
#include "bundle_cells.glsl"
layout(std430, binding = 0) readonly buffer triangles_buffer { gather_triangle triangles[]; };
// Three vec4s each: (a.x, a.y, b.x, b.y), (c.x, c.y, a.z, b.z), (c.z, its alpha, 0, 0).
layout(std430, binding = 1) writeonly buffer corners_buffer { vec4 corners[]; };
// Which of 5 x 5 cells, as bits; the number of the first of these cells; cells in a row.
layout(std430, binding = 2) writeonly buffer covers_buffer { uvec4 covers[]; };
layout(std430, binding = 3) buffer counts_buffer { uint counts[]; }; // one zero first
layout(std430, binding = 4) writeonly buffer crowded_buffer { uint crowded[]; };

struct cell_edge {
    vec2 inward; // how the edge function grows with a cell to the right, and upwards
    float least; // its greatest value in the first cell, and what roundings may add
};

// Places are in cells, from the lower left of the first one on. A triangle of nearly no area has
// edges that say nothing.
cell_edge edge_between(vec2 from, vec2 to, float turn) {
    precise vec2 inward = turn * vec2(from.y - to.y, to.x - from.x);
    precise float at = inward.x * from.x + inward.y * from.y;
    precise float reach = max(inward.x, 0.0) + max(inward.y, 0.0);
    precise float doubt = 2e-3 * (abs(inward.x) + abs(inward.y)) + 1e-5;
    return cell_edge(inward, (reach - at) + doubt);
}

bool may_reach(cell_edge edge, vec2 cell) {
    precise float value = edge.least + (edge.inward.x * cell.x + edge.inward.y * cell.y);
    return !(value < 0.0);
}

float turn_of(vec2 a, vec2 b, vec2 c) {
    precise vec2 ab = b - a;
    precise vec2 ac = c - a;
    precise float area = ab.x * ac.y - ab.y * ac.x;
    float doubt = 1e-2 * (abs(ab.x) + abs(ab.y) + abs(ac.x) + abs(ac.y)) + 1e-4;
    return abs(area) > doubt ? sign(area) : 0.0;
}

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= skybark_header.y) {
        return;
    }
    gather_triangle t = triangles[i];
    vec3 a = across_bundle(bundle, t.a);
    vec3 b = across_bundle(bundle, t.b);
    vec3 c = across_bundle(bundle, t.c);
    corners[3u * i] = vec4(a.x, a.y, b.x, b.y);
    corners[3u * i + 1u] = vec4(c.x, c.y, a.z, b.z);
    corners[3u * i + 2u] = vec4(c.z, uintBitsToFloat(t.alpha), 0.0, 0.0);
    vec2 low = min(a.xy, min(b.xy, c.xy));
    vec2 high = max(a.xy, max(b.xy, c.xy));
    float extent = max(high.x - low.x, high.y - low.y) * bundle.up.w;
    bundle_grid grid = finest_grid();
    while (has_coarser(grid) && !(extent * grid.share <= widest)) {
        grid = coarser(grid);
    }
    int side = int(grid.side);
    vec2 low_cells = in_cells(grid, low) - margin;
    vec2 high_cells = in_cells(grid, high) + margin;
    ivec2 begin = ivec2(cell_within(low_cells.x, side), cell_within(low_cells.y, side));
    ivec2 end = ivec2(cell_within(high_cells.x, side), cell_within(high_cells.y, side));
    vec2 a_cells = in_cells(grid, a.xy) - vec2(begin);
    vec2 b_cells = in_cells(grid, b.xy) - vec2(begin);
    vec2 c_cells = in_cells(grid, c.xy) - vec2(begin);
    float turn = turn_of(a_cells, b_cells, c_cells);
    cell_edge ab = edge_between(a_cells, b_cells, turn);
    cell_edge bc = edge_between(b_cells, c_cells, turn);
    cell_edge ca = edge_between(c_cells, a_cells, turn);
    uint base = grid.first + uint(begin.y * side + begin.x);
    ivec2 reach = min(end - begin, most_across - 1);
    ivec2 at = ivec2(0);
    uint cells = 0u;
    bool crowds = false;
    do {
        vec2 cell = vec2(at);
        if (may_reach(ab, cell) && may_reach(bc, cell) && may_reach(ca, cell)) {
            cells |= 1u << uint(at.y * most_across + at.x);
            uint before = atomicAdd(counts[base + uint(at.y * side + at.x) + 1u], 1u);
            crowds = crowds || before >= count;
        }
        at = at.x < reach.x ? ivec2(at.x + 1, at.y) : ivec2(0, at.y + 1);
    } while (at.y <= reach.y);
    covers[i] = uvec4(cells, base, uint(side), 0u);
    if (crowds) {
        crowded[0] = 0xffffffffu;
    }
}
