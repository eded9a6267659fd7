// Device side of skybark::kernels::bundle_key.
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS ray_bundle bundle;
#include "../skeletons/parameters.glsl"
#include "../shared/bundle.glsl"
layout(std430, binding = 0) readonly buffer triangles_buffer { gather_triangle triangles[]; };
layout(std430, binding = 1) writeonly buffer keys_buffer { uint keys[]; };
layout(std430, binding = 2) writeonly buffer numbers_buffer { uint numbers[]; };

void kernel_map(uint i) {
    gather_triangle t = triangles[i];
    keys[i] = bundle_cell(bundle, across_bundle(bundle, t.a), across_bundle(bundle, t.b),
                          across_bundle(bundle, t.c));
    numbers[i] = i;
}
