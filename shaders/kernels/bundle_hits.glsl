// Device side of skybark::kernels::bundle_hits.
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS ray_bundle bundle; uint first; uint count;
#include "../skeletons/parameters.glsl"
#include "../shared/alpha_map.glsl"
#include "../shared/bundle.glsl"
layout(std430, binding = 0) readonly buffer samples_buffer { gather_sample samples[]; };
layout(std430, binding = 1) readonly buffer corners_buffer { vec4 corners[]; };
layout(std430, binding = 2) readonly buffer starts_buffer { uint starts[]; };
layout(std430, binding = 3) readonly buffer alpha_buffer { uint alpha[]; };
layout(std430, binding = 4) readonly buffer before_buffer { gather_hit before[]; };
layout(std430, binding = 5) writeonly buffer hits_buffer { gather_hit hits[]; };

float alpha_value(uint word) { return uintBitsToFloat(alpha[word]); }

bool is_hole(uint number, float u, float v) {
    if (number == 0u) {
        return false;
    }
    uint at = 12u * (number - 1u);
    uint size = alpha[at + 7u];
    float s = alpha_place(alpha_value(at), alpha_value(at + 2u), alpha_value(at + 4u), u, v);
    float t = alpha_place(alpha_value(at + 1u), alpha_value(at + 3u), alpha_value(at + 5u), u, v);
    uint column = alpha_texel(s, size & 0xffffu);
    uint row = alpha_texel(t, size >> 16);
    return alpha_value(alpha[at + 6u] + row * (size & 0xffffu) + column) < alpha_value(at + 8u);
}

gather_hit nearer(gather_hit best, uint k, vec3 origin, float side) {
    vec4 p = corners[3u * k];
    vec4 q = corners[3u * k + 1u];
    // The third vec4 is read only where the ray passes: most triangles around a sample miss it.
    precise float ax = p.x - origin.x;
    precise float ay = p.y - origin.y;
    precise float bx = p.z - origin.x;
    precise float by = p.w - origin.y;
    precise float cx = q.x - origin.x;
    precise float cy = q.y - origin.y;
    precise float e0 = bx * cy - by * cx;
    precise float e1 = cx * ay - cy * ax;
    precise float e2 = ax * by - ay * bx;
    if (!(min(e0, min(e1, e2)) >= 0.0 || max(e0, max(e1, e2)) <= 0.0)) {
        return best;
    }
    vec4 r = corners[3u * k + 2u];
    bundle_meeting met = meet_triangle(vec3(p.x, p.y, q.z), vec3(p.z, p.w, q.w),
                                       vec3(q.x, q.y, r.x), origin.x, origin.y,
                                       meeting_slack(bundle));
    float distance = distance_along(met, side, origin.z, bundle.right.w);
    if (!(distance >= 0.0 && distance <= best.distance)) {
        return best;
    }
    uint triangle = floatBitsToUint(r.y);
    if (distance == best.distance && best.surface != 0xffffffffu &&
        triangle >= best.surface / 2u) {
        return best;
    }
    if (is_hole(floatBitsToUint(r.z), met.u, met.v)) {
        return best;
    }
    gather_hit found;
    found.distance = distance;
    found.surface = 2u * triangle + (side * met.facing < 0.0 ? 0u : 1u);
    found.u = met.u;
    found.v = met.v;
    return found;
}

void kernel_map(uint i) {
    gather_hit best;
    best.distance = 1e30;
    best.surface = 0xffffffffu;
    best.u = 0.0;
    best.v = 0.0;
    if (first != 0u) {
        best = before[i];
    }
    gather_sample at = samples[i];
    vec3 origin = across_bundle(bundle, ray_origin(bundle, at));
    float side = side_of_bundle(bundle, at.normal);
    float x = bundle_cells(bundle, origin.x);
    float y = bundle_cells(bundle, origin.y);
    uint last = first + count;
    uint seen = 0u;
    // One loop over all triangles around the sample, run by run, so that a software rasteriser
    // counts no more turns than the longest way of the invocations that it runs as one has. Loops
    // in loops would add up the longest of each run, and end before all had been seen.
    uint next_base = 0u;
    uint next_side = uint(bundle.direction.w);
    float next_share = 1.0;
    uint base = 0u;
    int n = 0;
    int left = 0;
    int right = 0;
    int row = 0;
    int top = -1;
    uint k = 0u;
    uint end = 0u;
    do {
        if (k >= end && row > top) { // the next grid
            base = next_base;
            n = int(next_side);
            int column = cell_within(x * next_share, n);
            int middle = cell_within(y * next_share, n);
            left = max(column - 1, 0);
            right = min(column + 1, n - 1);
            row = max(middle - 1, 0);
            top = min(middle + 1, n - 1);
            next_base += next_side * next_side;
            // None of its rows, where it has no triangles.
            row = starts[base] == starts[next_base] ? top + 1 : row;
            next_side /= 2u;
            next_share *= 0.5;
        }
        if (k >= end && row <= top) { // the next row
            uint run = starts[base + uint(row * n + left)];
            uint run_end = starts[base + uint(row * n + right) + 1u];
            k = run + min(max(first, seen) - seen, run_end - run);
            end = run + min(max(last, seen) - seen, run_end - run);
            seen += run_end - run;
            ++row;
        }
        if (k < end) {
            best = nearer(best, k, origin, side);
            ++k;
        }
    } while (k < end || row <= top || next_side > 0u);
    hits[i] = best;
}
