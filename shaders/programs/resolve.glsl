// Bundles of rays, resolved on the device: samples are sorted into a grid across the bundle, and
// each triangle is tested against those in the cells that its box touches. Few tests, little memory:
// a sample lies in one cell, however many triangles there are.
//
//     resolve_count    how many samples each cell has, and each sample's rank in its cell
//     scan             of the counts: where each cell begins
//     resolve_place    what a test needs of a sample goes to its cell
//     resolve_small    each triangle with few samples to test tests them; others are put on a list
//     resolve_large    a triangle of the list has some groups of invocations
//     resolve_hits     what each sample has met
//
// The order of a cell's samples and of the list is by chance; nothing depends on it, as a sample
// keeps the nearest triangle, and of equally near ones that of the lower number.
//
// Samples [first_sample, first_sample + samples) are one slice. header.x: the longest run of tests
// that one invocation of resolve_small makes, w: bit 0: there are holes.
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS ray_bundle bundle; uint first_sample; uint samples; uint triangle_count; uint side; float scale;
#include "../skeletons/parameters.glsl"
#include "../shared/bundle.glsl"
const uint no_triangle = 0xffffffffu;

int grid_cell(float across) {
    precise float place = (across + bundle.centre.w) * scale;
    return cell_within(place, int(side));
}

uint cell_of_sample(vec3 origin) {
    return uint(grid_cell(origin.y)) * side + uint(grid_cell(origin.x));
}
