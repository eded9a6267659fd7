// Device side of skybark::kernels::ring_indices.
#define KERNEL_PARAMETERS uint pattern_size; uint ring_vertices; uint base_vertex;
#include "../skeletons/parameters.glsl"
layout(std430, binding = 0) readonly buffer pattern_buffer { uint pattern[]; };
layout(std430, binding = 1) writeonly buffer indices_buffer { uint indices[]; };

void kernel_map(uint i) {
    indices[i] = base_vertex + (i / pattern_size) * ring_vertices + pattern[i % pattern_size];
}
