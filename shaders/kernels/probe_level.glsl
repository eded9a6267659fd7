// Device side of skybark::kernels::probe_level.
#include "../skeletons/parameters.glsl"
layout(std430, binding = 0) readonly buffer nodes_buffer { uvec2 nodes[]; };
layout(std430, binding = 1) readonly buffer parents_buffer { uint parents[]; };
layout(std430, binding = 2) writeonly buffer values_buffer { uint values[]; };

void kernel_map(uint i) {
    uvec2 node = nodes[i];
    values[i] = node.x == i ? node.y : parents[node.x] * 3u + node.y;
}
