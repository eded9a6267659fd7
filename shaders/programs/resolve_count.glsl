// The samples of each cell are counted; see resolve.glsl. Counts begin at 0.
layout(local_size_x = 64) in;
#include "resolve.glsl"
layout(std430, binding = 0) readonly buffer samples_buffer { gather_sample sample_list[]; };
layout(std430, binding = 4) buffer counts_buffer { uint counts[]; };
layout(std430, binding = 5) writeonly buffer ranks_buffer { uint ranks[]; };

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i < samples) {
        vec3 origin = across_bundle(bundle, ray_origin(bundle, sample_list[first_sample + i]));
        ranks[i] = atomicAdd(counts[cell_of_sample(origin)], 1u);
    }
}
