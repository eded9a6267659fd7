// Triangles test samples; see resolve.glsl.
#include "resolve_meet.glsl"
layout(std430, binding = 2) readonly buffer alpha_buffer { uint alpha[]; };
layout(std430, binding = 4) readonly buffer starts_buffer { uint starts[]; };
layout(std430, binding = 7) coherent buffer nearest_buffer { uint nearest[]; };

float alpha_value(uint word) { return uintBitsToFloat(alpha[word]); }

bool is_hole(uint number, float u, float v) {
    if (number == 0u || (skybark_header.w & 1u) == 0u) {
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

// Whether a triangle hides what lies at `distance` and has this number.
bool hides(uint other, uvec4 place, float distance, uint number) {
    if (other == no_triangle) {
        return false;
    }
    float nearer = distance_of(meet_place(place_triangle(other), place), place);
    return nearer < distance || (nearer == distance && other < number);
}

void keep_nearest(uint k, uvec4 place, float distance, uint number) {
    uint known = nearest[2u * k];
    bool kept = false;
    while (!kept && !hides(known, place, distance, number)) {
        uint found = atomicCompSwap(nearest[2u * k], known, number);
        kept = found == known;
        known = found;
    }
    if (kept) {
        nearest[2u * k + 1u] = floatBitsToUint(distance);
    }
}

void test_sample(placed_triangle t, uint k) {
    uvec4 place = texelFetch(places, int(k));
    float x = uintBitsToFloat(place.x);
    float y = uintBitsToFloat(place.y);
    // As meet_triangle does it, for the many that miss.
    precise float ax = t.a.x - x;
    precise float ay = t.a.y - y;
    precise float bx = t.b.x - x;
    precise float by = t.b.y - y;
    precise float cx = t.c.x - x;
    precise float cy = t.c.y - y;
    precise float e0 = bx * cy - by * cx;
    precise float e1 = cx * ay - cy * ax;
    precise float e2 = ax * by - ay * bx;
    if (!(min(e0, min(e1, e2)) >= 0.0 || max(e0, max(e1, e2)) <= 0.0)) {
        return;
    }
    bundle_meeting met = meet_place(t, place);
    float distance = distance_of(met, place);
    if (distance >= 0.0 && distance <= uintBitsToFloat(nearest[2u * k + 1u]) &&
        !is_hole(t.alpha, met.u, met.v)) {
        keep_nearest(k, place, distance, t.number);
    }
}

// The cells that a triangle's box touches, so far as a sample outside it may meet the triangle.
struct cell_box {
    ivec2 low;
    ivec2 high;
};

cell_box cells_of(placed_triangle t) {
    precise float slack = meeting_slack(bundle);
    precise vec2 low = min(t.a.xy, min(t.b.xy, t.c.xy)) - slack;
    precise vec2 high = max(t.a.xy, max(t.b.xy, t.c.xy)) + slack;
    return cell_box(ivec2(grid_cell(low.x), grid_cell(low.y)),
                    ivec2(grid_cell(high.x), grid_cell(high.y)));
}

// The samples of the box in a row of cells.
uvec2 samples_of_row(cell_box box, int row) {
    uint base = uint(row) * side;
    return uvec2(starts[base + uint(box.low.x)], starts[base + uint(box.high.x) + 1u]);
}
