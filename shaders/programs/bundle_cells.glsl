// Bundles of rays resolved in one go: triangles are listed in each cell across the bundle that they
// may cover, and each sample looks at the list of its own cell.
//
//     bundle_cover   the cells of each triangle: how many triangles each cell has
//     scan           where each cell's list begins
//     bundle_levels  which grids have triangles at all
//     bundle_list    each triangle into the lists of its cells, in no order
//     bundle_look    each sample against the triangles of its cell, in each grid
//
// Like what the patterns compose (shared/bundle.glsl), but with lists in place of neighbours: a
// sample looks at a quarter as many triangles, and of these only at those whose box it lies in and
// that reach as far as it. A triangle is in the finest grid of which four cells
// are as wide as it is, each grid having a quarter of the cells across of the one before, and so in
// 25 cells at most. Which triangle counts does not depend on the order of a list, so that lists may
// be made by atomic additions, and the results have the bits that the patterns give.
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS ray_bundle bundle; uint first_triangle; uint first; uint count; uint again;
#include "../skeletons/parameters.glsl"
#include "../shared/bundle.glsl"
const uint levels_apart = 2u; // two bits: a quarter
const float widest = 3.98;
const int most_across = 5; // cells that a triangle this wide may reach into, along one side
// Cells are this much wider on each side than they are: more than meeting_slack (1e-3 cells of the
// finest grid there is) and roundings (2.5e-4) together.
const float margin = 1.0 / 256.0;

struct bundle_grid {
    uint side;   // cells on a side
    uint first;  // the number of its first cell
    float share; // of the finest grid's cells in a metre
};

bundle_grid finest_grid() { return bundle_grid(uint(bundle.direction.w), 0u, 1.0); }

bool has_coarser(bundle_grid grid) { return grid.side >= 4u; }

bundle_grid coarser(bundle_grid grid) {
    return bundle_grid(grid.side >> levels_apart, grid.first + grid.side * grid.side,
                       0.25 * grid.share);
}

// Across the bundle, in cells of a grid.
vec2 in_cells(bundle_grid grid, vec2 across) {
    precise vec2 place = vec2(bundle_cells(bundle, across.x), bundle_cells(bundle, across.y));
    return place * grid.share;
}

// A box within a cell, or (from a place to the same place) a place in it, by sides from 0 to 127 in
// a byte each, so that a place is inside where no byte of its is less than the box's.
uint sides_within(vec2 low, vec2 high, vec2 cell) {
    uvec2 least = uvec2(clamp(low - cell, 0.0, 1.0) * 127.0);
    uvec2 most = 127u - uvec2(clamp(high - cell, 0.0, 1.0) * 127.0);
    return least.x | most.x << 8 | least.y << 16 | most.y << 24;
}

// How far along the bundle, from 0 to 63.
uint depth_step(float z) {
    return uint(clamp(0.5 + 0.5 * (z / bundle.centre.w), 0.0, 1.0) * 63.0);
}

// A listed triangle is two words: sides_within of its box; its number (18 bits), and how far it
// reaches along the bundle and against it, each with a bit above it for what is taken away.
const uint listed_number = 0x3ffffu;
const uint reach_guards = 0x81000000u;
uint listed_triangle(uint number, float least, float most) {
    float doubt = 1e-6 * max(abs(least), abs(most)) + 4.0 * meeting_slack(bundle);
    return number | depth_step(most + doubt) << 18u | (63u - depth_step(least - doubt)) << 25u |
           reach_guards;
}

// What a triangle must reach to be met from z, by those that look along the bundle (1) or against
// it (-1).
uint wanted_reach(float z, float side) {
    float behind = z - side * bundle.right.w;
    return side > 0.0 ? depth_step(behind) << 18u : (63u - depth_step(behind)) << 25u;
}
