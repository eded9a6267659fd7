// What each sample meets first, of the triangles in its cell's lists; see bundle_cells.glsl.
// header.y: samples. Of a sample's triangles those from `first` to `first` + `count` are looked at;
// `again`: what has been found before counts as well. `first_triangle` is the number of the first
// triangle of the lists in the scene. Who includes this defines is_hole(alpha, u, v).
layout(local_size_x = 64) in;
#include "bundle_cells.glsl"
layout(std430, binding = 0) readonly buffer samples_buffer { gather_sample samples[]; };
layout(std430, binding = 1) readonly buffer corners_buffer { vec4 corners[]; };
layout(std430, binding = 2) readonly buffer ends_buffer { uint ends[]; };
layout(std430, binding = 3) readonly buffer listed_buffer { uvec2 listed[]; };
layout(std430, binding = 4) readonly buffer levels_buffer { uvec4 levels[]; };
layout(std430, binding = 5) readonly buffer before_buffer { gather_hit before[]; };
layout(std430, binding = 6) writeonly buffer hits_buffer { gather_hit hits[]; };
bool is_hole(uint alpha, float u, float v);

// The better of what is known and what triangle i gives; of equally distant ones the lower.
gather_hit nearer(gather_hit best, bool is_there, uint i, vec3 origin, float side) {
    vec4 p = corners[3u * i];
    vec4 q = corners[3u * i + 1u];
    vec4 r = corners[3u * i + 2u];
    bundle_meeting met =
        meet_triangle(vec3(p.x, p.y, q.z), vec3(p.z, p.w, q.w), vec3(q.x, q.y, r.x), origin.x,
                      origin.y, meeting_slack(bundle));
    float distance = distance_along(met, side, origin.z, bundle.right.w);
    uint triangle = first_triangle + i;
    bool better = is_there && distance >= 0.0 &&
                  (distance < best.distance || (distance == best.distance &&
                                                (best.surface == 0xffffffffu ||
                                                 triangle < best.surface / 2u)));
    better = better && !is_hole(floatBitsToUint(r.y), met.u, met.v);
    gather_hit found;
    found.distance = better ? distance : best.distance;
    found.surface = better ? 2u * triangle + (side * met.facing < 0.0 ? 0u : 1u) : best.surface;
    found.u = better ? met.u : best.u;
    found.v = better ? met.v : best.v;
    return found;
}

// Which of up to 32 listed triangles have the place in their box and reach far enough. Software
// rasterisers run what a condition leaves out as well, and each loop's body once more than its
// turns where the condition stands first: so the few triangles that are worth a look are found
// before, and conditions stand last.
uint worth_a_look(uint from, uint n, uint place, uint reach) {
    uint worth = 0u;
    uint bit = 1u;
    uint k = 0u;
    do {
        uvec2 one = listed[from + k];
        uint inside = ((place | 0x80808080u) - one.x) & 0x80808080u;
        uint reaches = (one.y - reach) & reach_guards;
        worth |= k < n && inside == 0x80808080u && reaches == reach_guards ? bit : 0u;
        bit <<= 1u;
    } while (++k < n);
    return worth;
}

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= skybark_header.y) {
        return;
    }
    gather_hit best;
    best.distance = 1e30;
    best.surface = 0xffffffffu;
    best.u = 0.0;
    best.v = 0.0;
    if (again != 0u) {
        best = before[i];
    }
    gather_sample at = samples[i];
    vec3 origin = across_bundle(bundle, ray_origin(bundle, at));
    float side = side_of_bundle(bundle, at.normal);
    uint reach = wanted_reach(origin.z, side);
    uint last = first + count;
    uint seen = 0u;
    uint used = levels[0].x;
    uint l = 1u;
    do {
        uvec4 level = levels[l];
        bundle_grid grid = bundle_grid(level.x, level.y, uintBitsToFloat(level.z));
        vec2 place = in_cells(grid, origin.xy);
        ivec2 cell =
            ivec2(cell_within(place.x, int(grid.side)), cell_within(place.y, int(grid.side)));
        uint sides = sides_within(place, place, vec2(cell));
        uint list = grid.first + uint(cell.y) * grid.side + uint(cell.x);
        uint begin = ends[list];
        uint end = ends[list + 1u];
        uint length = end - begin;
        end = begin + min(max(last, seen) - seen, length);
        begin += min(max(first, seen) - seen, length);
        seen += length;
        do {
            uint worth = worth_a_look(begin, min(end - begin, 32u), sides, reach);
            do {
                bool is_there = worth != 0u;
                uint word = listed[is_there ? begin + uint(findLSB(worth)) : 0u].y;
                uint triangle = is_there ? word & listed_number : 0u;
                best = nearer(best, is_there, triangle, origin, side);
                worth &= worth - 1u;
            } while (worth != 0u);
            begin = min(begin + 32u, end);
        } while (begin < end);
    } while (++l <= used);
    hits[i] = best;
}
