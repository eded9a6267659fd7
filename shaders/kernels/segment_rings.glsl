// Device side of skybark::kernels::segment_rings.
#define KERNEL_PARAMETERS float pixels_per_radian; float error; uint fewest_sides; uint sides; uint gaps;
#include "../skeletons/parameters.glsl"
#include "../shared/detail.glsl"
layout(std430, binding = 0) readonly buffer segments_buffer { branch_segment segments[]; };
layout(std430, binding = 1) readonly buffer ends_buffer { branch_end ends[]; };
layout(std430, binding = 2) readonly buffer shares_buffer { uvec4 shares[]; };
layout(std430, binding = 3) readonly buffer chains_buffer { uvec4 chains[]; };
layout(std430, binding = 4) readonly buffer details_buffer { vec4 details[]; };
layout(std430, binding = 5) writeonly buffer merged_buffer { branch_segment merged[]; };
layout(std430, binding = 6) writeonly buffer rings_buffer { uvec4 made_of[]; };

end_detail detail_at(uint end) {
    vec4 d = details[end];
    return end_detail(d.x, d.y, d.z, d.w);
}

void kernel_map(uint i) {
    branch_segment s = segments[i];
    uvec4 p = shares[s.start];
    chain_share place = chain_share(uintBitsToFloat(p.x), uintBitsToFloat(p.y), p.z, p.w);
    uvec4 c = chains[place.chain];
    chain_detail chain = chain_detail(c.x, c.y, c.z, uintBitsToFloat(c.w));
    uvec4 made = uvec4(0u);
    if (!is_merged_away(place, chain)) {
        s = merged_segment(s, chain);
        branch_end a = ends[s.start];
        branch_end b = ends[s.end];
        end_detail da = detail_at(s.start);
        end_detail db = detail_at(s.end);
        a.radius = a.radius * da.scale;
        b.radius = b.radius * db.scale;
        segment_detail d = detail_of_segment(s, a, b, da, db, pixels_per_radian, error,
                                             fewest_sides, sides, gaps);
        made = uvec4(d.sides, d.gaps, floatBitsToUint(d.fraction), d.caps);
    }
    merged[i] = s;
    made_of[i] = made;
}
