// Device side of skybark::kernels::bundle_order.
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS ray_bundle bundle; uint triangles;
#include "../skeletons/parameters.glsl"
#include "../shared/bundle.glsl"
layout(std430, binding = 0) readonly buffer of_buffer { gather_triangle of[]; };
layout(std430, binding = 1) readonly buffer keys_buffer { uint keys[]; };
layout(std430, binding = 2) readonly buffer numbers_buffer { uint numbers[]; };
layout(std430, binding = 3) writeonly buffer corners_buffer { vec4 corners[]; };
layout(std430, binding = 4) writeonly buffer runs_buffer { uvec2 runs[]; };

void kernel_map(uint i) {
    uint number = numbers[i];
    gather_triangle t = of[number];
    vec3 a = across_bundle(bundle, t.a);
    vec3 b = across_bundle(bundle, t.b);
    vec3 c = across_bundle(bundle, t.c);
    corners[3u * i] = vec4(a.x, a.y, b.x, b.y);
    corners[3u * i + 1u] = vec4(c.x, c.y, a.z, b.z);
    corners[3u * i + 2u] = vec4(c.z, uintBitsToFloat(number), uintBitsToFloat(t.alpha), 0.0);
    uint key = keys[i];
    if (i == 0u || keys[i - 1u] != key) {
        runs[key].x = i;
    }
    if (i + 1u == triangles || keys[i + 1u] != key) {
        runs[key].y = i + 1u;
    }
}
