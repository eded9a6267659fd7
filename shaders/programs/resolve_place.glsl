// Samples go to their cells; see resolve.glsl. They have met nothing yet.
layout(local_size_x = 64) in;
#include "resolve.glsl"
layout(std430, binding = 0) readonly buffer samples_buffer { gather_sample sample_list[]; };
layout(std430, binding = 4) readonly buffer starts_buffer { uint starts[]; };
layout(std430, binding = 5) readonly buffer ranks_buffer { uint ranks[]; };
layout(std430, binding = 6) writeonly buffer places_buffer { uvec4 places[]; };
layout(std430, binding = 7) writeonly buffer nearest_buffer { uvec2 nearest[]; };

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i < samples) {
        gather_sample at = sample_list[first_sample + i];
        vec3 origin = across_bundle(bundle, ray_origin(bundle, at));
        uint k = starts[cell_of_sample(origin)] + ranks[i];
        uint against = side_of_bundle(bundle, at.normal) < 0.0 ? 1u : 0u;
        places[k] = uvec4(floatBitsToUint(origin), 2u * i + against);
        nearest[k] = uvec2(no_triangle, floatBitsToUint(1e30));
    }
}
