// header.y groups a triangle of the list, each with its share of the rows; see resolve.glsl.
layout(local_size_x = 64) in;
#include "resolve_test.glsl"
layout(std430, binding = 8) readonly buffer large_buffer { uint large[]; };
layout(std430, binding = 9) readonly buffer large_count_buffer { uint large_count[]; };

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint share = skybark_header.y;
    if (group / share >= large_count[0]) {
        return;
    }
    placed_triangle t = place_triangle(large[group / share]);
    cell_box box = cells_of(t);
    for (int row = box.low.y + int(group % share); row <= box.high.y; row += int(share)) {
        uvec2 run = samples_of_row(box, row);
        for (uint k = run.x + gl_LocalInvocationID.x; k < run.y; k += 64u) {
            test_sample(t, k);
        }
    }
}
