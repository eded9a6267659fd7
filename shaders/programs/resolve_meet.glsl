// A triangle and a sample; see resolve.glsl. Of each sample in its cell there are two words: the
// nearest triangle so far, and the distance of one that it has met: that of the nearest, or, as
// others write it at the same time, a longer one. It spares most of what comes later a look.
#include "resolve.glsl"
#include "../shared/alpha_map.glsl"
layout(binding = SKYBARK_IMAGE_BINDING) uniform usamplerBuffer places;
layout(std430, binding = 1) readonly buffer triangles_buffer { gather_triangle triangles[]; };

struct placed_triangle {
    vec3 a;
    vec3 b;
    vec3 c;
    uint number;
    uint alpha;
};

placed_triangle place_triangle(uint number) {
    gather_triangle t = triangles[number];
    return placed_triangle(across_bundle(bundle, t.a), across_bundle(bundle, t.b),
                           across_bundle(bundle, t.c), number, t.alpha);
}

float side_of_place(uvec4 place) { return (place.w & 1u) != 0u ? -1.0 : 1.0; }

bundle_meeting meet_place(placed_triangle t, uvec4 place) {
    return meet_triangle(t.a, t.b, t.c, uintBitsToFloat(place.x), uintBitsToFloat(place.y),
                         meeting_slack(bundle));
}

float distance_of(bundle_meeting met, uvec4 place) {
    return distance_along(met, side_of_place(place), uintBitsToFloat(place.z), bundle.right.w);
}
