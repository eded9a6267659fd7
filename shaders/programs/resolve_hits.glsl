// What each sample meets; see resolve.glsl. Of the triangles in its cells a sample looks at those
// from `first` on and before `last`; where there are more, `more` becomes the number of samples.
// header.z: 1 where the hits are those of a look at others before, and go on.
//
// Mesa's software rasterisers run what a condition guards whether or not anybody meets it, and a
// loop once more where its end is found at its top.
layout(local_size_x = 64) in;
#include "resolve.glsl"
#include "../skeletons/length.glsl"
layout(binding = SKYBARK_IMAGE_BINDING) uniform usamplerBuffer corners;
layout(binding = SKYBARK_IMAGE_BINDING + 1) uniform usamplerBuffer entries;
layout(std430, binding = 0) readonly buffer samples_buffer { gather_sample sample_list[]; };
layout(std430, binding = 2) readonly buffer before_buffer { gather_hit before[]; };
layout(std430, binding = 3) writeonly buffer hits_buffer { gather_hit hits[]; };
layout(std430, binding = 4) readonly buffer starts_buffer { uint starts[]; };
layout(std430, binding = 5) readonly buffer levels_buffer { uint levels[]; };
layout(std430, binding = 8) writeonly buffer more_buffer { uint more[]; };

#ifdef RESOLVE_HOLES
#include "../shared/alpha_map.glsl"
layout(std430, binding = 9) readonly buffer alpha_buffer { uint alpha[]; };

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
#else
bool is_hole(uint number, float u, float v) { return false; }
#endif

struct flat_triangle {
    uint number; // within the slice
    vec4 p;      // a.xy, b.xy
    vec4 q;      // c.xy, a.z, b.z
};

flat_triangle flat_entry(uint k) {
    uint number = texelFetch(entries, int(k)).x;
    return flat_triangle(number, uintBitsToFloat(texelFetch(corners, int(3u * number))),
                         uintBitsToFloat(texelFetch(corners, int(3u * number + 1u))));
}

// As meet_triangle sees it, for the many that are missed.
bool passes(flat_triangle t, vec3 origin) {
    precise float ax = t.p.x - origin.x;
    precise float ay = t.p.y - origin.y;
    precise float bx = t.p.z - origin.x;
    precise float by = t.p.w - origin.y;
    precise float cx = t.q.x - origin.x;
    precise float cy = t.q.y - origin.y;
    precise float e0 = bx * cy - by * cx;
    precise float e1 = cx * ay - cy * ax;
    precise float e2 = ax * by - ay * bx;
    return (e0 >= 0.0 && e1 >= 0.0 && e2 >= 0.0) || (e0 <= 0.0 && e1 <= 0.0 && e2 <= 0.0);
}

gather_hit nearer(gather_hit best, flat_triangle t, vec3 origin, float facing) {
    uvec4 r = texelFetch(corners, int(3u * t.number + 2u));
    bundle_meeting met = meet_triangle(vec3(t.p.xy, t.q.z), vec3(t.p.zw, t.q.w),
                                       vec3(t.q.xy, uintBitsToFloat(r.x)), origin.x, origin.y,
                                       meeting_slack(bundle));
    float distance = distance_along(met, facing, origin.z, bundle.right.w);
    uint number = first_triangle + t.number;
    bool takes = distance >= 0.0 && distance <= best.distance;
    bool later = distance == best.distance && best.surface != 0xffffffffu &&
                 number >= best.surface / 2u;
    if (takes && !later && !is_hole(r.y, met.u, met.v)) {
        best.distance = distance;
        best.surface = 2u * number + (facing * met.facing < 0.0 ? 0u : 1u);
        best.u = met.u;
        best.v = met.v;
    }
    return best;
}

gather_hit nearest_of(gather_hit best, uint k, uint end, vec3 origin, float facing) {
    if (k < end) {
        do {
            flat_triangle t = flat_entry(k);
            if (passes(t, origin)) {
                best = nearer(best, t, origin, facing);
            }
            k += 1u;
        } while (k < end);
    }
    return best;
}

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= skybark_elements()) {
        return;
    }
    gather_hit best = gather_hit(1e30, 0xffffffffu, 0.0, 0.0);
    if (skybark_header.z != 0u) {
        best = before[i];
    }
    gather_sample at = sample_list[i];
    vec3 origin = across_bundle(bundle, ray_origin(bundle, at));
    float facing = side_of_bundle(bundle, at.normal);
    ivec2 cell = ivec2(grid_cell(origin.x), grid_cell(origin.y));
    uint seen = 0u;
    uint left = levels[0];
    if (left != 0u) {
        do {
            uint number = cell_number(cell, uint(findLSB(left)));
            uint begin = starts[number];
            uint count = starts[number + 1u] - begin;
            uint skipped = min(max(first, seen) - seen, count);
            uint wanted = min(max(last, seen) - seen, count);
            best = nearest_of(best, begin + skipped, begin + wanted, origin, facing);
            seen += count;
            left &= left - 1u;
        } while (left != 0u);
    }
    if (seen > last) {
        more[0] = skybark_header.y;
    }
    hits[i] = best;
}
