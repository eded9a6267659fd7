// After a peel: each pixel's depth and triangle go to their views, row after row, and how many
// pixels have a fragment is added to a count_record that was cleared. The raster holds the number
// of a triangle and the bits of a depth, all bits and 0 where nothing was drawn. header.x: pixels
// in a row, y: pixels in all. A group for every 256.
layout(local_size_x = 256) in;
#include "../skeletons/parameters.glsl"
layout(binding = SKYBARK_IMAGE_BINDING) uniform usampler2D raster;
layout(std430, binding = 8) writeonly buffer depths_buffer { uint depths[]; };
layout(std430, binding = 9) writeonly buffer triangles_buffer { uint triangles[]; };
layout(std430, binding = 10) buffer count_buffer { uint count[]; };
shared uint drawn;

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 256u +
             gl_LocalInvocationID.x;
    if (gl_LocalInvocationID.x == 0u) {
        drawn = 0u;
    }
    barrier();
    if (i < skybark_header.y) {
        uvec2 fragment =
            texelFetch(raster, ivec2(i % skybark_header.x, i / skybark_header.x), 0).xy;
        triangles[i] = fragment.x;
        depths[i] = fragment.y;
        if (fragment.y != 0u) {
            atomicAdd(drawn, 1u);
        }
    }
    barrier();
    if (gl_LocalInvocationID.x == 0u && drawn != 0u) {
        atomicAdd(count[0], drawn);
        atomicAdd(count[1], drawn);
    }
}
