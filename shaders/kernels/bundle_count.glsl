// Device side of skybark::kernels::bundle_count.
#include "../skeletons/parameters.glsl"
layout(std430, binding = 0) readonly buffer runs_buffer { uvec2 runs[]; };
layout(std430, binding = 1) writeonly buffer counts_buffer { uint counts[]; };

void kernel_map(uint i) { counts[i] = runs[i].y - runs[i].x; }
