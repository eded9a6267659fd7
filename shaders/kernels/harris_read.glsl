// Device side of skybark::kernels::harris_read.
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS light_grid grid; uint k; uint columns; uint rows; uint to;
#include "../skeletons/parameters.glsl"
#include "../shared/attenuation.glsl"
layout(std430, binding = 0) readonly buffer particles_buffer { vec4 particles[]; };
layout(std430, binding = 1) readonly buffer order_buffer { uint order[]; };
layout(std430, binding = 2) readonly buffer light_buffer { float light[]; };
layout(std430, binding = 3) writeonly buffer lights_buffer { float lights[]; };

void kernel_map(uint i) {
    vec3 cells = holdable_cells_of(grid, particles[2u * order[k]].xyz);
    uint x = uint(clamp(floor(cells.x), 0.0, float(columns - 1u)));
    uint z = uint(clamp(floor(cells.z), 0.0, float(rows - 1u)));
    lights[to] = light[z * columns + x];
}
