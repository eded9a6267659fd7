// An invocation a triangle; see resolve.glsl.
layout(local_size_x = 64) in;
#include "resolve_test.glsl"
layout(std430, binding = 8) writeonly buffer large_buffer { uint large[]; };
layout(std430, binding = 9) buffer large_count_buffer { uint large_count[]; };

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u +
             gl_LocalInvocationID.x;
    if (i >= triangle_count) {
        return;
    }
    placed_triangle t = place_triangle(i);
    cell_box box = cells_of(t);
    uint tests = 0u;
    for (int row = box.low.y; row <= box.high.y; ++row) {
        uvec2 run = samples_of_row(box, row);
        tests += run.y - run.x;
    }
    if (tests > skybark_header.x) {
        large[atomicAdd(large_count[0], 1u)] = i;
        return;
    }
    for (int row = box.low.y; row <= box.high.y; ++row) {
        uvec2 run = samples_of_row(box, row);
        for (uint k = run.x; k < run.y; ++k) {
            test_sample(t, k);
        }
    }
}
