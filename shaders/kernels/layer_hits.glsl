// Device side of skybark::kernels::layer_hits.
#include "../shared/records.glsl"
#define KERNEL_PARAMETERS ray_bundle bundle; float reach; uint size; uint fresh;
#include "../skeletons/parameters.glsl"
#include "../shared/bundle.glsl"
layout(std430, binding = 0) readonly buffer samples_buffer { gather_sample samples[]; };
layout(std430, binding = 1) readonly buffer depths_buffer { float depths[]; };
layout(std430, binding = 2) readonly buffer numbers_buffer { uint numbers[]; };
layout(std430, binding = 3) readonly buffer triangles_buffer { gather_triangle triangles[]; };
layout(std430, binding = 4) readonly buffer before_buffer { gather_hit before[]; };
layout(std430, binding = 5) writeonly buffer hits_buffer { gather_hit hits[]; };

gather_hit hit_at(uint number, float distance, float side, float x, float y) {
    gather_triangle t = triangles[number];
    vec3 a = across_bundle(bundle, t.a);
    vec3 b = across_bundle(bundle, t.b);
    vec3 c = across_bundle(bundle, t.c);
    bundle_meeting met = meet_triangle(a, b, c, x, y, meeting_slack(bundle));
    gather_hit found;
    found.distance = distance;
    found.surface = 2u * number + (side * facing_of_triangle(a, b, c) < 0.0 ? 0u : 1u);
    found.u = met.facing != 0.0 ? met.u : 1.0 / 3.0;
    found.v = met.facing != 0.0 ? met.v : 1.0 / 3.0;
    return found;
}

void kernel_map(uint i) {
    gather_hit best;
    best.distance = 1e30;
    best.surface = 0xffffffffu;
    best.u = 0.0;
    best.v = 0.0;
    if (fresh == 0u) {
        best = before[i];
    }
    gather_sample at = samples[i];
    vec3 origin = across_bundle(bundle, ray_origin(bundle, at));
    float side = side_of_bundle(bundle, at.normal);
    float pixel = 2.0 * bundle.centre.w / float(size);
    int column = cell_within((origin.x + bundle.centre.w) / pixel, int(size));
    int row = cell_within((origin.y + bundle.centre.w) / pixel, int(size));
    uint where = uint(row) * size + uint(column);
    float depth = depths[where];
    float distance = depth > 0.0 ? side * (place_of_layer(depth, reach) - origin.z) : -1.0;
    bool taken = side > 0.0 || best.surface == 0xffffffffu;
    if (taken && distance > rise_in_pixel(bundle, at.normal, 0.5 * pixel)) {
        best = hit_at(numbers[where], distance, side,
                      (float(column) + 0.5) * pixel - bundle.centre.w,
                      (float(row) + 0.5) * pixel - bundle.centre.w);
    }
    hits[i] = best;
}
