// Device side of skybark::kernels::harris_order.
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS light_grid grid;
#include "../skeletons/parameters.glsl"
#include "../shared/attenuation.glsl"
#include "../shared/order.glsl"
layout(std430, binding = 0) readonly buffer particles_buffer { vec4 particles[]; };
layout(std430, binding = 1) writeonly buffer keys_buffer { uint keys[]; };
layout(std430, binding = 2) writeonly buffer numbers_buffer { uint numbers[]; };

void kernel_map(uint i) {
    keys[i] = falling_key(holdable_cells_of(grid, particles[2u * i].xyz).y);
    numbers[i] = i;
}
