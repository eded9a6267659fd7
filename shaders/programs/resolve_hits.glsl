// What the samples of each cell have met; see resolve.glsl.
layout(local_size_x = 64) in;
#include "resolve_meet.glsl"
layout(std430, binding = 3) writeonly buffer hits_buffer { gather_hit hits[]; };
layout(std430, binding = 7) readonly buffer nearest_buffer { uint nearest[]; };

gather_hit hit_of(uint number, uvec4 place) {
    if (number == no_triangle) {
        return gather_hit(1e30, 0xffffffffu, 0.0, 0.0);
    }
    bundle_meeting met = meet_place(place_triangle(number), place);
    uint back = side_of_place(place) * met.facing < 0.0 ? 0u : 1u;
    return gather_hit(distance_of(met, place), 2u * number + back, met.u, met.v);
}

void main() {
    uint k = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (k < samples) {
        uvec4 place = texelFetch(places, int(k));
        hits[first_sample + place.w / 2u] = hit_of(nearest[2u * k], place);
    }
}
