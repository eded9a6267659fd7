// Bundles of rays, resolved on the device: triangles are put into a hierarchy of grids across the
// bundle, and each sample is tested against those in its cell of each grid.
//
//     resolve_count    each triangle's corners across the bundle; how many there are in each cell
//     scan             of the counts: where each cell begins
//     resolve_fill     triangles go to their cells
//     resolve_hits     each sample against the triangles of its cells
//
// A grid of the hierarchy has half as many cells on a side as the one before; a triangle is in the
// finest in which its box touches no more than five cells a side, and in those of them that it
// touches itself: 25 entries at most. The order of a cell's triangles is by chance; nothing depends
// on it, as a sample keeps the nearest triangle, and of equally near ones that of the lower number.
//
// Triangles [first_triangle, first_triangle + triangle_count) are one slice. `side`: cells on a side
// of the finest grid, a power of two; `scale`: its cells in a metre.
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS ray_bundle bundle; uint first_triangle; uint triangle_count; uint side; float scale; uint first; uint last;
#include "../skeletons/parameters.glsl"
#include "../shared/bundle.glsl"

int grid_cell(float across) {
    precise float place = (across + bundle.centre.w) * scale;
    return cell_within(place, int(side));
}

// The number of a cell of grid `level`, which the cell `at` of the finest is a part of.
uint cell_number(ivec2 at, uint level) {
    uint cells = side >> level;
    uint before = (side * side - cells * cells) / 3u * 4u;
    return before + uint(at.y >> level) * cells + uint(at.x >> level);
}
