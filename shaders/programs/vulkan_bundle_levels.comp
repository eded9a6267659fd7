#version 450
// The grids that have triangles, or one without; see bundle_cells.glsl. First how many there are,
// then of each one its cells on a side, the number of its first cell, and its share.
layout(local_size_x = 1) in;
#include "bundle_cells.glsl"
layout(std430, binding = 0) readonly buffer starts_buffer { uint starts[]; };
layout(std430, binding = 1) writeonly buffer levels_buffer { uvec4 levels[]; };

void main() {
    bundle_grid grid = finest_grid();
    uint used = 0u;
    while (grid.side > 0u) {
        // A cell's list begins where the word after it says, until bundle_list has filled it.
        bundle_grid next = coarser(grid);
        if (starts[grid.first + 1u] != starts[next.first + 1u]) {
            used += 1u;
            levels[used] = uvec4(grid.side, grid.first, floatBitsToUint(grid.share), 0u);
        }
        grid = next;
    }
    if (used == 0u) {
        used = 1u;
        bundle_grid grid = finest_grid();
        levels[1] = uvec4(grid.side, grid.first, floatBitsToUint(grid.share), 0u);
    }
    levels[0] = uvec4(used, 0u, 0u, 0u);
}
