#version 450
// The grids that have triangles: how many there are, and which; see bundle_cells.glsl.
layout(local_size_x = 1) in;
#include "bundle_cells.glsl"
layout(std430, binding = 0) readonly buffer starts_buffer { uint starts[]; };
layout(std430, binding = 1) writeonly buffer levels_buffer { uint levels[]; };

void main() {
    bundle_grid grid = finest_grid();
    uint used = 0u;
    for (uint level = 0u; grid.side > 0u; ++level) {
        // A cell's list begins where the word after it says, until bundle_list has filled it.
        bundle_grid next = coarser(grid);
        if (starts[grid.first + 1u] != starts[next.first + 1u]) {
            used += 1u;
            levels[used] = level;
        }
        grid = next;
    }
    levels[0] = used;
}
